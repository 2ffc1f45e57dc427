/* lockin.h - sums of an output times a wave under a Hann window, tick by tick.
 *
 * Over a window of whole frames: sum w_k y_k exp(-i n theta_k), w a Hann window, theta a drive's integer
 * phase (frequency ramps included), n the harmonic. Where the window holds whole periods, z = 2/sum(w) times
 * this is y ~ |z| cos(n theta + arg z). Elsewhere other tones leak: one that is d > 1 periods per window away
 * by at most 1/(pi d (d^2 - 1)) of its amplitude, instead of 1/(pi d). An offset (d = n times the periods of
 * the window) leaks by twice that. lockin_fit.h takes the leakage out. One sample costs n + 1 complex
 * multiplications.
 *
 * There are three lock-ins. This one serves LOCKIN on the bus (lockin_slots.h) and, over whole periods,
 * sweeps (host_sim/maps/sweep/sweep_meter.h). The microscope has mixers with poles
 * (firmware/afm/demodulator.h), as AFM controllers do. `contactplant test` fits a wave of any frequency
 * (host_sim/test/fit.h). */
#ifndef FIRMWARE_LOCKIN_H
#define FIRMWARE_LOCKIN_H

#include <stdbool.h>
#include <stdint.h>

enum { LOCKIN_HARMONICS = 16 }; /* the highest harmonic */

struct lockin_window {
    uint32_t n_ticks;                      /* 0: off */
    uint32_t i_tick;                       /* position */
    double weight;                         /* sum of the weights so far */
    double cosine, sine;                   /* phasor of the next weight */
    double rotation_cosine, rotation_sine; /* its step */
};

/* sum w y exp(-i n theta) */
struct lockin_sum {
    double re, im;
};

/* Begins a window of n_ticks ticks; 0 switches it off.
 *
 *     lockin_begin(&window, 6400);
 *     for each tick: // y: the output; d: the drive
 *         lockin_add(&sum, 1, lockin_weight(&window) * y, d->cosine, d->sine);
 *     lockin_polar(&sum, 2.0 / window.weight, &amplitude, &phase); */
void lockin_begin(struct lockin_window *w, uint32_t n_ticks);

/* Amplitude and phase, rad in -pi..pi, of a sum times `scale`: 2 / weight for one over whole periods. */
void lockin_polar(const struct lockin_sum *s, double scale, double *amplitude, double *phase);

/* Returns the window's weight at this tick, 0..1, and moves the window to the next tick. */
static inline double lockin_weight(struct lockin_window *l)
{
    double c = l->cosine, s = l->sine, w = 0.5 * (1.0 - c);
    l->cosine = c * l->rotation_cosine - s * l->rotation_sine;
    l->sine = c * l->rotation_sine + s * l->rotation_cosine;
    l->weight += w;
    l->i_tick++;
    return w;
}

/* Adds one sample at harmonic 1..LOCKIN_HARMONICS: `weighted` is lockin_weight times y; cosine and sine are
 * the drive's phasor at the end of the tick. */
static inline void lockin_add(struct lockin_sum *sum, uint32_t harmonic, double weighted, double cosine,
                              double sine)
{
    double c = cosine, s = sine; /* exp(i n theta) */
    for (uint32_t i = 1; i < harmonic; i++) {
        double c_next = c * cosine - s * sine;
        s = c * sine + s * cosine;
        c = c_next;
    }
    sum->re += weighted * c;
    sum->im -= weighted * s;
}

#endif
