/* dbc.h - the .dbc of a scene: every message of a plant, with scales, units, names and cycle times. */
#ifndef HOST_SIM_DBC_H
#define HOST_SIM_DBC_H

#include <stdint.h>
#include <stdio.h>
#include "firmware/bus/wire.h"
#include "models/model.h"

struct dbc_scene {
    const struct model *model;
    struct wire_scene wire;
    double f0_Hz; /* contact eigenfrequency of the real rig */
};

/* Prints it; the caller looks at ferror(out). Cycle times are those of the default settings. Where the
 * dilation is not 1, units that hold a bus second say so: Hz(bus), m/s(bus), s(bus). */
void dbc_print(FILE *out, const struct dbc_scene *s);

#endif
