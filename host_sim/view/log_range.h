/* log_range.h - a part of plant time of an indexed log in columns, as many as there are pixels; with the rows
 * themselves where they are few. */
#ifndef HOST_SIM_LOG_RANGE_H
#define HOST_SIM_LOG_RANGE_H

#include "host_sim/view/log_index.h"

enum {
    LOG_COLUMNS = 1536, /* at most */
    LOG_ROWS = 3072,
    LOG_RANGE_MARKS = 1024,
    LOG_RANGE_BUDGET = 1 << 16 /* rows that are read from the file for one range */
};

struct log_range {
    unsigned run;
    double from, to; /* ticks */
    int n_columns;
    /* the answer */
    unsigned size; /* rows in a bin; 1: the rows themselves were read, and all marks are known */
    struct log_cell column[LOG_COLUMNS];
    int n_rows, n_marks;             /* how many the lists have */
    bool has_rows, has_marks;        /* the lists are whole */
    struct decode_row row[LOG_ROWS]; /* the ones in it, with one more on each side if that was read */
    bool has_after;                  /* the last one is later */
    struct log_mark mark[LOG_RANGE_MARKS];
};

/* Fills in the answer. False: there is no such run, or the file cannot be read. */
bool log_range_read(const struct log_index *x, struct log_range *r);

/* The last row at or before a tick, or the run's first one. */
bool log_range_row(const struct log_index *x, unsigned run, double tick, struct decode_row *row);

/* The next mark after t_s of one of these kinds (bits), or before it. False: there is none. */
bool log_range_mark(const struct log_index *x, unsigned run, double t_s, bool back, unsigned kinds,
                    struct log_mark *m);

#endif
