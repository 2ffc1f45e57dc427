/* fit.c - see fit.h. */
#include "host_sim/test/fit.h"

#include <math.h>
#include <string.h>
#include "models/math/elementary.h"

enum { OWN = 1 + 2 * MODEL_INPUTS }; /* the first unknown of the fit's tone */

/* At least half of the wave's power must be left, less rounding to ticks: one period has so much. */
static const double told = 0.24;

static void note_rate(struct fit *f, int i, double rate)
{
    if (f->rate[i].most <= 0.0 || rate < f->rate[i].least)
        f->rate[i].least = rate;
    f->rate[i].most = fmax(f->rate[i].most, rate);
}

void fit_add(struct fit *f, double place, uint64_t turns, double x, const struct fit_drive *drive)
{
    double c, s, b[LOCKIN_UNKNOWNS + 1] = {1.0};
    cos_sin_turns(turns_of(place), &c, &s);
    double w = 0.5 * (1.0 - c);
    for (int i = 0; drive && i < MODEL_INPUTS; i++) {
        if (!(drive[i].rate > 0.0))
            continue;
        b[1 + 2 * i] = drive[i].cosine;
        b[2 + 2 * i] = drive[i].sine;
        note_rate(f, i, drive[i].rate);
    }
    cos_sin_turns(turns, &b[OWN], &b[OWN + 1]);
    b[LOCKIN_UNKNOWNS] = x;
    f->n++;
    for (int i = 0; i < LOCKIN_UNKNOWNS; i++)
        for (int j = i; j <= LOCKIN_UNKNOWNS; j++)
            f->sums.g[i][j] += w * b[i] * b[j];
}

/* Periods a window from drive i to the wave; 0 where its frequency went through it. */
static double periods_apart(const struct fit *f, int i, double rate, double ticks)
{
    return fmax(fmax(f->rate[i].least - rate, rate - f->rate[i].most), 0.0) * ticks;
}

static void leave_out(struct lockin_normal *q, int drive)
{
    for (int k = 1 + 2 * drive; k <= 2 + 2 * drive; k++)
        for (int i = 0; i <= LOCKIN_UNKNOWNS; i++) {
            q->g[k][i] = 0.0;
            if (i < k)
                q->g[i][k] = 0.0;
        }
}

enum lockin_verdict fit_solve(const struct fit *f, double rate, double ticks, double *amplitude,
                              double *phase_deg)
{
    struct lockin_normal q = f->sums;
    struct lockin_sum z = {0.0, 0.0};
    double nearest = 1.0, w = q.g[0][0];
    for (int i = 0; i < MODEL_INPUTS; i++)
        if (f->rate[i].most > 0.0)
            nearest = fmin(nearest, periods_apart(f, i, rate, ticks));
    for (int i = 0; i < MODEL_INPUTS; i++)
        if (nearest < 1.0 && periods_apart(f, i, rate, ticks) <= nearest + LOCKIN_EQUAL)
            leave_out(&q, i);
    if (f->n < 4 || !(lockin_solve(&q, LOCKIN_TONES, w, &z) > told * w))
        return f->n < 4 || rate * ticks < 0.99 ? LOCKIN_SHORT : LOCKIN_CLOSE;
    lockin_polar(&z, 1.0, amplitude, phase_deg);
    *phase_deg *= 180.0 / ELEMENTARY_PI;
    return LOCKIN_TOLD;
}
