/* spectrum.c - see spectrum.h. */
#include "host_sim/afm/spectrum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TWO_PI 6.283185307179586

enum { ROUNDS = 20, LEAST = 5 /* bins of a fit */ };

bool spectrum_init(struct spectrum *s, size_t length, double sample_s)
{
    *s = (struct spectrum){.length = length, .sample_s = sample_s};
    s->waiting = calloc(length, sizeof(double));
    s->density = calloc(length / 2 + 1, sizeof(double));
    s->re = calloc(length, sizeof(double));
    s->im = calloc(length, sizeof(double));
    return s->waiting && s->density && s->re && s->im;
}

void spectrum_free(struct spectrum *s)
{
    free(s->waiting);
    free(s->density);
    free(s->re);
    free(s->im);
}

double spectrum_frequency(const struct spectrum *s, size_t i)
{
    return (double)i / ((double)s->length * s->sample_s);
}

static void swap(double *a, double *b)
{
    double kept = *a;
    *a = *b;
    *b = kept;
}

/* Cooley & Tukey 1965, radix 2, in place. */
static void transform(double *re, double *im, size_t n)
{
    for (size_t i = 1, k = 0; i < n; i++) {
        size_t bit = n >> 1;
        for (; k & bit; bit >>= 1)
            k ^= bit;
        k ^= bit;
        if (i < k) {
            swap(&re[i], &re[k]);
            swap(&im[i], &im[k]);
        }
    }
    for (size_t size = 2; size <= n; size *= 2)
        for (size_t part = 0; part < size / 2; part++) {
            double c = cos(TWO_PI * (double)part / (double)size),
                   d = -sin(TWO_PI * (double)part / (double)size);
            for (size_t i = part; i < n; i += size) {
                size_t k = i + size / 2;
                double x = re[k] * c - im[k] * d, y = re[k] * d + im[k] * c;
                re[k] = re[i] - x;
                im[k] = im[i] - y;
                re[i] += x;
                im[i] += y;
            }
        }
}

static void add_segment(struct spectrum *s)
{
    double mean = 0.0, n = (double)s->length;
    for (size_t i = 0; i < s->length; i++)
        mean += s->waiting[i] / n;
    for (size_t i = 0; i < s->length; i++) {
        s->re[i] = (s->waiting[i] - mean) * (0.5 - 0.5 * cos(TWO_PI * (double)i / n));
        s->im[i] = 0.0;
    }
    transform(s->re, s->im, s->length);
    /* the window's mean square is 3/8 */
    for (size_t i = 0; i <= s->length / 2; i++)
        s->density[i] += 2.0 * s->sample_s / (0.375 * n) * (s->re[i] * s->re[i] + s->im[i] * s->im[i]);
    s->segments++;
}

void spectrum_add(struct spectrum *s, double value)
{
    s->waiting[s->filled++] = value;
    if (s->filled < s->length)
        return;
    add_segment(s);
    s->filled = s->length / 2;
    memmove(s->waiting, s->waiting + s->filled, s->filled * sizeof *s->waiting);
}

void spectrum_finish(struct spectrum *s)
{
    for (size_t i = 0; i <= s->length / 2; i++)
        s->density[i] /= (double)(s->segments ? s->segments : 1);
}

double resonance_density(const struct resonance *r, double f)
{
    double square = r->f0_Hz * r->f0_Hz, away = square - f * f, wide = r->f0_Hz * f / r->quality;
    return r->floor * square * square / (away * away + wide * wide);
}

/* a x = b by Cramer's rule; false when singular. */
static bool solve(double a[3][3], const double *b, double *x)
{
    double minor[3];
    for (int i = 0; i < 3; i++)
        minor[i] = a[(i + 1) % 3][1] * a[(i + 2) % 3][2] - a[(i + 2) % 3][1] * a[(i + 1) % 3][2];
    double all = a[0][0] * minor[0] + a[1][0] * minor[1] + a[2][0] * minor[2];
    for (int k = 0; k < 3; k++) {
        double m[3][3], sum = 0.0;
        memcpy(m, a, sizeof m);
        for (int i = 0; i < 3; i++)
            m[i][k] = b[i];
        for (int i = 0; i < 3; i++)
            sum += m[i][0] * (m[(i + 1) % 3][1] * m[(i + 2) % 3][2] - m[(i + 2) % 3][1] * m[(i + 1) % 3][2]);
        x[k] = sum / all;
    }
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]) && all != 0.0;
}

/* The parabola x[0] + x[1] u + x[2] u^2 through the inverse densities of the bins, u = (f/centre)^2 - 1. The mean of an
 * inverse of n averages is too large by n/(n - 1). */
static bool fit_parabola(const struct spectrum *s, size_t from, size_t to, double centre,
                         const struct resonance *r, double *x)
{
    double a[3][3] = {{0.0}}, b[3] = {0.0}, n = (double)s->segments, fair = n > 1.0 ? (n - 1.0) / n : 1.0;
    for (size_t i = from; i <= to; i++) {
        double f = spectrum_frequency(s, i), u = (f / centre) * (f / centre) - 1.0,
               power[3] = {1.0, u, u * u};
        double expected = resonance_density(r, f) / r->floor, inverse = r->floor / s->density[i] * fair;
        for (int k = 0; k < 3; k++) {
            b[k] += expected * expected * power[k] * inverse;
            for (int j = 0; j < 3; j++)
                a[k][j] += expected * expected * power[k] * power[j];
        }
    }
    return solve(a, b, x);
}

/* From x to f0, Q and floor; false when the parabola is none of an oscillator. */
static bool read_parabola(const double *x, double centre, struct resonance *r)
{
    double fourth = 1.0 + (x[0] - x[1]) / x[2], square = sqrt(fourth);
    double loss = 2.0 - (2.0 - x[1] / x[2]) / square;
    if (!(fourth > 0.0 && loss > 0.0 && x[2] > 0.0))
        return false;
    r->f0_Hz = centre * sqrt(square);
    r->quality = 1.0 / sqrt(loss);
    r->floor /= x[2] * fourth;
    return true;
}

bool spectrum_fit(const struct spectrum *s, double from_Hz, double to_Hz, struct resonance *r)
{
    double step = spectrum_frequency(s, 1), x[3];
    size_t from = (size_t)(from_Hz / step) + 1, to = (size_t)(to_Hz / step), top = from;
    if (to > s->length / 2 || to < from + LEAST)
        return false;
    for (size_t i = from; i <= to; i++)
        top = s->density[i] > s->density[top] ? i : top;
    /* the width at half height, for the first weights */
    size_t low = top, high = top;
    while (low > from && s->density[low] > 0.5 * s->density[top])
        low--;
    while (high < to && s->density[high] > 0.5 * s->density[top])
        high++;
    double centre = spectrum_frequency(s, top);
    *r = (struct resonance){centre, centre / (step * (double)(high - low)), 1.0};
    r->floor = s->density[top] / (r->quality * r->quality);
    for (int i = 0; i < ROUNDS; i++) {
        if (!fit_parabola(s, from, to, centre, r, x) || !read_parabola(x, centre, r))
            return false;
    }
    return true;
}
