/* spectrum.c - see spectrum.h. */
#include "host_sim/afm/spectrum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TWO_PI 6.283185307179586

enum { ROUNDS = 100, HALVES = 30, LEAST = 8 /* bins of a fit */ };

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
    return r->low * square * square / (away * away + wide * wide) + r->white;
}

/* ---- the fit: of ln f0, ln Q, ln low, and white in units of the largest density ---- */

enum { LN_F0, LN_QUALITY, LN_LOW, WHITE, UNKNOWNS };

struct band {
    const struct spectrum *s;
    size_t from, to, top;
};

/* Derivatives of S over S. */
static void gradient(const struct resonance *r, double f, double unit, double g[UNKNOWNS])
{
    double square = r->f0_Hz * r->f0_Hz, away = square - f * f, wide = r->f0_Hz * f / r->quality;
    double all = away * away + wide * wide, s = resonance_density(r, f), part = 1.0 - r->white / s;
    g[LN_F0] = part * (4.0 - (4.0 * square * away + 2.0 * wide * wide) / all);
    g[LN_QUALITY] = part * 2.0 * wide * wide / all;
    g[LN_LOW] = part;
    g[WHITE] = unit / s;
}

/* The logarithm of the likelihood, less is better. */
static double misfit(const struct band *b, const struct resonance *r)
{
    double sum = 0.0;
    for (size_t i = b->from; i <= b->to; i++) {
        double density = resonance_density(r, spectrum_frequency(b->s, i));
        sum += log(density) + b->s->density[i] / density;
    }
    return sum;
}

/* The first n of a x = y by elimination with pivots; false when singular. */
static bool solve(int n, double a[UNKNOWNS][UNKNOWNS], double *y)
{
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k; i < n; i++)
            best = fabs(a[i][k]) > fabs(a[best][k]) ? i : best;
        for (int j = 0; j < n; j++)
            swap(&a[k][j], &a[best][j]);
        swap(&y[k], &y[best]);
        for (int i = 0; i < n; i++) {
            double part = i == k ? 0.0 : a[i][k] / a[k][k];
            for (int j = k; j < n; j++)
                a[i][j] -= part * a[k][j];
            y[i] -= part * y[k];
        }
    }
    bool good = true;
    for (int k = 0; k < n; k++) {
        y[k] /= a[k][k];
        good = good && isfinite(y[k]);
    }
    return good;
}

/* The step of Fisher's scoring; one that would make the white noise negative leaves it at 0. */
static bool find_step(const struct band *b, const struct resonance *r, double *step)
{
    double a[UNKNOWNS][UNKNOWNS] = {{0.0}}, y[UNKNOWNS] = {0.0}, unit = b->s->density[b->top];
    for (size_t i = b->from; i <= b->to; i++) {
        double g[UNKNOWNS], f = spectrum_frequency(b->s, i);
        double miss = b->s->density[i] / resonance_density(r, f) - 1.0;
        gradient(r, f, unit, g);
        for (int k = 0; k < UNKNOWNS; k++) {
            y[k] += g[k] * miss;
            for (int j = 0; j < UNKNOWNS; j++)
                a[k][j] += g[k] * g[j];
        }
    }
    double kept[UNKNOWNS][UNKNOWNS];
    memcpy(kept, a, sizeof kept);
    memcpy(step, y, sizeof y);
    if (!solve(UNKNOWNS, a, step))
        return false;
    if (r->white > 0.0 || step[WHITE] > 0.0)
        return true;
    memcpy(step, y, sizeof y);
    step[WHITE] = 0.0;
    return solve(WHITE, kept, step);
}

static struct resonance stepped(const struct resonance *r, const double *step, double part, double unit)
{
    double white = r->white + part * step[WHITE] * unit;
    return (struct resonance){r->f0_Hz * exp(part * step[LN_F0]), r->quality * exp(part * step[LN_QUALITY]),
                              r->low * exp(part * step[LN_LOW]), white > 0.0 ? white : 0.0};
}

static double mean(const double *value, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += value[i] / (double)n;
    return sum;
}

/* The window of 2^k bins that stands out most from the ends
 * of the band, by its mean times the root of its length. */
static void guess(const struct band *b, struct resonance *r)
{
    const double *density = b->s->density + b->from;
    size_t n = b->to - b->from + 1, end = n / 8 + 1;
    double best = -1.0, white = fmin(mean(density, end), mean(density + n - end, end));
    for (size_t width = 1; width <= n / 4; width *= 2)
        for (size_t i = 0; i + width <= n; i += width / 4 + 1) {
            double above = mean(density + i, width) - white, merit = above * sqrt((double)width);
            if (merit <= best)
                continue;
            best = merit;
            r->f0_Hz = spectrum_frequency(b->s, b->from + i) + 0.5 * spectrum_frequency(b->s, width);
            r->quality = r->f0_Hz / spectrum_frequency(b->s, width + 1);
            r->low = above / (r->quality * r->quality);
        }
    r->white = 0.5 * white;
}

/* One step towards the largest likelihood, halved until it is one. Returns its size, or -1: there is none. */
static double improve(const struct band *b, struct resonance *r)
{
    double step[UNKNOWNS], size = 0.0, before = misfit(b, r), unit = b->s->density[b->top];
    if (!find_step(b, r, step))
        return -1.0;
    for (int k = 0; k < UNKNOWNS; k++)
        size = fmax(size, fabs(step[k]));
    double part = size > 1.0 ? 1.0 / size : 1.0;
    for (int i = 0; i < HALVES; i++, part *= 0.5) {
        struct resonance next = stepped(r, step, part, unit);
        if (misfit(b, &next) <= before) {
            *r = next;
            return size * part;
        }
    }
    return 0.0;
}

bool spectrum_fit(const struct spectrum *s, double from_Hz, double to_Hz, struct resonance *r)
{
    double step = spectrum_frequency(s, 1), size = 1.0;
    struct band b = {s, (size_t)(from_Hz / step) + 1, (size_t)(to_Hz / step), (size_t)(from_Hz / step) + 1};
    if (b.to > s->length / 2 || b.to < b.from + LEAST)
        return false;
    for (size_t i = b.from; i <= b.to; i++)
        b.top = s->density[i] > s->density[b.top] ? i : b.top;
    if (b.top == b.from || b.top == b.to) /* it falls or rises through the band */
        return false;
    guess(&b, r);
    for (int i = 0; i < ROUNDS && size > 1e-12; i++)
        size = improve(&b, r);
    return size >= 0.0 && r->f0_Hz > from_Hz && r->f0_Hz < to_Hz && isfinite(r->quality + r->low + r->white);
}
