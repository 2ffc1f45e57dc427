/* places.h - where fits begin. */
#ifndef HOST_SIM_FIT_PLACES_H
#define HOST_SIM_FIT_PLACES_H

#include "host_sim/fit/fit.h"

enum { PLACES = 6 };

/* The best places that are found without a fit, the best first, into place[PLACES]. Returns how many; 0: no
 * plant near the start of the unknowns runs. *few becomes a setup with some points of the curves, where
 * first fits to these save time: thin_free it; else few->n is 0. */
int places_find(struct fit_setup *s, struct fit_setup *few, double (*place)[FIT_UNKNOWNS]);

/* The best places where only those unknowns differ from u on which the motions at u do not depend, into
 * place[most], most <= PLACES. Returns how many; 0: they depend on all. */
int places_unseen(struct fit_setup *few, const double *u, int most, double (*place)[FIT_UNKNOWNS]);

#endif
