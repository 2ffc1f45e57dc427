/* bus_signals.c - see bus_signals.h. */
#include "host_sim/database/bus_signals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/bus/settings.h"
#include "firmware/bus/wire_table.h"

const char *bus_number(char text[BUS_NUMBER], double x)
{
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, BUS_NUMBER, "%.*g", digits, x);
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

static void put_unit(const struct bus_scene *s, const char *unit, bool real, char out[BUS_UNIT])
{
    bool bus = s->wire.dilation != 1.0 && !real && holds_seconds(unit);

    snprintf(out, BUS_UNIT, "%s%s", unit, bus ? "(bus)" : "");
}

static void put_range(struct bus_signal *g)
{
    double span = ldexp(1.0, g->bits);

    if (g->kind == FIELD_UNSIGNED)
        g->max = (span - 1.0) * g->factor;
    if (g->kind == FIELD_SIGNED) {
        g->max = (span / 2.0 - 1.0) * g->factor;
        g->min = g->bits == 24 ? -g->max : -span / 2.0 * g->factor; /* 24 bits: not available */
    }
}

/* The number of a field that is no value. */
static double none_of(const struct field *d)
{
    bool of_ticks = d == &wire_layout(WIRE_REPLY)->field[REPLY_TICKS_LATE] ||
                    d == &wire_layout(WIRE_LATENCY)->field[LATENCY_APPLY];
    bool is_int24 = d->kind == FIELD_SIGNED && d->bits == 24;
    return of_ticks ? 65535.0 : is_int24 ? -8388608.0 : (double)NAN;
}

static struct bus_signal signal_of(const struct bus_scene *s, const struct field *d)
{
    struct bus_signal g = {.name = d->name,
                           .meaning = d->meaning,
                           .start = d->start,
                           .bits = d->bits,
                           .kind = d->kind,
                           .factor = wire_factor(&s->wire, d->scale),
                           .none = none_of(d),
                           .multiplex = BUS_PLAIN,
                           .names = d->names};

    put_range(&g);
    return g;
}

/* VALUE as selected by entry `index` of the multiplexer's list. */
static struct bus_signal selected_signal(const struct bus_scene *s, unsigned kind, int by, int index,
                                         const struct named *n)
{
    const struct message_layout *l = wire_layout(kind);
    struct message msg = {.kind = (uint8_t)kind};
    struct bus_signal g = signal_of(s, &l->field[l->n_fields - 1]);
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

int bus_signals(const struct bus_scene *s, unsigned kind, struct bus_signal g[BUS_SIGNALS])
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
        g[n++].multiplex = i == by ? BUS_MULTIPLEXER : BUS_PLAIN;
    }
    for (unsigned i = 0; by >= 0 && i < NAMES_INDICES; i++)
        if (names_get(s->model, l->field[by].names, i, &entry))
            g[n++] = selected_signal(s, kind, by, (int)i, &entry);
    return n;
}

bool bus_has(const struct bus_scene *s, unsigned kind)
{
    const struct message_layout *l = wire_layout(kind);

    return l != NULL && (int)(kind - l->kind) < s->model->n_inputs;
}
