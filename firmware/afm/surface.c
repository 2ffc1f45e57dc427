/* surface.c - see surface.h. */
#include "firmware/afm/surface.h"

#include <math.h>
#include "firmware/plant/noise.h"
#include "models/math/elementary.h"

static const double roughness = 1.3; /* Hurst exponent 0.8 and 1/2: in equal ratios of wavelength */

void surface_set_waves(struct surface *s, uint32_t seed)
{
    double power = 0.0, octave = logarithm(64.0) / (SURFACE_WAVES - 1);
    for (int i = 0; i < SURFACE_WAVES; i++) {
        struct surface_wave *w = &s->wave[i];
        double along_x, along_y;
        w->amplitude = exponential(-roughness * octave * i);
        w->phase = noise_word(seed, 2 * (uint64_t)i);
        cos_sin_turns(noise_word(seed, 2 * (uint64_t)i + 1), &along_x, &along_y);
        w->along_x = exponential(octave * i) * along_x / s->pitch;
        w->along_y = exponential(octave * i) * along_y / s->pitch;
        power += 0.5 * w->amplitude * w->amplitude;
    }
    for (int i = 0; i < SURFACE_WAVES; i++)
        s->wave[i].amplitude *= s->height / sqrt(power);
}

static double rough(const struct surface *s, double x, double y)
{
    double sum = 0.0, c, unused;
    for (int i = 0; i < SURFACE_WAVES; i++) {
        const struct surface_wave *w = &s->wave[i];
        cos_sin_turns(turns_of(w->along_x * x + w->along_y * y) + w->phase, &c, &unused);
        sum += w->amplitude * c;
    }
    return sum;
}

/* 0 below -1/2, 1 above 1/2, a straight line between. */
static double flank(double x, double edge)
{
    double part = edge > 0.0 ? x / edge + 0.5 : (x >= 0.0 ? 1.0 : 0.0);
    return part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
}

/* The largest whole number that is not above x, for |x| < 2^62. */
static double whole_below(double x)
{
    double whole = (double)(int64_t)x;
    return whole > x ? whole - 1.0 : whole;
}

/* High from 0 to duty of each pitch. */
static double grating(const struct surface *s, double x)
{
    double at = x - s->pitch * whole_below(x / s->pitch), high = s->duty * s->pitch;
    return flank(at, s->edge) - flank(at - high, s->edge) + flank(at - s->pitch, s->edge);
}

/* Cell of a grid of n points at `at` of its side, and the place in it. */
static uint32_t cell(double at, uint32_t n, double *part)
{
    double place = at * (n - 1);
    place = place < 0.0 ? 0.0 : place > n - 1 ? n - 1 : place;
    uint32_t i = (uint32_t)place < n - 1 ? (uint32_t)place : n - 2;
    *part = place - i;
    return i;
}

static double grid_height(const struct surface_grid *g, double x, double y)
{
    double u, v;
    uint32_t i = cell(x / g->width, g->nx, &u), k = cell(y / g->length, g->ny, &v);
    const int16_t *low = g->count + (uint64_t)k * g->nx + i, *high = low + g->nx;
    return g->m_per_1 *
           ((1.0 - v) * ((1.0 - u) * low[0] + u * low[1]) + v * ((1.0 - u) * high[0] + u * high[1]));
}

double surface_height(const struct surface *s, double x, double y)
{
    double c, sine;
    switch (s->kind) {
    case SURFACE_STEP:
        return s->height * flank(x - s->pitch, s->edge);
    case SURFACE_GRATING:
        return s->height * grating(s, x);
    case SURFACE_SINE:
        cos_sin_turns(turns_of(x / s->pitch), &c, &sine);
        return 0.5 * s->height * sine;
    case SURFACE_ROUGH:
        return rough(s, x, y);
    case SURFACE_GRID:
        return grid_height(&s->grid, x, y);
    default:
        return 0.0;
    }
}

int surface_material(const struct surface *s, double x, double y)
{
    double u = (x - s->map_x) / s->map_size, v = (y - s->map_y) / s->map_size;
    if (s->map == MAP_DISC)
        return u * u + v * v < 0.25;
    if (s->map == MAP_CHECKER)
        return ((int64_t)whole_below(u) + (int64_t)whole_below(v)) & 1;
    return 0;
}
