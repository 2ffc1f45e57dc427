/* lockin.h - amplitude and phase of one output at a harmonic of one drive, in the plant, tick by tick.
 *
 * Over a window of whole frames:  z = 2/sum(w) * sum w_k y_k exp(-i n theta_k),  w a Hann window, theta the drive's
 * integer phase (frequency ramps included), n the harmonic. Then y ~ |z| cos(n theta + arg z). The Hann window
 * makes the offset and the other drives leak by 1/periods^3 instead of 1/periods. n = 0 gives the mean. */
#ifndef FIRMWARE_LOCKIN_H
#define FIRMWARE_LOCKIN_H

#include <stdbool.h>
#include <stdint.h>

struct lockin {
    uint32_t n_ticks; /* of the window; 0: off */
    uint32_t i_tick;  /* position in the window */
    uint32_t harmonic;
    double re, im, weight;                 /* sums */
    double window_cosine, window_sine;     /* Hann window phasor */
    double rotation_cosine, rotation_sine; /* its step */
};

/* Begins a window of n_ticks ticks at the given harmonic; n_ticks 0 switches the slot off. */
void lockin_start(struct lockin *l, uint32_t n_ticks, uint32_t harmonic);

/* One sample y with the drive's phasor. True when it ended the window: *amplitude and *phase (rad) are the result
 * and the next window begins with the next sample. */
bool lockin_add(struct lockin *l, double y, double cosine, double sine, double *amplitude, double *phase);

#endif
