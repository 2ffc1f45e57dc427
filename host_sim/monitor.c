/* monitor.c - what a plant says, by name and unit, one line a message. */
#include "host_sim/clock.h"
#include "host_sim/commands.h"
#include "host_sim/names.h"
#include "host_sim/options.h"
#include "host_sim/station.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double poll_s = 500e-6;

static const struct option own[] = {
    {"only", "NAME,..", "these messages only, e.g. STATUS,MOTION; see contactplant list", OPTION_TEXT,
     .initial = NULL},
    {"count", "N", "end after so many messages (0: never)", OPTION_INTEGER, 0.0, 1e15, .initial = "0"},
    {"duration", "S", "end after so many seconds (0: with Ctrl-C)", OPTION_NUMBER, 0.0, 1e9, .initial = "0"},
    {.name = "csv", .meaning = "one row a value: frame,tick,message,item,field,value,unit"},
    {.name = NULL},
};

static const struct usage usage = {
    .name = "monitor",
    .words = "[SCENE]",
    .summary =
        "Prints what a plant says. It never speaks: over UDP the plant must list it as a peer (run lists\n"
        "127.0.0.1:20002 by itself). Give SCENE, --set and --dilation as to the plant: displacement, "
        "velocity,\n"
        "penetration and force are scaled by them. Exits with 1 when nothing at all was heard.",
    .words_help = SCENE_WORDS_HELP,
    .examples = "  contactplant monitor --only STATUS,EVENT_TIME,EVENT_DATA\n"
                "  contactplant monitor --only MOTION --csv --duration 5 > motion.csv\n"
                "  contactplant monitor --bus can:can0 --base-id 0x240 --count 100\n",
    .max_words = 1,
    .table = {own, bus_options, scene_options},
};

struct monitor {
    const struct options *o;
    struct station station;
    bool only[WIRE_KINDS];
    bool csv;
    uint64_t wanted, printed;
};

/* The name of what VALUE is ("mass_kg", "crc", ..), or "" where the message has one meaning only. */
static const char *item_of(const struct model *m, const struct message_layout *l, const struct message *msg,
                           int mux)
{
    const char *name = mux >= 0 ? names_text(m, l->field[mux].names, (unsigned)msg->value[mux]) : NULL;
    return name ? name : "";
}

/* A value by its name where it has one, else as a number; NaN is what the plant could not say. */
static void print_value(const struct model *m, const struct field *f, double value)
{
    const char *name =
        f->names != NAMES_NONE && value >= 0.0 ? names_text(m, f->names, (unsigned)value) : NULL;
    if (name)
        printf("%s", name);
    else
        printf("%.9g", value);
}

static void print_line(const struct monitor *k, const struct message *m, const struct message_layout *l)
{
    const struct model *model = k->station.scene.config.model;
    printf("%10llu %12llu %-13s", (unsigned long long)k->station.client.latest.frame,
           (unsigned long long)k->station.client.latest.tick, names_kind(m->kind));
    for (int i = 0; i < l->n_fields; i++) {
        const char *unit = names_unit(model, m, i);
        printf(" %s=", l->field[i].name);
        print_value(model, &l->field[i], m->value[i]);
        printf("%s%s", *unit ? " " : "", unit);
    }
    printf("\n");
}

static void print_rows(const struct monitor *k, const struct message *m, const struct message_layout *l)
{
    const struct model *model = k->station.scene.config.model;
    int mux = names_multiplexer(l);
    for (int i = 0; i < l->n_fields; i++) {
        if (i == mux)
            continue;
        printf("%llu,%llu,%s,%s,%s,", (unsigned long long)k->station.client.latest.frame,
               (unsigned long long)k->station.client.latest.tick, names_kind(m->kind),
               item_of(model, l, m, mux), l->field[i].name);
        print_value(model, &l->field[i], m->value[i]);
        printf(",%s\n", names_unit(model, m, i));
    }
}

static void hear(void *context, const struct frame *f, const struct message *m)
{
    struct monitor *k = context;
    const struct message_layout *l = wire_layout(m->kind);
    (void)f;
    if (!k->only[m->kind] || (k->wanted && k->printed >= k->wanted))
        return;
    k->printed++;
    if (k->csv)
        print_rows(k, m, l);
    else
        print_line(k, m, l);
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
            return options_misuse(k->o->usage, "--only: no message \"%s\"; contactplant list shows them",
                                  name);
        k->only[kind] = true;
        text += n + (text[n] == ',');
    }
    return 0;
}

static int listen_in(struct monitor *k)
{
    double duration = options_number(k->o, "duration"), end = clock_now_s() + duration;
    uint64_t heard = 0;
    if (k->csv)
        printf("frame,tick,message,item,field,value,unit\n");
    while (!clock_interrupted() && !(duration > 0.0 && clock_now_s() >= end) &&
           !(k->wanted && k->printed >= k->wanted)) {
        int n = client_poll(&k->station.client);
        heard += (uint64_t)n;
        if (!n)
            clock_sleep_s(poll_s);
        else if (fflush(stdout) || ferror(stdout))
            return errno == EPIPE
                       ? STATUS_DONE /* who read it has seen enough */
                       : options_failure(k->o->usage, "cannot write the output; make room and run again");
    }
    if (k->station.client.bad)
        fprintf(stderr, "contactplant monitor: %llu frames did not decode (CRC, length or counter)\n",
                (unsigned long long)k->station.client.bad);
    if (!heard)
        return options_failure(k->o->usage,
                               "heard nothing; is a plant running, and does it list us as a --peer?");
    return STATUS_DONE;
}

static int prepare(struct monitor *k)
{
    int status = read_only_list(k);
    status = status ? status : station_open(&k->station, k->o, BUS_MONITOR, 0);
    k->station.client.heard = hear;
    k->station.client.heard_context = k;
    k->csv = options_given(k->o, "csv");
    k->wanted = (uint64_t)options_number(k->o, "count");
    return status;
}

int cmd_monitor(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &usage, argc, argv, &status))
        return status;
    struct monitor *k = calloc(1, sizeof *k);
    if (!k)
        return options_failure(&usage, "out of memory");
    k->o = &o;
    status = prepare(k);
    status = status ? status : listen_in(k);
    station_close(&k->station);
    free(k);
    return status;
}
