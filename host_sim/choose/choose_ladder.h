/* choose_ladder.h - the reduced models of a model, and the same scene for each.
 *
 * The models of a family share the units of their states and the leading rows of their parameter tables,
 * in SI and in the paper's numbers. So a reduced model takes over the scene's values as they are. Its own
 * parameters stand behind them: the fast drive of an averaged model, the mode of the shaft's.
 *
 * A lever has fewer modes, or a sample that does not attract, or both. Two or three modes bring the spring of
 * the modes left out with them. One mode alone has no such spring: it takes the first mode's stiffness, as a
 * lever that swings has, and not the static one. */
#ifndef HOST_SIM_CHOOSE_LADDER_H
#define HOST_SIM_CHOOSE_LADDER_H

#include "host_sim/choose/choose.h"

/* The candidates of a scene, cheapest first, its own model last. Returns how many. */
int choose_ladder(const struct scene *s, struct choose_candidate candidate[CHOOSE_CANDIDATES]);

/* Has this model reduced models that keep one mode of it? */
bool choose_ladder_modal(const struct model *m);

/* Share of mode k = 0..2 of the open shaft in a motion x[3]: its amplitude at the bearing that moves more.
 * shape: shaft_open_modes(p). */
void choose_ladder_modes(const double *p, double shape[3][3], const double *x, double q[3]);

#endif
