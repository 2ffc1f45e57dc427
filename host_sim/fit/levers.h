/* levers.h - fits of an AFM lever: its unknowns, where they start, and the noise of its data.
 *
 * A spectrum tells f0, stiffness and quality: the stiffness by equipartition, at the scene's temperature. A
 * force curve tells modulus and Hamaker constants in units of stiffness and radius, where contact begins, and
 * the deflection outside. */
#ifndef HOST_SIM_FIT_LEVERS_H
#define HOST_SIM_FIT_LEVERS_H

#include "host_sim/fit/fit.h"

/* The data can tell this parameter of afm_lever. */
bool levers_tell(const struct fit_setup *s, int parameter);

/* The numbers of the chain: contact and baseline of a curve, white noise of a spectrum; not before the named
 * ones. 0, or the exit status after a line. */
int levers_add_chain(struct fit_setup *s, int (*add)(struct fit_setup *s, const struct fit_unknown *k));

/* The unknowns u become what is seen of the data without a fit. */
void levers_start(struct fit_setup *s, double *u);

/* Until there are residuals; then by these, of all data. */
void levers_assume_noise(struct fit_setup *s);
void levers_estimate_noise(struct fit_setup *s, const double *r);

/* chi^2 of data whose neighbours are alike is so many times what independent ones have; 1 without levers. */
double levers_widening(const struct fit_setup *s);

/* The numbers of the scene that stay as they are. */
void levers_tell_rest(const struct fit_setup *s, FILE *f);

#endif
