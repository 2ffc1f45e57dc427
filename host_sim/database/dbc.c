/* dbc.c - prints the message table as a .dbc that strict readers load: plain identifiers, little endian,
 * SI units. */
#include "host_sim/database/dbc.h"

#include <math.h>
#include "firmware/bus/settings.h"
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/names.h"

/* The identifier as a .dbc writes it: bit 31 marks 29-bit ones. */
static unsigned long dbc_id(const struct bus_scene *s, unsigned kind)
{
    return (unsigned long)(s->wire.base_id + kind) | (s->wire.extended ? 1ul << 31 : 0ul);
}

static void print_signal(FILE *out, const struct bus_signal *g, bool command)
{
    char multiplex[16] = "", factor[BUS_NUMBER], min[BUS_NUMBER], max[BUS_NUMBER];

    if (g->multiplex == BUS_MULTIPLEXER)
        snprintf(multiplex, sizeof multiplex, " M");
    if (g->multiplex >= 0)
        snprintf(multiplex, sizeof multiplex, " m%d", g->multiplex);
    fprintf(out, " SG_ %s%s : %d|%d@1%c (%s,0) [%s|%s] \"%s\" %s\n", g->name, multiplex, g->start, g->bits,
            g->kind == FIELD_UNSIGNED ? '+' : '-', bus_number(factor, g->factor), bus_number(min, g->min),
            bus_number(max, g->max), g->unit, command ? "PLANT" : "CONTROLLER");
}

static void print_message(FILE *out, const struct bus_scene *s, unsigned kind)
{
    const struct message_layout *l = wire_layout(kind);
    struct bus_signal g[BUS_SIGNALS];
    int n = bus_signals(s, kind, g);

    fprintf(out, "BO_ %lu %s: 8 %s\n", dbc_id(s, kind), names_kind(kind),
            l->command ? "CONTROLLER" : "PLANT");
    for (int i = 0; i < n; i++)
        print_signal(out, &g[i], l->command);
    fprintf(out, "\n");
}

static void print_network_comment(FILE *out, const struct bus_scene *s)
{
    fprintf(out,
            "CM_ \"contactplant %s. Plant frames at %g Hz, %u ticks each. Lengths, forces and energies are "
            "real; seconds on the bus are bus seconds, one bus second = 1/D real seconds. Real f0 %g Hz, "
            "dilation D = %g, f0 on the bus %g Hz. Unused bits are 0. This file is of the plant whose INFO "
            "identity is %u: believe no scaled number of another one.\";\n",
            s->model->name, s->wire.frame_rate_Hz, (unsigned)s->wire.substeps, s->f0_Hz, s->wire.dilation,
            s->f0_Hz / s->wire.dilation, (unsigned)s->wire.identity);
}

static void print_comments(FILE *out, const struct bus_scene *s, unsigned kind)
{
    const struct message_layout *l = wire_layout(kind);
    struct bus_signal g[BUS_SIGNALS];
    int n = bus_signals(s, kind, g);
    bool of_input = wire_is_of_input(l);

    fprintf(out, "CM_ BO_ %lu \"%s%s%s\";\n", dbc_id(s, kind), l->meaning, of_input ? "; input " : "",
            of_input ? s->model->input_signal[kind - l->kind].name : "");
    for (int i = 0; i < n; i++)
        fprintf(out, "CM_ SG_ %lu %s \"%s\";\n", dbc_id(s, kind), g[i].name, g[i].meaning);
}

/* Bus frames from one message to the next by the default settings; 0: not cyclic. */
static double default_period(const struct bus_scene *s, unsigned kind)
{
    static const struct {
        unsigned kind;
        enum setting setting;
    } every[] = {
        {WIRE_STATUS, SET_STATUS_EVERY},   {WIRE_MOTION, SET_MOTION_EVERY},
        {WIRE_CONTACT, SET_CONTACT_EVERY}, {WIRE_SYNC, SET_SYNC_EVERY},
        {WIRE_LOCKIN, SET_LOCKIN_FRAMES},  {WIRE_DRIVE_ECHO, SET_ECHO_EVERY},
        {WIRE_LEDGER, SET_LEDGER_EVERY},   {WIRE_EVENT_SUMMARY, SET_SUMMARY_EVERY},
        {WIRE_HEALTH, SET_HEALTH_EVERY},   {WIRE_HASH, SET_HASH_EVERY},
    };

    if (kind == WIRE_ENABLE) /* a heartbeat: five chances before the time-out */
        return setting_initial(SET_TIMEOUT_FRAMES, s->model, 1.0 / s->wire.frame_rate_Hz) / 5.0;
    for (size_t i = 0; i < sizeof every / sizeof every[0]; i++)
        if (every[i].kind == kind)
            return setting_table[every[i].setting].initial;
    return 0.0;
}

static void print_cycle(FILE *out, const struct bus_scene *s, unsigned kind)
{
    double cycle_ms = default_period(s, kind) * 1000.0 / s->wire.frame_rate_Hz;

    if (cycle_ms > 0.0)
        fprintf(out, "BA_ \"GenMsgCycleTime\" BO_ %lu %.0f;\n", dbc_id(s, kind),
                fmin(fmax(ceil(cycle_ms), 1.0), 65535.0));
}

static void print_values(FILE *out, const struct bus_scene *s, unsigned long id, const struct bus_signal *g)
{
    if (!isnan(g->none))
        fprintf(out, "VAL_ %lu %s %.0f \"not_available\" ;\n", id, g->name, g->none);
    if (g->names == NAMES_NONE || g->multiplex >= 0)
        return;
    fprintf(out, "VAL_ %lu %s", id, g->name);
    for (unsigned i = 0; i < NAMES_INDICES; i++) {
        const char *name = names_text(s->model, g->names, i);
        if (name != NULL)
            fprintf(out, " %u \"%s\"", i, name);
    }
    fprintf(out, " ;\n");
}

static void print_names(FILE *out, const struct bus_scene *s, unsigned kind)
{
    struct bus_signal g[BUS_SIGNALS];
    int n = bus_signals(s, kind, g);

    for (int i = 0; i < n; i++)
        print_values(out, s, dbc_id(s, kind), &g[i]);
}

static void print_floats(FILE *out, const struct bus_scene *s, unsigned kind)
{
    struct bus_signal g[BUS_SIGNALS];
    int n = bus_signals(s, kind, g);

    for (int i = 0; i < n; i++)
        if (g[i].kind == FIELD_FLOAT)
            fprintf(out, "SIG_VALTYPE_ %lu %s : 1;\n", dbc_id(s, kind), g[i].name);
}

static void for_each_kind(FILE *out, const struct bus_scene *s,
                          void (*print)(FILE *out, const struct bus_scene *s, unsigned kind))
{
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++)
        if (bus_has(s, kind))
            print(out, s, kind);
}

void dbc_print(FILE *out, const struct bus_scene *s)
{
    fprintf(out, "VERSION \"%d\"\n\nNS_ :\n\nBS_:\n\nBU_: PLANT CONTROLLER\n\n", WIRE_VERSION);
    for_each_kind(out, s, print_message);
    print_network_comment(out, s);
    for_each_kind(out, s, print_comments);
    fprintf(out, "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 0;\n");
    for_each_kind(out, s, print_cycle);
    fprintf(out, "BA_DEF_ \"PlantIdentity\" INT 0 16777215;\nBA_DEF_DEF_ \"PlantIdentity\" 0;\n");
    fprintf(out, "BA_ \"PlantIdentity\" %u;\n", (unsigned)s->wire.identity);
    for_each_kind(out, s, print_names);
    for_each_kind(out, s, print_floats);
}
