/* monitor.c - prints the plant's messages by name and unit, one line each. */
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/commands.h"
#include "host_sim/live/explain.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/replay/monitor_rows.h"
#include "host_sim/live/remote.h"
#include "host_sim/out/cell.h"
#include "host_sim/out/plural.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double monitor_look_s = 0.1; /* at the clock and for signals, while nothing comes */

static const struct option monitor_options[] = {
    {"only", "NAME,..", "print these messages only, e.g. STATUS,MOTION; see contactplant list messages",
     OPTION_TEXT, .initial = NULL},
    {"count", "N", "end after this many messages (0: never)", OPTION_INTEGER, 0.0, 1e15, .initial = "0"},
    {"duration", "S", "end after this many seconds (0: with Ctrl-C)", OPTION_NUMBER, 0.0, 1e9,
     .initial = "0"},
    {.name = "csv", .meaning = "print one row per value: frame,tick,message,item,field,value,unit"},
    {.name = NULL},
};

static const struct usage monitor_usage = {
    .name = "monitor",
    .words = "[SCENE]",
    .summary =
        "Prints the messages of a plant. It never sends: over UDP the plant must list it as a peer (run "
        "lists\n"
        "127.0.0.1:20002 by itself). Give the SCENE, --set, --setting, --rate, --substeps and --dilation of\n"
        "the plant: they give its numbers their meaning. Messages that depend on them are withheld until an\n"
        "INFO identity confirms them; the numbers of another plant are never printed. Exits with 1 for\n"
        "another plant, when it heard nothing, and when it had to withhold everything.",
    .words_help = SCENE_WORDS_HELP,
    .examples = "  contactplant monitor --only STATUS,EVENT_TIME,EVENT_DATA\n"
                "  contactplant monitor --only MOTION --csv --duration 5 > motion.csv\n"
                "  contactplant monitor --wide --duration 5 > rows.csv\n"
                "  contactplant monitor --json udp:127.0.0.1:9870          for PlotJuggler\n"
                "  contactplant monitor --bus can:can0 --base-id 0x240 --count 100\n",
    .max_words = 1,
    .table = {monitor_options, monitor_rows_options, bus_options, scene_options},
};

struct monitor {
    const struct options *o;
    struct remote remote;
    struct monitor_rows rows;
    bool only[WIRE_KINDS];
    bool csv;
    uint64_t wanted, printed;
    uint64_t withheld; /* for want of the plant's identity */
};

/* The name of what VALUE is ("mass_kg", "crc", ..), or "" where the message has one meaning only. */
static const char *item_of(const struct model *m, const struct message_layout *l, const struct message *msg,
                           int mux)
{
    const char *name = mux >= 0 ? names_text(m, l->field[mux].names, (unsigned)msg->value[mux]) : NULL;
    return name ? name : "";
}

/* A value by its name where it has one, else as a number; nothing where the plant could not say it. */
static void print_value(const struct model *m, const struct field *f, double value)
{
    const char *name =
        f->names != NAMES_NONE && value >= 0.0 ? names_text(m, f->names, (unsigned)value) : NULL;
    if (name)
        printf("%s", name);
    else
        cell_put(stdout, value, 9);
}

static void print_faults(unsigned faults)
{
    char names[TROUBLE_TEXT];
    trouble_note_faults(faults, names);
    printf("%s", names);
}

static void print_line(const struct monitor *k, const struct message *m, const struct message_layout *l)
{
    const struct model *model = k->remote.scene.config.model;
    printf("%10llu %12llu %-13s", (unsigned long long)k->remote.client.latest.frame,
           (unsigned long long)k->remote.client.latest.tick, names_kind(m->kind));
    for (int i = 0; i < l->n_fields; i++) {
        const char *unit = names_unit(model, m, i);
        printf(" %s=", l->field[i].name);
        print_value(model, &l->field[i], m->value[i]);
        if (isfinite(m->value[i]))
            printf("%s%s", *unit ? " " : "", unit);
        else
            printf("(not available)");
        if (m->kind == WIRE_STATUS && i == STATUS_FAULTS)
            print_faults((unsigned)m->value[i]);
    }
    printf("\n");
}

static void print_rows(const struct monitor *k, const struct message *m, const struct message_layout *l)
{
    const struct model *model = k->remote.scene.config.model;
    int mux = names_multiplexer(l);
    for (int i = 0; i < l->n_fields; i++) {
        if (i == mux)
            continue;
        printf("%llu,%llu,%s,%s,%s,", (unsigned long long)k->remote.client.latest.frame,
               (unsigned long long)k->remote.client.latest.tick, names_kind(m->kind),
               item_of(model, l, m, mux), l->field[i].name);
        print_value(model, &l->field[i], m->value[i]);
        printf(",%s\n", names_unit(model, m, i));
    }
}

/* The message says nothing that depends on model, LSBs, dilation or settings. */
static bool is_plain(const struct message_layout *l)
{
    if (wire_is_of_input(l) || l->kind == WIRE_LOCKIN)
        return false; /* the unit is an input's, the output a setting's */
    for (int i = 0; i < l->n_fields; i++) {
        const struct field *f = &l->field[i];
        if (f->scale >= SCALE_DISPLACEMENT || f->names == NAMES_PARAMETER || f->names == NAMES_LEDGER ||
            f->names == NAMES_INPUT || f->names == NAMES_OUTPUT || f->names == NAMES_OBSERVABLE)
            return false;
    }
    return true;
}

