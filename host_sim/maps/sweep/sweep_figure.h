/* sweep_figure.h - a sweep from its rows, as a picture and a page: amplitudes, phase, time out of contact and
 * peak force, and its jumps one by one.
 *
 * Up and down have a colour each, or each value of the family has one. Jumps are dashed. */
#ifndef HOST_SIM_SWEEP_FIGURE_H
#define HOST_SIM_SWEEP_FIGURE_H

#include "host_sim/maps/sweep/sweep.h"

/* See maps_finding; context is the struct sweep. */
const char *sweep_draw(void *context, const struct rows_table *t, struct figure *g);

#endif
