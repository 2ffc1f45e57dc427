/* dbc.h - the .dbc of a scene: every message of a plant, with scales, units, names and cycle times. */
#ifndef HOST_SIM_DBC_H
#define HOST_SIM_DBC_H

#include <stdio.h>
#include "host_sim/database/bus_signals.h"

/* Prints it; the caller looks at ferror(out). Cycle times are those of the default settings. */
void dbc_print(FILE *out, const struct bus_scene *s);

#endif
