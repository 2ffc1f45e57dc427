/* dbc.c - prints the message table as a .dbc that strict readers load: plain identifiers, little endian,
 * SI units. */
#include "host_sim/cli/dbc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/bus/settings.h"
#include "host_sim/cli/names.h"

enum { DBC_SIGNALS = 2 + WIRE_FIELDS + NAMES_INDICES, DBC_UNIT = 32, DBC_NUMBER = 32 };

/* Multiplexing of a signal; m >= 0 is the multiplexer's value that selects it. */
enum { PLAIN = -1, MULTIPLEXER = -2 };

/* One line of a message, ready to print. */
struct dbc_signal {
    const char *name, *meaning;
    char unit[DBC_UNIT];
    int start, bits;
    enum field_kind kind;
    double factor, min, max;
    int multiplex;
    enum field_names names;
};

/* The shortest decimal that reads back as the same number. */
static const char *number(char text[DBC_NUMBER], double x)
{
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, DBC_NUMBER, "%.*g", digits, x);
        if (strtod(text, NULL) == x)
            break;
    }
    return text;
}

static bool holds_seconds(const char *unit)
{
    static const char *const timed[] = {"s", "Hz", "m/s"};

    for (size_t i = 0; i < sizeof timed / sizeof timed[0]; i++)
        if (strcmp(unit, timed[i]) == 0)
            return true;
    return false;
}

/* Parameters of the model and the real f0 are those of the real rig; all other times are the bus's. */
static bool is_real(enum field_names list, int index)
{
    return (list == NAMES_PARAMETER && index < SETTING_FIRST) ||
           (list == NAMES_INFO && index == INFO_F0_REAL_HZ);
}

static void put_unit(const struct dbc_scene *s, const char *unit, bool real, char out[DBC_UNIT])
{
    bool bus = s->wire.dilation != 1.0 && !real && holds_seconds(unit);

    snprintf(out, DBC_UNIT, "%s%s", unit, bus ? "(bus)" : "");
}

static void put_range(struct dbc_signal *g)
{
    double span = ldexp(1.0, g->bits);

    if (g->kind == FIELD_UNSIGNED)
        g->max = (span - 1.0) * g->factor;
    if (g->kind == FIELD_SIGNED) {
        g->max = (span / 2.0 - 1.0) * g->factor;
        g->min = g->bits == 24 ? -g->max : -span / 2.0 * g->factor; /* 24 bits: not available */
    }
}

static struct dbc_signal signal_of(const struct dbc_scene *s, const struct field *d)
{
    struct dbc_signal g = {.name = d->name,
                           .meaning = d->meaning,
                           .start = d->start,
                           .bits = d->bits,
                           .kind = d->kind,
                           .factor = wire_factor(&s->wire, d->scale),
                           .multiplex = PLAIN,
                           .names = d->names};

    put_range(&g);
    return g;
}

/* VALUE as selected by entry `index` of the multiplexer's list. */
static struct dbc_signal selected_signal(const struct dbc_scene *s, unsigned kind, int by, int index,
                                         const struct named *n)
{
    const struct message_layout *l = wire_layout(kind);
    struct message msg = {.kind = (uint8_t)kind};
    struct dbc_signal g = signal_of(s, &l->field[l->n_fields - 1]);
    const struct parameter *p = NULL;

    if (l->kind == WIRE_DRIVE_ECHO)
        msg.value[DRIVE_ECHO_CHANNEL] = NAMES_INDICES; /* any: the amplitude's unit stays open */
    msg.value[by] = index;
    put_unit(s, names_unit(s->model, &msg, l->n_fields - 1), is_real(l->field[by].names, index), g.unit);
    if (l->field[by].names == NAMES_PARAMETER)
        p = index < SETTING_FIRST ? &s->model->parameter[index] : &setting_table[index - SETTING_FIRST];
    g.min = p ? p->min : g.min;
    g.max = p ? p->max : g.max;
    g.name = n->name;
    g.meaning = n->meaning;
    g.multiplex = index;
    return g;
}

/* All signals of a message; returns their number. */
static int signals_of(const struct dbc_scene *s, unsigned kind, struct dbc_signal g[DBC_SIGNALS])
{
    static const struct field checksum = {"CHECKSUM",
                                          "CRC-8 of AUTOSAR E2E profile 1 over identifier and bytes 1-7",
                                          0,
                                          8,
                                          FIELD_UNSIGNED,
                                          SCALE_ONE,
                                          NAMES_NONE,
                                          ""};
    static const struct field counter = {"COUNTER",
                                         "0..14, one more with each frame of this identifier",
                                         8,
                                         4,
                                         FIELD_UNSIGNED,
                                         SCALE_ONE,
                                         NAMES_NONE,
                                         ""};
    const struct message_layout *l = wire_layout(kind);
    struct message msg = {.kind = (uint8_t)kind};
    int by = names_multiplexer(l), n = 0;
    struct named entry;

    g[n++] = signal_of(s, &checksum);
    g[n++] = signal_of(s, &counter);
    g[1].max = WIRE_COUNTER_STATES - 1;
    for (int i = 0; i < l->n_fields - (by >= 0); i++) {
        g[n] = signal_of(s, &l->field[i]);
        put_unit(s, names_unit(s->model, &msg, i), false, g[n].unit);
        g[n++].multiplex = i == by ? MULTIPLEXER : PLAIN;
    }
    for (unsigned i = 0; by >= 0 && i < NAMES_INDICES; i++)
        if (names_get(s->model, l->field[by].names, i, &entry))
            g[n++] = selected_signal(s, kind, by, (int)i, &entry);
    return n;
}

