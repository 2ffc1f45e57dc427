/* selftest.h - the power-on self-test: numbers whose exact value is known, measured with the models and
 * methods that are in the image, before the plant is enabled.
 *
 *   drive_phase     cosine of a drive after 1e9 ticks                 exact integer arithmetic
 *   free_period_*   period of the undamped rig from 1.5 static compressions, contact kept
 *                   2 int d(eta) / sqrt(2 (E - V(eta))), V = (2/3)(0.4 eta^2.5 - eta)
 *   contact_time_*  from touchdown at speed 1 to lift-off, by the event log        the same integral
 *   oscillator_*    linear rig, damping ratio 0.05, driven at 0.9: transient and steady state in closed form
 *   hash_*          state hash of a short run with contact loss, all inputs driven from inside a tick
 *
 * The suffix is the method; `auto` is one of the others. Integrals and closed forms were evaluated with 40
 * digits. A hash is the only number that comes from the plant itself; it changes only together with
 * tests/data/hash.txt.
 *
 * Tolerances are relative. rk4 has a few times its error at these steps, taylor its own default tolerance,
 * rk4_float32 a few roundings of a float, the others rounding. Cost: 6 million instructions on x86-64, 7
 * million on a Cortex-M7, 94 million with double in software. */
#ifndef FIRMWARE_SELFTEST_H
#define FIRMWARE_SELFTEST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "firmware/plant/plant.h"

enum { SELFTEST_CHECKS = 15 };

/* The models and methods in the image, and memory to run in. A check whose model or method is not among
 * these, or whose method needs more than n_scratch, is absent: a small image hands over what it has. */
struct selftest_parts {
    const struct model *const *model;
    int n_models;
    const struct method *const *method;
    int n_methods;
    struct plant *plant; /* overwritten */
    double *scratch;     /* overwritten; [n_scratch], METHOD_SCRATCH is always enough */
    size_t n_scratch;
};

struct selftest_check {
    const char *name, *meaning;
    const char *model, *method; /* by name; NULL: needs none */
    const double *si;           /* parameters of the model, NULL for its defaults */
    double tick_s;
    double (*measure)(
        struct plant *pl);      /* value of a plant that was just started; NaN if it cannot be measured */
    double expected, tolerance; /* tolerance relative to expected */
};

/* Bit i of the masks is check i of the table. */
struct selftest_result {
    uint16_t present, failed;
    float error[SELFTEST_CHECKS]; /* relative; NaN when there was nothing to measure */
};

extern const struct selftest_check selftest_table[SELFTEST_CHECKS];

/* Measures one check. False, and *value untouched, when the image lacks its model, its method or enough
 * scratch memory. Else true, and *value is what was measured; NaN when the plant refused to start or left
 * the finite numbers. */
MUST_CHECK bool selftest_measure(const struct selftest_check *c, const struct selftest_parts *parts,
                                 double *value);

/* |value - expected| / |expected|: the check has passed when this is at most c->tolerance. NaN fails. */
double selftest_error(const struct selftest_check *c, double value);

/* Runs every check of the table and fills *r. parts->plant and parts->scratch are overwritten. Run it
 * before the plant is set up; its cost stands above. */
void selftest_run(const struct selftest_parts *parts, struct selftest_result *r);

#endif