static void hear_rows(struct monitor *k, const struct message *m)
{
    if (k->wanted && k->printed >= k->wanted)
        return;
    if (client_identity(&k->remote.client) != CLIENT_SAME) {
        k->withheld++;
        return;
    }
    (void)monitor_rows_take(&k->rows, m);
    k->printed = k->rows.printed;
}

static void hear_message(void *context, const struct frame *f, const struct message *m)
{
    struct monitor *k = context;
    const struct message_layout *l = wire_layout(m->kind);
    (void)f;
    if (k->rows.wide || k->rows.json) {
        hear_rows(k, m);
        return;
    }
    if (!k->only[m->kind] || (k->wanted && k->printed >= k->wanted))
        return;
    if (!is_plain(l) && client_identity(&k->remote.client) != CLIENT_SAME) {
        k->withheld++;
        return;
    }
    k->printed++;
    if (k->csv)
        print_rows(k, m, l);
    else
        print_line(k, m, l);
}

static int no_message(const struct monitor *k, const char *text)
{
    const char *name[WIRE_KINDS];
    int n = 0;
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++)
        if (wire_layout(kind))
            name[n++] = names_kind(kind);
    return options_misuse(k->o->usage, "--only: no message \"%s\"%s", text,
                          options_advise(text, strlen(text), name, n, "contactplant list shows them"));
}

/* NAME,NAME,.. into k->only; without --only everything. */
static int read_only_list(struct monitor *k)
{
    const char *text = options_text(k->o, "only", 0);
    for (int i = 0; i < WIRE_KINDS; i++)
        k->only[i] = !text;
    while (text && *text) {
        char name[32];
        size_t n = strcspn(text, ",");
        snprintf(name, sizeof name, "%.*s", (int)n, text);
        int kind = names_find_kind(name);
        if (kind < 0)
            return no_message(k, name);
        k->only[kind] = true;
        text += n + (text[n] == ',');
    }
    return 0;
}

/* Once the plant has told that it is another one: why, with its parts. */
static int refuse_plant(struct monitor *k)
{
    char why[EXPLAIN_REASON];
    (void)client_wait_identity(&k->remote.client, 0.0);
    explain_identity(&k->remote.client, why);
    return options_failure(k->o->usage, "%s", why);
}

/* At the end: what could not be printed. A failure where nothing could. */
static int tell_withheld(const struct monitor *k)
{
    if (k->withheld)
        fprintf(stderr,
                "contactplant monitor: %llu message%s %s withheld until the plant tells its identity, every "
                "100 frames\n",
                (unsigned long long)k->withheld, plural((double)k->withheld),
                k->withheld == 1 ? "was" : "were");
    if (k->withheld && !k->printed)
        return options_failure(k->o->usage, "the plant has not told its identity (INFO); listen longer");
    return STATUS_DONE;
}

static int listen_in(struct monitor *k)
{
    double duration = options_number(k->o, "duration"), end = clock_now_s() + duration;
    uint64_t heard = 0;
    if (k->csv)
        printf("frame,tick,message,item,field,value,unit\n");
    while (!clock_interrupted() && !(duration > 0.0 && clock_now_s() >= end) &&
           !(k->wanted && k->printed >= k->wanted)) {
        int n = client_poll(&k->remote.client);
        heard += (uint64_t)n;
        if (client_identity(&k->remote.client) == CLIENT_OTHER)
            return refuse_plant(k);
        if (!n)
            bus_wait(&k->remote.bus, monitor_look_s);
        else if (fflush(stdout) || ferror(stdout))
            return STATUS_DONE; /* who read it has seen enough, or options_finish tells of a full disk */
    }
    if (k->remote.client.bad)
        fprintf(stderr, "contactplant monitor: %llu frame%s did not decode (CRC, length or counter)\n",
                (unsigned long long)k->remote.client.bad, plural((double)k->remote.client.bad));
    if (!heard)
        return options_failure(k->o->usage,
                               "heard nothing; is a plant running, and does it list us as a --peer?");
    return tell_withheld(k);
}

static int open_monitor(struct monitor *k)
{
    int status = read_only_list(k);
    status = status ? status : remote_open(&k->remote, k->o, BUS_MONITOR, 0);
    status = status ? status : monitor_rows_open(&k->rows, k->o, &k->remote.scene);
    k->remote.client.heard = hear_message;
    k->remote.client.heard_context = k;
    k->csv = options_given(k->o, "csv");
    k->wanted = (uint64_t)options_number(k->o, "count");
    return status;
}

int cmd_monitor(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &monitor_usage, argc, argv, &status))
        return status;
    struct monitor *k = calloc(1, sizeof *k);
    if (!k)
        return options_failure(&monitor_usage, "out of memory");
    k->o = &o;
    status = open_monitor(k);
    status = status ? status : listen_in(k);
    monitor_rows_close(&k->rows);
    remote_close(&k->remote);
    free(k);
    return status;
}
