/* stability_cell.h - one cell of a stability map: multipliers, or the energy and switches of a run. */
#ifndef HOST_SIM_STABILITY_CELL_H
#define HOST_SIM_STABILITY_CELL_H

#include "host_sim/maps/stability/stability.h"

/* Fills cell[FLOQUET_COLUMNS or CONTACT_COLUMNS], of which y and x are given. NULL, or why there is none. */
const char *stability_floquet_cell(const struct stability *s, const struct scene *scene, double *cell);
const char *stability_contact_cell(const struct stability *s, const struct scene *scene, double *cell);

#endif
