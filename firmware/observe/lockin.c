/* lockin.c - a single-bin Fourier sum with a Hann window; see lockin.h. */
#include "firmware/observe/lockin.h"

#include <math.h>
#include "models/check.h"
#include "models/math/elementary.h"

/* w_k = (1 - cos(2 pi (k + 1/2) / n)) / 2 from its phasor at k = 0: a new one for every window, so that
 * the rounding of one window (1e-16 a tick) is not the next one's. */
static void begin_window(struct lockin *l)
{
    uint64_t step = UINT64_MAX / l->n_ticks;
    cos_sin_turns(step / 2, &l->window_cosine, &l->window_sine);
    cos_sin_turns(step, &l->rotation_cosine, &l->rotation_sine);
    l->i_tick = 0;
    l->re = l->im = l->weight = 0.0;
}

void lockin_start(struct lockin *l, uint32_t n_ticks, uint32_t harmonic)
{
    ASSERT(harmonic <= LOCKIN_HARMONICS);
    l->n_ticks = n_ticks;
    l->harmonic = harmonic;
    if (l->n_ticks > 0)
        begin_window(l);
}

bool lockin_finish(struct lockin *l, double *amplitude, double *phase)
{
    if (l->i_tick < l->n_ticks)
        return false;
    double scale = (l->harmonic == 0 ? 1.0 : 2.0) / l->weight; /* a mean has no mirror image at -n */
    double re = scale * l->re, im = scale * l->im;
    *amplitude = sqrt(re * re + im * im);
    *phase = arc_tangent(im, re);
    begin_window(l);
    return true;
}

void lockin_follow(struct lockin *l, const struct lockin *leader)
{
    l->i_tick = leader->i_tick;
    l->weight = leader->weight;
    l->window_cosine = leader->window_cosine;
    l->window_sine = leader->window_sine;
}
