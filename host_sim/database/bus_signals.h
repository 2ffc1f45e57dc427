/* bus_signals.h - the signals of a scene's messages, as other tools take them: the .dbc and the dissector are
 * printed from these. A VALUE that another field explains becomes a signal for each entry of that field. */
#ifndef HOST_SIM_BUS_SIGNALS_H
#define HOST_SIM_BUS_SIGNALS_H

#include <stdbool.h>
#include "firmware/bus/wire.h"
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/names.h"
#include "models/model.h"

enum { BUS_SIGNALS = 2 + WIRE_FIELDS + NAMES_INDICES, BUS_UNIT = 32, BUS_NUMBER = 32 };

/* Multiplexing of a signal; m >= 0 is the multiplexer's value that selects it. */
enum { BUS_PLAIN = -1, BUS_MULTIPLEXER = -2 };

struct bus_scene {
    const struct model *model;
    struct wire_scene wire;
    double f0_Hz; /* contact eigenfrequency of the real rig */
};

struct bus_signal {
    const char *name, *meaning;
    char unit[BUS_UNIT]; /* where the dilation is not 1, units that hold a bus second say so: Hz(bus) */
    int start, bits;
    enum field_kind kind;
    double factor, min, max; /* value = number * factor */
    double none;             /* the number that says "not available"; NaN: it has none */
    int multiplex;
    enum field_names names;
};

/* Kinds that this model has: none for inputs that it has not. */
bool bus_has(const struct bus_scene *s, unsigned kind);

/* All signals of a message; returns their number. */
int bus_signals(const struct bus_scene *s, unsigned kind, struct bus_signal g[BUS_SIGNALS]);

/* The shortest decimal that reads back as the same number. Returns text. */
const char *bus_number(char text[BUS_NUMBER], double x);

#endif
