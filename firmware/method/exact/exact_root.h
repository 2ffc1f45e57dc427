/* exact_root.h - the instant at which a contact leaves its regime. */
#ifndef FIRMWARE_EXACT_ROOT_H
#define FIRMWARE_EXACT_ROOT_H

#include "firmware/method/exact/exact_series.h"

struct exact_root {
    double theta;
    bool converged;
};

/* The first such instant in [0, path->end]; false when there is none. `last` is the gap at the end. At most
 * 40 iterations, 2 as a rule. */
bool exact_first_root(const struct exact_path *path, const struct exact_gap *gap, bool closed,
                      const struct input *last, struct exact_root *root);

#endif
