/* lockin.h - amplitude and phase of one output at a harmonic of one drive, in the plant, tick by tick.
 *
 * Over a window of whole frames: z = 2/sum(w) * sum w_k y_k exp(-i n theta_k), w a Hann window, theta the
 * drive's integer phase (frequency ramps included), n the harmonic. Then y ~ |z| cos(n theta + arg z). A tone
 * that is d > 1 periods per window away from n leaks through the Hann window by at most 1/(pi d (d^2 - 1)) of
 * its amplitude, instead of 1/(pi d). An offset (d = n times the periods of the window) leaks by twice that.
 * n = 0 gives the mean: its magnitude, and phase 0 or pi for its sign. One sample costs n + 1 complex
 * multiplications. */
#ifndef FIRMWARE_LOCKIN_H
#define FIRMWARE_LOCKIN_H

#include <stdbool.h>
#include <stdint.h>

enum { LOCKIN_HARMONICS = 16 }; /* the highest harmonic */

struct lockin {
    uint32_t n_ticks; /* ticks of the window; 0: off */
    uint32_t i_tick;  /* position in the window */
    uint32_t harmonic;
    double re, im, weight;                 /* sums */
    double window_cosine, window_sine;     /* Hann window phasor */
    double rotation_cosine, rotation_sine; /* its step */
};

/* Begins a window of n_ticks ticks at the given harmonic, 0..LOCKIN_HARMONICS; n_ticks 0 switches the slot
 * off. A higher harmonic is an error of the caller (assertion).
 *
 *     lockin_start(&l, 6400, 1);
 *     for each tick: // y: the output; d: the drive
 *         if (lockin_add(&l, y, d->cosine, d->sine, &amplitude, &phase))
 *             report(amplitude, phase); */
void lockin_start(struct lockin *l, uint32_t n_ticks, uint32_t harmonic);

/* Before the end of the window: false, and nothing is written. At its end: true; *amplitude has the unit
 * of y, *phase is in rad in -pi..pi, and the next window begins. The slot must not be off. */
bool lockin_finish(struct lockin *l, double *amplitude, double *phase);

/* For slots that share the weights of a leader which is at the same tick of an equal window. After the
 * leader's lockin_weight calls this moves the other's window as far. It saves two multiplications a tick
 * and slot. */
void lockin_follow(struct lockin *l, const struct lockin *leader);

/* Returns the window's weight at this tick, 0..1, and moves the window to the next tick. */
static inline double lockin_weight(struct lockin *l)
{
    double c = l->window_cosine, s = l->window_sine, w = 0.5 * (1.0 - c);
    l->window_cosine = c * l->rotation_cosine - s * l->rotation_sine;
    l->window_sine = c * l->rotation_sine + s * l->rotation_cosine;
    l->weight += w;
    l->i_tick++;
    return w;
}

/* Adds one sample: `weighted` is lockin_weight times y; cosine and sine are the drive's phasor at the end
 * of the tick. */
static inline void lockin_sample(struct lockin *l, double weighted, double cosine, double sine)
{
    double c = l->harmonic > 0 ? cosine : 1.0, s = l->harmonic > 0 ? sine : 0.0; /* exp(i n theta) */
    for (uint32_t i = 1; i < l->harmonic; i++) {
        double c_next = c * cosine - s * sine;
        s = c * sine + s * cosine;
        c = c_next;
    }
    l->re += weighted * c;
    l->im -= weighted * s;
}

/* Takes the output y of one tick: lockin_weight, lockin_sample and lockin_finish in one. False while the
 * slot is off. */
static inline bool lockin_add(struct lockin *l, double y, double cosine, double sine, double *amplitude,
                              double *phase)
{
    if (l->n_ticks == 0)
        return false;
    lockin_sample(l, lockin_weight(l) * y, cosine, sine);
    return lockin_finish(l, amplitude, phase);
}

#endif
