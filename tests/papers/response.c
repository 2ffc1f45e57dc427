/* response.c - see response.h. */
#include "tests/papers/response.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/papers/one_mode.h"
#include "tests/papers/rows.h"

enum { CURVE = 160, KNOWN = 64, BELOW = 200, ABOVE = 3000 };
static const double mm = 1e3;

/* Row of coordinate k; z: NaN for none. */
static void draw(const struct response *r, int k, const char *curve, double hz, double y, double z)
{
    char figure[48];
    snprintf(figure, sizeof figure, "%s x%d", r->figure, k + 1);
    if (isnan(z))
        rows_point(figure, curve, hz, y * mm);
    else
        rows_value(figure, curve, hz, y * mm, z);
}

void response_theory(const struct response *r, const char *name)
{
    double paper[MODEL_PARAMETERS], amplitude[3];
    memcpy(paper, r->paper, sizeof paper);
    for (int k = 0; k < r->n_coordinates; k++) {
        for (int i = 0; i <= CURVE; i++) {
            paper[SHAFT_PAPER_HZ] = r->from + (r->to - r->from) * i / CURVE;
            attractor_linear(paper, amplitude);
            draw(r, k, name, paper[SHAFT_PAPER_HZ], amplitude[k], (double)NAN);
        }
        rows_break();
    }
}

/* ---- averaged ---- */

/* Amplitude i of q: in equal ratios up to the gap, beyond it so in what exceeds the gap, up to the peak. */
static double amplitude_of(int i, double least, double gap, double peak)
{
    double knee = fmin(gap, peak);
    if (i <= BELOW)
        return least * pow(knee / least, (double)i / BELOW);
    return knee + (peak - knee) * pow(10.0, -6.0 * (1.0 - (double)(i - BELOW) / ABOVE));
}

void response_balance(const struct response *r, const char *name)
{
    struct one_mode m = one_mode_of(r->paper, (int)r->paper[SHAFT_PAPER_MODE]);
    double at, peak = one_mode_peak(&m, &at), reach = one_mode_reach(&m), end = 0.0;
    char text[80];
    snprintf(text, sizeof text, "fig %s, averaged: peak at Hz", r->figure);
    rows_number(text, at);
    rows_number("  of the mode's motion, mm", peak * mm);
    for (int k = 0; k < r->n_coordinates; k++) {
        double x = HUGE_VAL, y = HUGE_VAL, shape = fabs(m.shape[k]);
        /* Up the lower frequency of each amplitude and down the higher one. */
        for (int i = 0; i <= 2 * (BELOW + ABOVE) + 1; i++) {
            bool up = i <= BELOW + ABOVE;
            double hz[2], a = amplitude_of(up ? i : 2 * (BELOW + ABOVE) + 1 - i, 1e-7, reach, peak);
            int n = one_mode_balance(&m, a, hz);
            end = n > 0 && a > reach ? fmax(end, hz[0]) : end;
            if (n <= up || hz[up] < r->from || hz[up] > r->to ||
                hypot((hz[up] - x) / (r->to - r->from) * 100.0, log(a / y) * 10.0) < 0.7)
                continue;
            x = hz[up];
            y = a;
            draw(r, k, name, x, shape * y, (double)NAN);
        }
        rows_break();
    }
    rows_number("  impacts up to, Hz", end);
}

/* ---- attractors ---- */

static void draw_one(const struct response *r, const char *name, double hz, const struct attractor *a)
{
    char curve[64];
    if (a->period == 0)
        snprintf(curve, sizeof curve, "%s aperiodic", name);
    else
        snprintf(curve, sizeof curve, "%s period %d", name, a->period > 3 ? 4 : a->period);
    for (int k = 0; k < r->n_coordinates; k++)
        draw(r, k, curve, hz, a->high[k], a->period);
}

/* Highest values of a motion without period scatter. */
static bool is_known(const struct attractor *known, int n, const struct attractor *a)
{
    static const double near[] = {0.02, 0.1};
    for (int i = 0; i < n; i++)
        if (known[i].period == a->period &&
            fabs(known[i].high[0] - a->high[0]) < near[a->period == 0] * a->high[0])
            return true;
    return false;
}

void response_attractors(const struct response *r, const struct model *model, const char *name,
                         response_found *found, void *context)
{
    uint64_t seed = 12345;
    for (int i = 0; i <= r->points; i++) {
        double hz = r->from + (r->to - r->from) * i / r->points, paper[MODEL_PARAMETERS], state[MODEL_STATES];
        struct attractor known[KNOWN], a;
        struct attractor_shaft s;
        int n = 0;
        memcpy(paper, r->paper, sizeof paper);
        paper[SHAFT_PAPER_HZ] = hz;
        if (!attractor_open(&s, model, paper))
            continue;
        for (int k = 0; k < r->starts && n < KNOWN; k++) {
            (model == &shaft_bearing ? attractor_start : one_mode_start)(&seed, r->span, state);
            if (!attractor_settle(&s, k == 0 ? NULL : state, r->seconds, &a) || is_known(known, n, &a))
                continue;
            known[n++] = a;
            draw_one(r, name, hz, &a);
            if (found)
                found(context, hz, &a);
        }
        attractor_close(&s);
    }
    rows_break();
}

void response_branch(const char *figure, const char *name, const struct branch_point *point, int n)
{
    char curve[64];
    double x = HUGE_VAL, y = HUGE_VAL, from = HUGE_VAL, to = 0.0;
    bool stable = true;
    for (int i = 0; i < n; i++) {
        from = fmin(from, point[i].at);
        to = fmax(to, point[i].at);
    }
    for (int i = 0; i < n; i++) {
        const struct branch_point *p = &point[i];
        bool now = p->multiplier < 1.0, special = p->fold || p->crossing;
        if (now == stable && !special && i < n - 1 &&
            hypot((p->at - x) / (to - from) * 100.0, log(p->high / y) * 10.0) < 1.0)
            continue;
        if (now != stable)
            rows_break();
        stable = now;
        x = p->at;
        y = p->high;
        snprintf(curve, sizeof curve, now ? "%s" : "%s unstable", name);
        rows_point(figure, curve, x, y * mm);
        snprintf(curve, sizeof curve, "fig %s, %s: %s at Hz", figure, name, p->fold ? "fold" : "crossing");
        if (special)
            rows_number(curve, x);
    }
    rows_break();
}
