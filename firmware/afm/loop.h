/* loop.h - parts of the reference controllers of an AFM: a PI controller, and the closed form of
 * dual-frequency resonance tracking (DART; Rodriguez et al. 2007). */
#ifndef FIRMWARE_AFM_LOOP_H
#define FIRMWARE_AFM_LOOP_H

#include <stdbool.h>

/* u = kp e + ki (integral of e), within [min, max]; the integral stands while u is at a limit. */
struct loop {
    double kp, ki, min, max;
    double sum;   /* ki times the integral */
    bool limited; /* u was at a limit in the last sample */
};

/* The output after a sample of length dt with error e. */
double loop_run(struct loop *l, double e, double dt);

/* Resonance and quality of a simple harmonic oscillator from its amplitudes and phases (rad, negative for a
 * lag) at two drives of equal force. False where these belong to no oscillator. */
bool loop_find_resonance(const double f_Hz[2], const double amplitude[2], const double phase[2],
                         double *f0_Hz, double *quality);

#endif
