/* exact_series.h - the solution of a regime as a power series, expanded or added up from tables. */
#ifndef FIRMWARE_EXACT_SERIES_H
#define FIRMWARE_EXACT_SERIES_H

#include "firmware/method/exact/exact.h"

/* The motion over a span: position i = sum_n c[i][n] theta^n with theta = s / unit in [0, end]; n_terms is
 * even. */
struct exact_path {
    double unit, end;
    int n_terms;
    double c[EXACT_HALF][EXACT_TERMS];
};

/* The series from x over e->length, in units of `unit`. */
void exact_expand(const struct exact_equation *q, const double *c, const struct model *m,
                  const struct segment *e, double unit, const double *x, struct exact_path *path);

/* That series, from the tables where they cover the waves: at about a tenth of the cost. */
void exact_follow(struct exact *w, const struct exact_regime *r, const struct model *m,
                  const struct segment *e, const double *x, struct exact_path *path);

/* The change of the state at theta. The caller adds it to the start, so that there is one rounding. */
void exact_change(const struct exact_path *path, int n_states, double theta, double *dx);

#endif
