/* lockin_fit.c - least squares of a mean and tones under a Hann window; see lockin_fit.h. */
#include "firmware/observe/lockin_fit.h"

#include <math.h>
#include "models/math/elementary.h"

static const double told = 0.499;  /* share of a tone's power that must be left, less rounding */
static const double spent = 1e-6;  /* share of a tone's power below which nothing is left to take out */
static const double nearly = 1e-4; /* periods a window: there a kernel is taken for its limit */

/* sin(n x) / sin(x), or its limit where that is 0/0. */
static double dirichlet(double n, double sine_n, double cosine_n, double sine, double cosine)
{
    bool limit = fabs(sine) * n < nearly * ELEMENTARY_PI;
    return limit ? n * cosine_n / cosine : sine_n / sine;
}

/* sum w_k exp(i (2 pi rate k + phase)), k from the middle of the window. Its weights are 1/2 and two waves of
 * one turn a window. */
static struct lockin_sum window_sum(const struct lockin_window *w, double rate, uint64_t phase)
{
    double n = w->n_ticks, c, s, c_n, s_n, c_turn, s_turn;
    cos_sin_turns(turns_of(0.5 * rate), &c, &s);
    cos_sin_turns(turns_of(0.5 * rate * n), &c_n, &s_n);
    cos_sin_turns(turns_of(0.5 / n), &c_turn, &s_turn);
    double middle = dirichlet(n, s_n, c_n, s, c),
           above = dirichlet(n, s_n, c_n, s * c_turn + c * s_turn, c * c_turn - s * s_turn),
           below = dirichlet(n, s_n, c_n, s * c_turn - c * s_turn, c * c_turn + s * s_turn);
    double sum = 0.5 * middle - 0.25 * (above + below);
    cos_sin_turns(phase, &c, &s);
    return (struct lockin_sum){sum * c, sum * s};
}

/* Products of the tones in rows and columns 1 + 2 i and 1 + 2 j on: cosine and sine of each. */
static void add_pair(struct lockin_normal *q, const struct lockin_window *w, const struct lockin_tone *tone,
                     int i, int j)
{
    struct lockin_sum up = window_sum(w, tone[i].rate + tone[j].rate, tone[i].phase + tone[j].phase),
                      down = {w->weight, 0.0};
    if (i < j)
        down = window_sum(w, tone[i].rate - tone[j].rate, tone[i].phase - tone[j].phase);
    double *cosine = &q->g[1 + 2 * i][1 + 2 * j], *sine = &q->g[2 + 2 * i][1 + 2 * j];
    cosine[0] = 0.5 * (down.re + up.re);
    cosine[1] = 0.5 * (up.im - down.im);
    sine[0] = 0.5 * (up.im + down.im);
    sine[1] = 0.5 * (down.re - up.re);
}

static void set_up(struct lockin_normal *q, const struct lockin_window *w, const struct lockin_tone *tone,
                   int n, double mean)
{
    q->g[0][0] = w->weight;
    q->g[0][LOCKIN_UNKNOWNS] = mean;
    for (int j = 0; j < n; j++) {
        struct lockin_sum alone = window_sum(w, tone[j].rate, tone[j].phase);
        q->g[0][1 + 2 * j] = alone.re;
        q->g[0][2 + 2 * j] = alone.im;
        q->g[1 + 2 * j][LOCKIN_UNKNOWNS] = tone[j].sum.re;
        q->g[2 + 2 * j][LOCKIN_UNKNOWNS] = -tone[j].sum.im;
        for (int i = 0; i <= j; i++)
            add_pair(q, w, tone, i, j);
    }
}

/* Takes unknown k out of the equations behind it, up to `end`. One of which nothing is left stays in. */
static void eliminate(struct lockin_normal *q, int k, int end, double least)
{
    const double *pivot = q->g[k];
    if (!(pivot[k] > least))
        return;
    for (int i = k + 1; i < end; i++) {
        double share = pivot[i] / pivot[k];
        for (int j = i; j < end; j++)
            q->g[i][j] -= share * pivot[j];
        q->g[i][LOCKIN_UNKNOWNS] -= share * pivot[LOCKIN_UNKNOWNS];
    }
}

/* Turns a tick from the nearest whole number: samples of two tones are equal where it is 0. */
static double apart(double turns)
{
    return fabs(turns_to_double(turns_of(turns)));
}

bool lockin_equal(const struct lockin_window *w, const struct lockin_tone *a, const struct lockin_tone *b)
{
    double d = apart(a->rate - b->rate), mirrored = apart(a->rate + b->rate);
    return (d < mirrored ? d : mirrored) * w->n_ticks < LOCKIN_EQUAL;
}

double lockin_solve(struct lockin_normal *q, int n, double weight, struct lockin_sum *z)
{
    int last = 2 * n - 1;
    for (int k = 0; k < last; k++)
        eliminate(q, k, last + 2, 0.5 * spent * weight);
    double cc = q->g[last][last], cs = q->g[last][last + 1], ss = q->g[last + 1][last + 1];
    double x = q->g[last][LOCKIN_UNKNOWNS], y = q->g[last + 1][LOCKIN_UNKNOWNS], half = 0.5 * (cc - ss);
    double left = 0.5 * (cc + ss) - sqrt(half * half + cs * cs), determinant = cc * ss - cs * cs;
    if (left > 0.0)
        *z = (struct lockin_sum){(ss * x - cs * y) / determinant, -(cc * y - cs * x) / determinant};
    return left;
}

enum lockin_verdict lockin_fit(const struct lockin_window *w, const struct lockin_tone *tone, int n,
                               double mean, struct lockin_sum *z)
{
    struct lockin_normal q;
    struct lockin_sum found = {0.0, 0.0};
    if (!(tone[n - 1].rate < 0.5))
        return LOCKIN_CLOSE;
    set_up(&q, w, tone, n, mean);
    if (!(lockin_solve(&q, n, w->weight, &found) > 0.5 * told * w->weight))
        return apart(tone[n - 1].rate) * w->n_ticks < 1.0 ? LOCKIN_SHORT : LOCKIN_CLOSE;
    *z = found;
    return LOCKIN_TOLD;
}
