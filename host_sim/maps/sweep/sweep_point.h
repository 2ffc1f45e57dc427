/* sweep_point.h - one round of a point of a sweep: settles a plant, then measures it. */
#ifndef HOST_SIM_SWEEP_POINT_H
#define HOST_SIM_SWEEP_POINT_H

#include "host_sim/maps/sweep/sweep.h"

/* The slowest drive that sounds, or -1. */
int sweep_reference(const struct scene *s);

/* Takes at->x from at->shown, at the end of a point of this scene. */
void sweep_take_state(const struct sweep *s, const struct scene *scene, struct sweep_state *at);

/* NULL, or why the plant refuses this point of the scene. */
const char *sweep_check(struct sweep *s, const struct scene *scene);

/* One round of a point, measured `times` as long as asked. begin: NULL for the scene's start. NULL, or why
 * the plant refuses. */
const char *sweep_point(struct sweep *s, const struct scene *scene, double value,
                        const struct sweep_state *begin, int times, struct sweep_result *r);

/* The change of the harmonics from a to b, over the largest of b. */
double sweep_change(const struct sweep *s, const struct sweep_measured *a, const struct sweep_measured *b);

/* The largest amplitude that was measured, and at least the rounding errors of an output that does not
 * move. */
double sweep_largest(const struct sweep *s, const struct sweep_measured *y);

#endif
