/* record.h - motions as the ledger meets them, for the comparison of rules: pieces between switches with
 * their states and inputs, and the series of `taylor` behind them. */
#ifndef TESTS_BENCH_LEDGER_RECORD_H
#define TESTS_BENCH_LEDGER_RECORD_H

#include "firmware/method/taylor/taylor_series.h"
#include "firmware/plant/plant.h"

enum { RECORD_SCENES = 4, RECORD_PERIODS = 8, RECORD_TICKS_MAX = 8192 };

struct piece {
    struct segment e;
    double x0[MODEL_LINEAR_STATES], x1[MODEL_LINEAR_STATES];
    unsigned regime;
    bool whole; /* a tick without a switch */
};

/* One series in time, from `begin` to `end` of the record (model time). */
struct series {
    double a[TAYLOR_TERMS]; /* the series, eta(t) */
    double begin, end;
    double cosine, sine; /* the drive at its begin */
};

struct record {
    const char *name;
    const struct model *model;
    const double *p;
    double h, omega, amplitude; /* the one drive; model units */
    int input;
    int ticks; /* in a period */
    struct piece *piece;
    int n_pieces, period[RECORD_PERIODS + 1]; /* the first piece of each period */
    struct series *series;
    int n_series;
};

/* The motion of a scene over RECORD_PERIODS periods; `exactly`: by the smallest tolerance. Owned by record.c
 * until the next call. */
const struct record *record_run(int scene, int ticks, bool exactly);

/* The default number of ticks in a period. */
int record_ticks(int scene);

#endif
