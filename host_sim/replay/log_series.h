/* log_series.h - the rows of a log in bins, for pictures: where rows or values are missing there is a gap,
 * and values beyond the bus's range are marked. */
#ifndef HOST_SIM_LOG_SERIES_H
#define HOST_SIM_LOG_SERIES_H

#include "host_sim/listen/decode_rows.h"
#include "host_sim/report/decimate.h"

struct log_series {
    struct decimate bins;               /* signals, then for each output where it was beyond: see below */
    size_t n, n_beyond[DECODE_OUTPUTS]; /* rows; of them without this output: beyond the bus's range */
    int n_signals;                      /* outputs and inputs */
    uint64_t frame, step; /* the newest row has this one; least number of frames between two rows */
};

void log_series_begin(struct log_series *s, int n_inputs);
void log_series_add(struct log_series *s, const struct decode_row *row);

/* The next interval of output k beyond the range, from bin *i on. False: there is none. */
bool log_series_next(const struct log_series *s, int k, size_t *i, double *from, double *to);

/* The largest number that the bus can say of output k, SI. */
double log_series_range(const struct wire_scene *w, int k);

#endif