/* The identifier as a .dbc writes it: bit 31 marks 29-bit ones. */
static unsigned long dbc_id(const struct dbc_scene *s, unsigned kind)
{
    return (unsigned long)(s->wire.base_id + kind) | (s->wire.extended ? 1ul << 31 : 0ul);
}

/* Kinds that this model has: none for inputs that it has not. */
static bool has_kind(const struct dbc_scene *s, unsigned kind)
{
    const struct message_layout *l = wire_layout(kind);

    return l != NULL && (int)(kind - l->kind) < s->model->n_inputs;
}

static void print_signal(FILE *out, const struct dbc_signal *g, bool command)
{
    char multiplex[16] = "", factor[DBC_NUMBER], min[DBC_NUMBER], max[DBC_NUMBER];

    if (g->multiplex == MULTIPLEXER)
        snprintf(multiplex, sizeof multiplex, " M");
    if (g->multiplex >= 0)
        snprintf(multiplex, sizeof multiplex, " m%d", g->multiplex);
    fprintf(out, " SG_ %s%s : %d|%d@1%c (%s,0) [%s|%s] \"%s\" %s\n", g->name, multiplex, g->start, g->bits,
            g->kind == FIELD_UNSIGNED ? '+' : '-', number(factor, g->factor), number(min, g->min),
            number(max, g->max), g->unit, command ? "PLANT" : "CONTROLLER");
}

static void print_message(FILE *out, const struct dbc_scene *s, unsigned kind)
{
    const struct message_layout *l = wire_layout(kind);
    struct dbc_signal g[DBC_SIGNALS];
    int n = signals_of(s, kind, g);

    fprintf(out, "BO_ %lu %s: 8 %s\n", dbc_id(s, kind), names_kind(kind),
            l->command ? "CONTROLLER" : "PLANT");
    for (int i = 0; i < n; i++)
        print_signal(out, &g[i], l->command);
    fprintf(out, "\n");
}

static void print_network_comment(FILE *out, const struct dbc_scene *s)
{
    fprintf(
        out,
        "CM_ \"contactplant %s. Plant frames at %g Hz, %u ticks each. Lengths, forces and energies are real; "
        "seconds on the bus are bus seconds, one bus second = 1/D real seconds. Real f0 %g Hz, dilation D = "
        "%g, "
        "f0 on the bus %g Hz. Unused bits are 0. This file is of the plant whose INFO identity is %u: "
        "believe "
        "no scaled number of another one.\";\n",
        s->model->name, s->wire.frame_rate_Hz, (unsigned)s->wire.substeps, s->f0_Hz, s->wire.dilation,
        s->f0_Hz / s->wire.dilation, (unsigned)s->wire.identity);
}

static void print_comments(FILE *out, const struct dbc_scene *s, unsigned kind)
{
    const struct message_layout *l = wire_layout(kind);
    struct dbc_signal g[DBC_SIGNALS];
    int n = signals_of(s, kind, g);
    bool of_input = wire_is_of_input(l);

    fprintf(out, "CM_ BO_ %lu \"%s%s%s\";\n", dbc_id(s, kind), l->meaning, of_input ? "; input " : "",
            of_input ? s->model->input_signal[kind - l->kind].name : "");
    for (int i = 0; i < n; i++)
        fprintf(out, "CM_ SG_ %lu %s \"%s\";\n", dbc_id(s, kind), g[i].name, g[i].meaning);
}

/* Bus frames from one message to the next by the default settings; 0: not cyclic. */
static double default_period(const struct dbc_scene *s, unsigned kind)
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

static void print_cycle(FILE *out, const struct dbc_scene *s, unsigned kind)
{
    double cycle_ms = default_period(s, kind) * 1000.0 / s->wire.frame_rate_Hz;

    if (cycle_ms > 0.0)
        fprintf(out, "BA_ \"GenMsgCycleTime\" BO_ %lu %.0f;\n", dbc_id(s, kind),
                fmin(fmax(ceil(cycle_ms), 1.0), 65535.0));
}

static void print_values(FILE *out, const struct dbc_scene *s, unsigned long id, const struct dbc_signal *g)
{
    if (g->kind == FIELD_SIGNED && g->bits == 24)
        fprintf(out, "VAL_ %lu %s -8388608 \"not_available\" ;\n", id, g->name);
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

static void print_names(FILE *out, const struct dbc_scene *s, unsigned kind)
{
    struct dbc_signal g[DBC_SIGNALS];
    int n = signals_of(s, kind, g);

    for (int i = 0; i < n; i++)
        print_values(out, s, dbc_id(s, kind), &g[i]);
}

static void print_floats(FILE *out, const struct dbc_scene *s, unsigned kind)
{
    struct dbc_signal g[DBC_SIGNALS];
    int n = signals_of(s, kind, g);

    for (int i = 0; i < n; i++)
        if (g[i].kind == FIELD_FLOAT)
            fprintf(out, "SIG_VALTYPE_ %lu %s : 1;\n", dbc_id(s, kind), g[i].name);
}

static void for_each_kind(FILE *out, const struct dbc_scene *s,
                          void (*print)(FILE *out, const struct dbc_scene *s, unsigned kind))
{
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++)
        if (has_kind(s, kind))
            print(out, s, kind);
}

void dbc_print(FILE *out, const struct dbc_scene *s)
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
