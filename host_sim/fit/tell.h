/* tell.h - the result of a fit, in a table and in sentences. */
#ifndef HOST_SIM_FIT_TELL_H
#define HOST_SIM_FIT_TELL_H

#include "host_sim/fit/judge.h"

void tell_fit(struct fit_setup *s, const struct fit_result *r, const struct judged *j, FILE *f);

/* A value with its unit, in so many digits as its error allows. */
const char *tell_value(const struct fit_unknown *k, double value, double sd, char *text);

/* Half the width of the interval in percent, "0.35 %"; of a delay in seconds. */
const char *tell_width(const struct fit_unknown *k, double width, char *text);

#endif
