/* verdict.h - the expectations of a case, and the verdict from measurements. */
#ifndef HOST_SIM_VERDICT_H
#define HOST_SIM_VERDICT_H

#include "host_sim/live/bus.h"
#include "host_sim/scene/scene_app.h"
#include "host_sim/test/bench/bench.h"
#include "host_sim/test/measure.h"

enum { VERDICT_MEASUREMENTS = TEST_EXPECTS + BENCH_IMPLICIT + BENCH_TRUTHS };

/* A run shows this beside its measurements. */
struct evidence {
    double now_s; /* plant time */
    uint64_t hash;
    unsigned faults;       /* ever latched in the run */
    const uint32_t *count; /* [DIAG_COUNTERS] */
};

/* Settings of the measurements, s[VERDICT_MEASUREMENTS]: those of the
 * case's expects, then those that every case has. Returns how many. */
int verdict_settings(const struct test_case *c, struct metric_setting *s);

/* Settings s[BENCH_TRUTHS] of what is told of the whole run, whatever the case expects. */
void verdict_truths(const struct test_case *c, struct metric_setting *s);

/* Outcomes, verdict, counters and hash into *r, from the n measurements of verdict_settings. */
void verdict_judge(const struct evidence *e, const struct test_case *c, struct measurement *m, int n,
                   struct bench_result *r);

/* The log of a run: that of --log, or a file without a name, which ends when `file` is closed (else it is
 * -1). Whatever ends the run, nothing is left. */
struct verdict_record {
    char path[BENCH_PATH]; /* "": none */
    int file;
};

/* Records the bus from here on, where --log or a golden log ask for it. False: the result has the error. */
bool verdict_begin_record(const struct bench_setting *s, struct bench_result *r, struct bus *bus,
                          struct verdict_record *to);

/* Ends it, or notes the error. */
void verdict_end_record(const struct bench_setting *s, struct bench_result *r, struct bus *bus);

/* Why commands are not judged where the controller is not heard and the plant does not echo its samples. */
#define VERDICT_DEAF "over UDP only the plant hears the controller, and it does not echo samples"

/* Compares the record with the case's golden log, if it has one; `zero`: the tick where the case began. In
 * real time rows may be missing, and `deaf`: commands are not told. An outcome more in *r. */
void verdict_compare(const struct bench_setting *s, const struct scene_app *scene, const char *record,
                     uint64_t zero, bool deaf, struct bench_result *r);

#endif
