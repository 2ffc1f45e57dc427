/* lockin.c - a single-bin Fourier sum with a Hann window; see lockin.h. */
#include "firmware/observe/lockin.h"

#include <math.h>
#include "models/math/elementary.h"

/* w_k = (1 - cos(2 pi (k + 1/2) / n)) / 2 from its phasor at k = 0: a new one for every window, so that
 * the rounding of one window (1e-16 a tick) is not the next one's. */
void lockin_begin(struct lockin_window *w, uint32_t n_ticks)
{
    *w = (struct lockin_window){.n_ticks = n_ticks};
    if (n_ticks == 0)
        return;
    uint64_t step = UINT64_MAX / n_ticks;
    cos_sin_turns(step / 2, &w->cosine, &w->sine);
    cos_sin_turns(step, &w->rotation_cosine, &w->rotation_sine);
}

void lockin_polar(const struct lockin_sum *s, double scale, double *amplitude, double *phase)
{
    double re = scale * s->re, im = scale * s->im;
    *amplitude = sqrt(re * re + im * im);
    *phase = arc_tangent(im, re);
}
