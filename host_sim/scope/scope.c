/* scope.c - contactplant scope: plants of a bus in a browser. It listens as monitor does and never sends. */
#include "host_sim/scope/scope_child.h"
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/replay/decode_signals.h"
#include "host_sim/scope/hub.h"
#include "host_sim/scope/scope_logs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double settle_s = 1.0; /* for the other items of INFO, after the first that differs */

static const struct option scope_command_options[] = {
    SCOPE_HTTP,
    SCOPE_CONTROL,
    {"open", "FILE", "a recorded log instead of a plant; twice: two logs, and where they differ",
     OPTION_READS, .initial = NULL, .many = true},
    {"tolerance", "SIGNAL=TOLERANCE",
     "with two logs: where they part, as of contactplant compare; repeatable", OPTION_TEXT, .initial = NULL,
     .many = true},
    {.name = "follow", .meaning = "with --open: read on while the log grows"},
    {"log", "FILE", "record all that is heard as a candump log, for contactplant decode", OPTION_WRITES,
     .initial = NULL},
    {"duration", "S", "end after this many seconds (0: with Ctrl-C)", OPTION_NUMBER, 0.0, 1e9,
     .initial = "0"},
    {.name = NULL},
};

static const struct usage scope_usage = {
    .name = "scope",
    .words = "[SCENE[@ID]]..",
    .summary =
        "Shows plants in a browser while they run: motion, contact, lock-in, drives, bursts, state and\n"
        "timing. It prints the address to open. It listens as monitor does and never sends: over UDP the\n"
        "plant must list it as a peer (run lists 127.0.0.1:20002 by itself). Give the SCENE, --set,\n"
        "--setting, --rate, --substeps and --dilation of the plant. The page shows no number before INFO\n"
        "identity confirms them. Only this machine can open the page, unless --http says otherwise. Nobody\n"
        "can command the plant by it, unless --control says so. contactplant run --scope starts plant and\n"
        "scope in one command. --open shows a recorded log instead, of the SCENE that made it.",
    .words_help = SCENE_WORDS_HELP
    "Several plants of one bus are told apart by their identifiers: SCENE@0x240 is the plant with\n"
    "--base-id 0x240.\n",
    .examples = "  contactplant scope                                 the plant of contactplant run\n"
                "  contactplant scope rig --bus can:can0 --http 127.0.0.1:9000\n"
                "  contactplant scope hertz_rig shaft_bearing@0x240 --bus can:can0\n"
                "  contactplant scope --http 0.0.0.0:8080             for other machines, too\n"
                "  contactplant scope --open run.log rig              a recorded log\n"
                "  contactplant run rig --scope                       without a second terminal\n",
    .max_words = HUB_PLANTS,
    .table = {scope_command_options, decode_log_options, bus_options, scene_options},
};

struct scope {
    const struct options *o;
    struct hub hub;
    struct bus bus[HUB_PLANTS];
    int n_buses;
};

/* SCENE@ID: cuts the word at the @ where a number follows. */
static bool cut_id(char *word, double *id)
{
    char *at = strrchr(word, '@');
    if (!at || !options_read_number(at + 1, id))
        return false;
    *at = '\0';
    return true;
}

/* The identifiers of this plant are a block of their own. */
static int check_id(const struct scope *s, const struct decoder *d)
{
    const struct app_config *c = &d->scene.config;
    for (int i = 0; i < d->number; i++) {
        const struct app_config *other = &s->hub.decoder[i]->scene.config;
        if (other->base_id == c->base_id)
            return options_misuse(&scope_usage, "%s and %s have the identifiers from 0x%X on; write %s@0x%X",
                                  s->hub.decoder[i]->name, d->name, c->base_id, d->name,
                                  c->base_id + WIRE_BASE_ALIGN);
    }
    return STATUS_DONE;
}

/* The plant of word i, or the only one where there is no word. */
static int add_word_plant(struct scope *s, int i)
{
    const char *bus = options_text(s->o, "bus", 0), *peer = options_text(s->o, "peer", 0);
    struct options o = *s->o;
    char word[DECODER_NAME], why[SCENE_REASON];
    double id = 0.0;
    snprintf(word, sizeof word, "%s", i < o.n_words ? o.word[i] : "hertz_rig");
    bool has_id = cut_id(word, &id);
    if (i < o.n_words)
        o.word[i] = word;
    struct decoder *d = hub_add(&s->hub, word);
    if (!d)
        return options_failure(&scope_usage, "out of memory");
    if (!scene_from_options(&d->scene, &o, i))
        return STATUS_MISUSED;
    if (has_id && !(id >= 0.0 && id <= 0x7FF - (WIRE_KINDS - 1) && fmod(id, WIRE_BASE_ALIGN) == 0.0))
        return options_misuse(&scope_usage, "%s: after @ stands a multiple of 0x%X up to 0x7C0", o.word[i],
                              WIRE_BASE_ALIGN);
    if (has_id)
        d->scene.config.base_id = (uint32_t)id;
    if (!scene_start(&d->scene, NULL, why))
        return options_misuse(&scope_usage, "%s", why);
    decoder_begin(d);
    hub_command(&s->hub, d, s->o, bus ? bus : "udp:20002", peer ? peer : "127.0.0.1:20000");
    return check_id(s, d);
}

