/* sequence.h - residuals in their order along a curve or a record, for tests of them. A sequence has the real
 * parts of a curve, its imaginary parts, a record, or each LEVER_LAG-th number of a lever's data. */
#ifndef HOST_SIM_FIT_SEQUENCE_H
#define HOST_SIM_FIT_SEQUENCE_H

#include "host_sim/fit/fit.h"

struct sequence {
    int first, step, n;       /* number i is residual first + i step of all */
    int curve, record, lever; /* one of them, the others are -1 */
};

/* Sequence q; false: there are no more. */
bool sequence_nth(const struct fit_setup *s, int q, struct sequence *e);

/* Number i counts: it was measured, and no jump is beside it. */
bool sequence_counts(const struct fit_setup *s, const struct sequence *e, int i);

/* "small.csv:12, 225 Hz" or "ring.csv, 12 ms": the place of number i, into text[size]. */
void sequence_name(const struct fit_setup *s, const struct sequence *e, int i, char *text, size_t size);

#endif
