/* report.h - the findings of a run of tests: lines for people, JUnit XML and JSON. */
#ifndef HOST_SIM_REPORT_H
#define HOST_SIM_REPORT_H

#include "host_sim/test/bench/bench.h"
#include "host_sim/test/report/requirements.h"

#include <stdio.h>
#include <time.h>

/* A case with all its runs. */
struct report_case {
    const struct test_file *test;
    const struct test_case *c;
    int n_runs, n_done, n_bad;
    int i_worst; /* run of *worst */
    time_t began;
    double plant_s, took_s;
    struct bench_result *worst; /* the first of the worst verdict; NULL: no run has ended */
};

extern const char *const report_verdict[];

/* Lines about a case whose runs have all ended. `options`: words of the command line, each behind a blank,
 * which a command that runs the case again must have. */
void report_print(FILE *out, const struct report_case *r, const char *options);

struct report {
    const struct report_case *of; /* [n] */
    int n;
    const struct requirements *untraced; /* that no case names */
    const char *share;                   /* the line that tells it (host_sim/maps/share.h), or "" */
    bool whole;                          /* every case ran to its end */
};

/* The whole report. contactplant merge reads it line by line. False: it could not be written. */
bool report_junit(const char *path, const struct report *r);
bool report_json(const char *path, const struct report *r);

#endif
