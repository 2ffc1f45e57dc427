/* options_nearest.h - the name that was meant. It prints nothing, and the library uses it, too. */
#ifndef HOST_SIM_OPTIONS_NEAREST_H
#define HOST_SIM_OPTIONS_NEAREST_H

#include "host_sim/cli/options.h"

/* The nearest of n names to a mistyped one, whatever its capitals, or NULL when none is near. */
const char *options_nearest(const char *text, const char *const *name, int n);

/* The end of a line that refuses a name: `; did you mean X?`. Where nothing is near: `; HINT`, or without one
 * `; there are X, Y, ..`. The text lasts as long as the block of the call; options_advise_in writes it into
 * advice[size]. */
#define options_advise(text, n_text, name, n, hint)                                                          \
    options_advise_in((char[OPTIONS_ADVICE]){""}, OPTIONS_ADVICE, text, n_text, name, n, hint)
const char *options_advise_in(char *advice, size_t size, const char *text, size_t n_text,
                              const char *const *name, int n, const char *hint);

#endif
