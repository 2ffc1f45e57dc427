/* fitted.h - the scene that a fit found, as a file. */
#ifndef HOST_SIM_FIT_FITTED_H
#define HOST_SIM_FIT_FITTED_H

#include "host_sim/fit/judge.h"

/* Writes --out: the scene with the fitted numbers; intervals, data and what speaks against it as comments. 0,
 * or the exit status after a line. */
int fitted_write(const struct fit_setup *s, const struct fit_result *r, const struct judged *j);

#endif
