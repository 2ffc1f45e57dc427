/* response.c - see response.h. */
#include "tests/papers/response.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/papers/rows.h"

enum { CURVE = 160, KNOWN = 64 };
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

static void draw_one(const struct response *r, const char *name, double hz, const struct attractor *a, int n)
{
    char curve[64];
    if (a->period == 0)
        snprintf(curve, sizeof curve, "%s aperiodic", name);
    else
        snprintf(curve, sizeof curve, "%s period %d", name, a->period > 3 ? 4 : a->period);
    for (int k = 0; k < n; k++)
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
            attractor_start(&seed, r->span, state);
            if (!attractor_settle(&s, k == 0 ? NULL : state, r->seconds, &a) || is_known(known, n, &a))
                continue;
            known[n++] = a;
            draw_one(r, name, hz, &a, model->n_states > 2 ? r->n_coordinates : 1);
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