/* One bus for all over UDP; on CAN one for each plant, as a socket takes the identifiers of one. */
static int open_buses(struct scope *s)
{
    int status = STATUS_DONE;
    for (int i = 0; i < s->hub.n_decoders && !status; i++) {
        struct decoder *d = s->hub.decoder[i];
        struct bus *b = &s->bus[s->n_buses];
        if (i == 0 || s->bus[0].kind == BUS_CAN) {
            status = bus_open_options(b, s->o, BUS_MONITOR, &d->scene.app.scene);
            s->n_buses += !status;
            s->hub.source[i] = (struct source){&b->hal, b};
            s->hub.n_sources += !status;
        }
        d->has_commands = s->bus[0].kind == BUS_CAN;
        if (!status)
            bus_describe(&s->bus[0], d->bus);
    }
    return status;
}

static int record(struct scope *s)
{
    const char *log = options_text(s->o, "log", 0);
    char why[BUS_REASON];
    if (log && s->n_buses > 1)
        return options_misuse(&scope_usage, "--log records one plant of a CAN bus; candump records all");
    if (log && !bus_record(&s->bus[0], log, 0, why))
        return options_failure(&scope_usage, "%s", why);
    s->bus[0].log.listens = true;
    return STATUS_DONE;
}

static void print_news(struct scope *s)
{
    char news[BUS_REASON];
    for (int i = 0; i < s->n_buses; i++)
        while (bus_news(&s->bus[i], news))
            fprintf(stderr, "contactplant scope: %s\n", news);
}

/* A plant that turns out to be another one is told here,
 * too, with its parts as far as they are known by then. */
static void print_others(const struct scope *s, bool *printed)
{
    for (int i = 0; i < s->hub.n_decoders; i++) {
        const struct decoder *d = s->hub.decoder[i];
        bool other = d->sent.identity == CLIENT_OTHER;
        bool settled = other && clock_now_s() > d->sent.why_s + settle_s;
        if (settled && !printed[i])
            fprintf(stderr, "contactplant scope: %s: %s\n", d->name, d->sent.why);
        printed[i] = other && (printed[i] || settled);
    }
}

static int listen_in(struct scope *s)
{
    double duration = options_number(s->o, "duration"), end = clock_now_s() + duration;
    bool printed[HUB_PLANTS] = {false}, heard = false;
    char why[BUS_REASON];
    while (!clock_interrupted() && !(duration > 0.0 && clock_now_s() >= end)) {
        hub_turn(&s->hub);
        print_news(s);
        print_others(s, printed);
    }
    for (int i = 0; i < s->hub.n_decoders; i++)
        heard = heard || s->hub.decoder[i]->received_s > 0.0;
    if (!bus_end_record(&s->bus[0], why))
        return options_failure(&scope_usage, "%s", why);
    return heard ? STATUS_DONE
                 : options_failure(&scope_usage,
                                   "heard nothing; is a plant running, and does it list us as a --peer?");
}

static int scope(struct scope *s)
{
    const char *at = options_text(s->o, "http", 0);
    int status = STATUS_DONE, n = s->o->n_words ? s->o->n_words : 1;
    for (int i = 0; i < n && !status; i++)
        status = add_word_plant(s, i);
    status = status ? status : open_buses(s);
    status = status ? status : hub_open(&s->hub, s->o, at ? at : SCOPE_AT); /* says that it is there */
    status = status ? status : record(s); /* last: it empties a log of before */
    clock_catch_signals();
    return status ? status : listen_in(s);
}

int cmd_scope(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &scope_usage, argc, argv, &status))
        return status;
    if (options_given(&o, "open"))
        return scope_logs(&o);
    if (options_given(&o, "follow") || options_given(&o, "interface") || options_given(&o, "tolerance"))
        return options_misuse(&scope_usage,
                              "--follow, --interface and --tolerance are of logs; name them by --open");
    struct scope *s = calloc(1, sizeof *s);
    if (!s)
        return options_failure(&scope_usage, "out of memory");
    s->o = &o;
    s->hub.server.socket = -1;
    status = scope(s);
    for (int i = 0; i < s->n_buses; i++)
        bus_close(&s->bus[i]);
    hub_close(&s->hub, "the scope has ended");
    free(s);
    return status;
}
