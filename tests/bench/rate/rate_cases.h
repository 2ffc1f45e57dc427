/* rate_cases.h - plants in motion, and the methods, steps and tolerances to move them with: what a board pays
 * for an error. tests/bench/rate/rate_board.c counts instructions on a board, tests/bench/rate/rate_host.c
 * finds errors on the host: the bits are the same. */
#ifndef TESTS_BENCH_RATE_CASES_H
#define TESTS_BENCH_RATE_CASES_H

#include <stdbool.h>
#include "firmware/observe/lockin.h"
#include "firmware/plant/plant.h"

enum { RATE_CASES = 7, RATE_SET = 6, RATE_SETTINGS = 93 };

/* A case's plant: tips are of the silicon lever, in SI, and measured by the lock-in at their force. A period
 * is that of the drive; for tips, of the lever alone: 1/30.09 kHz. */
struct rate_case {
    const char *name;
    const struct model *model;
    struct {
        const char *name;
        double value;
    } set[RATE_SET]; /* paper parameters, up to the first without a name */
    double start;    /* displacement in the paper's symbols */
    int drive;       /* the input that the lock-in follows, or for tips, whose force is measured */
    int periods;     /* that an error is taken over */
    int finer;       /* steps of fixed settings, times this */
    bool lever;
};
extern const struct rate_case rate_case[RATE_CASES];

struct rate_setting {
    const struct method *method;
    int steps;     /* a period */
    int tolerance; /* 10^-this, 0: none */
};

/* Setting i of a case, 0 <= i < RATE_SETTINGS. */
struct rate_setting rate_setting(const struct rate_case *c, int i);

struct rate_run {
    struct plant plant;
    double scratch[METHOD_SCRATCH];
    struct lockin_window window;
    struct lockin_sum sum; /* the first output's */
    int drive;             /* at whose phase it listens */
    double amplitude;      /* lock-in amplitude of the last whole window, model units */
};

/* NULL, or why the method refuses; with `force` its guard is passed over. */
const char *rate_start(struct rate_run *r, const struct rate_case *c, const struct rate_setting *s,
                       bool force);

/* Some ticks on; false when the state left the finite numbers. */
bool rate_advance(struct rate_run *r, const struct rate_case *c, uint32_t ticks);

#endif
