/* stability_tell.h - the kinds of cells, and the summary of a map: how much of it is unstable, and where. */
#ifndef HOST_SIM_STABILITY_TELL_H
#define HOST_SIM_STABILITY_TELL_H

#include "host_sim/maps/stability/stability.h"

/* How much of the map is unstable and where; see maps_finding. */
void stability_tell(void *context, const struct rows_table *t, FILE *f);

#endif
