/* bench.h - one run of a case: the plant in this process, its
 * controller in another one, in lockstep over UDP on loopback. */
#ifndef HOST_SIM_BENCH_H
#define HOST_SIM_BENCH_H

#include "host_sim/test/test_file.h"

/* The worst one counts. */
enum verdict { VERDICT_OK, VERDICT_UNTESTED, VERDICT_FAIL, VERDICT_ERROR };

enum {
    BENCH_IMPLICIT = 4,
    BENCH_TRUTHS = 2, /* the largest force and the hardest impact of a run */
    BENCH_TEXT = 320,
    BENCH_PATH = 4096,
    BENCH_START_S = 2, /* seconds of the bus, within which plant time must run */
    BENCH_SLOWER = 2   /* bus frames may be so many times those of plant time */
};

/* One expectation and what was found. */
struct outcome {
    enum verdict verdict;
    int line; /* in the file; 0: implicit */
    char text[TEST_VALUE];
    char found[BENCH_TEXT]; /* the value and when, for people */
    enum metric_kind kind;
    struct metric_value value; /* in this unit, that of the expectation */
    char unit[METRIC_UNIT];
};

struct bench_result {
    int i_case;
    uint32_t seed;
    bool varied;
    int i_varied;
    double varied_value;
    enum verdict verdict;
    char error[TEST_REASON]; /* with VERDICT_ERROR, where the bench ended before its time */
    char log[BENCH_PATH];    /* the recording, or "" */
    double plant_s, took_s;
    uint64_t hash;
    uint32_t count[DIAG_COUNTERS];
    unsigned faults; /* ever latched, but for a time-out */
    struct metric_value
        truth[BENCH_TRUTHS]; /* by the plant itself; unknown: it has no contacts, or runs elsewhere */
    int n;
    struct outcome outcome[TEST_EXPECTS + BENCH_IMPLICIT + 1]; /* and the golden log's */
};

/* All runs have this in common. */
struct bench_setting {
    const struct test_file *test;
    const char *program;    /* this one, for {contactplant} */
    const char *log;        /* folder for logs, or NULL */
    const char *bus;        /* as --bus has it, or NULL */
    const char *plant;      /* HOST:PORT of a plant in real time */
    const char *controller; /* HOST:PORT of a controller whose address is not this program's choice */
    bool realtime;
    double patience_s;
};

/* The scene's name: of a model or preset, else of a file beside the test. */
void bench_scene_path(const char *file, const char *name, char path[BENCH_PATH]);

/* Whether the plant of this case can be made, before anything runs. False: why[TEST_REASON] is one line. */
bool bench_approve(const struct test_file *t, const struct test_case *c, char *why);

/* The link of this case has faults at some time. */
bool bench_has_faults(const struct test_case *c);

/* Runs it; the case, seed and varied value stand in *r already. */
void bench_run(const struct bench_setting *s, struct bench_result *r);

#endif
