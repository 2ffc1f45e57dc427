/* stability_figure.h - a stability map as a picture and a page: the cells of a kind have its colour. */
#ifndef HOST_SIM_STABILITY_FIGURE_H
#define HOST_SIM_STABILITY_FIGURE_H

#include "host_sim/maps/stability/stability.h"

/* See maps_finding; context is the struct stability. */
const char *stability_draw(void *context, const struct rows_table *t, struct figure *g);

#endif
