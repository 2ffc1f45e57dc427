/* sweep_meter.h - one output over half of a point's measuring time: harmonics, mean, extremes, peak force.
 *
 * Sums over samples are integrals of smooth periodic motion to the last digit. An output that jumps, bends
 * or begins as a root where a contact switches is not smooth. So the sums are corrected at each located
 * switch, theta ticks after a sample, by the formula of Euler and Maclaurin. A root c s^(3/2) needs
 * Hurwitz's zeta (Navot 1961):
 *
 *     integral = sum - [y] B1(theta) + [y'] B2(theta)/2 - [y''] B3(theta)/6
 *                - c zeta(-3/2, theta or 1 - theta)
 *
 * B1.. are Bernoulli's polynomials, [] is the jump there, ' the rate per tick, and y the output times its
 * harmonic. The error is of fourth order in the tick, and of order 3 1/2 for a root. An extreme is the top
 * of the polynomial through the five samples about it. */
#ifndef HOST_SIM_SWEEP_METER_H
#define HOST_SIM_SWEEP_METER_H

#include "firmware/observe/lockin.h"
#include "firmware/plant/plant.h"

enum { SWEEP_HARMONICS = 8, SWEEP_METER_SAMPLES = 5 };

/* The last samples of an output; smooth: how many since the last bend or jump. */
struct sweep_trace {
    double y[SWEEP_METER_SAMPLES];
    int smooth;
};

struct sweep_meter {
    int output; /* number of the model's output */
    int n_harmonics;
    uint32_t harmonic[SWEEP_HARMONICS];
    struct lockin_window window;
    struct lockin_sum sum[SWEEP_HARMONICS];
    bool beats;           /* set after the start: squares the window, so that other frequencies leak less */
    int64_t n;            /* ticks of a half */
    uint64_t phase, step; /* turns of the harmonics' common phase: at the start, and per tick */
    int64_t i_tick;       /* since the start */
    double cosine, sine;  /* phasor of the phase now; computed from it in each half */
    double rotation_cosine, rotation_sine;
    struct sweep_trace trace, force;
    double event_x[PLANT_EVENTS][MODEL_STATES]; /* states at the switches of a tick */
};

struct sweep_measured {
    double amplitude[SWEEP_HARMONICS], phase[SWEEP_HARMONICS];
    double mean, lowest, highest; /* mean and extremes of the output */
    double out_of_contact;        /* fraction of time with every contact open */
    double peak_force;
};

/* Begins at the plant's state: n ticks a half, harmonics of `phase`. */
void sweep_meter_start(struct sweep_meter *m, int output, const uint32_t *harmonic, int n_harmonics,
                       int64_t n, uint64_t phase, uint64_t step);

/* Measures one half. False when the plant left the finite numbers. Takes 700 instructions a tick besides
 * the plant's. */
bool sweep_meter_run(struct sweep_meter *m, struct plant *pl, struct sweep_measured *r);

#endif
