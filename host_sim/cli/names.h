/* names.h - the names behind numbers on the wire: enumerated values, parameters, settings, counters, and
 * units.
 *
 * The .dbc printer, the monitor and the sender all use these, so that they speak alike. */
#ifndef HOST_SIM_NAMES_H
#define HOST_SIM_NAMES_H

#include <stdbool.h>
#include "firmware/bus/wire.h"
#include "firmware/bus/wire_table.h"
#include "models/model.h"

enum { NAMES_INDICES = 256 }; /* every list ends before */

struct named {
    const char *name;    /* a plain identifier */
    const char *unit;    /* unit of its value, SI; "" for none */
    const char *meaning; /* one line; "" where the name says it all */
};

/* Entry `index` of a list, false when there is none. Amplitude and noise of a drive have the unit of their
 * input: here "". */
bool names_get(const struct model *m, enum field_names list, unsigned index, struct named *n);

/* The name alone, or NULL. */
const char *names_text(const struct model *m, enum field_names list, unsigned index);

/* The index of a name, or -1. */
int names_find(const struct model *m, enum field_names list, const char *name);

/* "FIRE", "STREAM_2", ..; NULL when there is no such message. */
const char *names_kind(unsigned kind);

/* The kind of a message's name, or -1. */
int names_find_kind(const char *name);

/* The field of a layout that says what its VALUE is, or -1 where VALUE needs no such field. */
int names_multiplexer(const struct message_layout *l);

/* Unit of a field of a decoded message (or of one to be sent), "" for none. */
const char *names_unit(const struct model *m, const struct message *msg, int field);

#endif
