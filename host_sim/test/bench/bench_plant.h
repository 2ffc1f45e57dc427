/* bench_plant.h - the plant of one run: made from the
 * test file, acted upon at its times, measured, judged. */
#ifndef HOST_SIM_BENCH_PLANT_H
#define HOST_SIM_BENCH_PLANT_H

#include "host_sim/test/test_afm.h"
#include "host_sim/scene/scene.h"
#include "host_sim/test/verdict.h"

struct bench_plant {
    struct scene_app scene;
    bool loops;              /* a microscope with its own loops, without a bus */
    uint32_t seed;           /* a microscope's heat has it, set before opening; 0 and 1: its lever's own */
    const struct model *see; /* whose signals are measured */
    struct test_afm contact; /* that of a microscope */
    const struct test_case *c;
    struct faults *link; /* faults of the bus, or NULL */
    int next_act, next_fire;
    uint32_t fired;            /* that the app had applied before this frame */
    uint32_t switches;         /* that were told to the measurements */
    unsigned regime;           /* after the last of them */
    struct metric_block block; /* ticks that the readers have not been told */
    int n, n_judged;           /* measurements: those of the verdict, then those of the whole run */
    struct measurement measurement[VERDICT_MEASUREMENTS];
    int n_readers;
    struct measurement *reader[VERDICT_MEASUREMENTS]; /* those of signals, which ticks tell */
    unsigned faults;                                  /* ever latched */
};

/* Things about the link that the app does not know. */
struct bench_link {
    double malformed; /* packets so far */
    double stopped_s; /* when a command ended the session, plant time; negative: not yet */
};

/* Varied: the value, or NULL. It must not be moved from here
 * on. False: why[TEST_REASON]. bench_plant_close in any case. */
bool bench_plant_open(struct bench_plant *p, const struct test_file *t, const struct test_case *c,
                      const double *varied, char *why);

/* Does what is due before the next bus frame. False: why[TEST_REASON]. */
bool bench_plant_act(struct bench_plant *p, char *why);

/* The end of a bus frame. */
void bench_plant_frame(struct bench_plant *p, const struct bench_link *l);

/* The plant's state by name. */
const char *bench_plant_state(const struct bench_plant *p);

/* Outcomes, verdict and hash into *r. */
void bench_plant_judge(struct bench_plant *p, const struct test_case *c, struct bench_result *r);

void bench_plant_close(struct bench_plant *p);

#endif
