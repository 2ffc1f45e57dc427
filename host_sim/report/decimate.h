/* decimate.h - any number of rows in a bounded number of bins, each with the least and the greatest of every
 * column.
 *
 * A bin holds `per` rows. When all bins are full, neighbours become one and `per` doubles, so that rows may
 * come one by one, and nobody need know beforehand how many. While `per` is 1 no row is lost. */
#ifndef HOST_SIM_DECIMATE_H
#define HOST_SIM_DECIMATE_H

#include <stddef.h>

enum { DECIMATE_BINS = 1024, DECIMATE_COLUMNS = 16 };

struct decimate {
    int n_columns;
    size_t n, per, rows; /* bins begun; rows in a full bin; rows so far */
    double last;         /* x of the newest row */
    double x[DECIMATE_BINS];
    double low[DECIMATE_COLUMNS][DECIMATE_BINS], high[DECIMATE_COLUMNS][DECIMATE_BINS];
};

void decimate_begin(struct decimate *d, int n_columns);

/* A row: x ascending, n_columns values. NaN counts as no value. */
void decimate_add(struct decimate *d, double x, const double *value);

enum { DECIMATE_UNKNOWN = -1 };

/* Intervals in which contact was open, in equal parts of [from, to]. A part in which that is unknown has the
 * share NaN. */
struct decimate_open {
    double from, to;
    double since; /* when the present state began */
    int open;     /* 0, 1 or DECIMATE_UNKNOWN */
    double share[DECIMATE_BINS];
};

void decimate_open_begin(struct decimate_open *d, double from, double to, int open);

/* The state until t was that of the call before; from t on it is this. */
void decimate_open_add(struct decimate_open *d, double t, int open);

#endif
