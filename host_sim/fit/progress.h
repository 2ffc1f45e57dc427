/* progress.h - how far a long fit is, as a line on stderr. */
#ifndef HOST_SIM_FIT_PROGRESS_H
#define HOST_SIM_FIT_PROGRESS_H

#include "host_sim/fit/fit.h"

/* Tells `done` of `all` of what it does, at most once a second, on a terminal only. */
void progress_tell(struct fit_setup *s, const char *what, int done, int all);

/* Clears that line. */
void progress_clear(struct fit_setup *s);

#endif
