/* picture.h - data, fit, residuals and profiles as a picture and a page. */
#ifndef HOST_SIM_FIT_PICTURE_H
#define HOST_SIM_FIT_PICTURE_H

#include "host_sim/fit/judge.h"

/* Writes --svg and --report. 0, or the exit status after a line. */
int picture_write(struct fit_setup *s, const struct fit_result *r, const struct judged *j);

#endif
