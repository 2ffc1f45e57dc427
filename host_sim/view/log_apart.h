/* log_apart.h - where two logs of one plant differ, as an index of its own. */
#ifndef HOST_SIM_LOG_APART_H
#define HOST_SIM_LOG_APART_H

#include "host_sim/view/log_index.h"

/* Reads both from their begin: each signal of *x is that of a less that of b, of rows with one tick. It has
 * bins and no rows. NULL, or the reason. *x is all zero before. */
const char *log_apart(struct log_index *x, const struct log_index *a, const struct log_index *b);

#endif
