/* unknown.h - the plant and the response that follow from the unknowns. */
#ifndef HOST_SIM_FIT_UNKNOWN_H
#define HOST_SIM_FIT_UNKNOWN_H

#include "host_sim/fit/fit.h"

/* The unknown's value where it is u, and back. */
double unknown_value(const struct fit_unknown *k, double u);
double unknown_u(const struct fit_unknown *k, double value);

/* The plant of curve c where the unknowns are u. False: the model refuses it. */
bool unknown_task(const struct fit_setup *s, int c, const double *u, struct orbit_task *t);

/* Puts gain and delay of the measuring chain on a response of the plant. */
void unknown_measure(const struct fit_setup *s, const double *u, double frequency_Hz, double *re, double *im);

#endif
