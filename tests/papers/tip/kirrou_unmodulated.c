/* kirrou_unmodulated.c - see kirrou_paper.h: the periodic
 * branches themselves, and where there are three amplitudes. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/reduced/afm_tip_reduced.h"
#include "tests/papers/branch.h"
#include "tests/papers/tip/kirrou_paper.h"
#include "tests/papers/rows.h"

/* ---- figures 2 and 3: no modulation, the periodic branches themselves ---- */

/* The branch from a frequency far above or below the resonance, where the motion from rest settles on it. */
static void draw_branch(const char *figure, const struct model *model, const double *paper, const char *curve,
                        double from, double to)
{
    static struct branch_point point[BRANCH_POINTS];
    double w1 = sqrt(1.0 - paper[TIP_PAPER_BETA]), x = HUGE_VAL, y = HUGE_VAL;
    char name[64];
    bool stable = true;
    struct branch b = {.model = model,
                       .swept = TIP_PAPER_OMEGA,
                       .turn = MOTION_TWO_PI,
                       .unit = 1.0,
                       .ticks = 64,
                       .from = w1 + from,
                       .to = w1 + to,
                       .step = 0.02};
    memcpy(b.paper, paper, sizeof b.paper);
    int n = branch_follow(&b, point);
    for (int i = 0; i < n; i++) {
        const struct branch_point *p = &point[i];
        bool now = p->multiplier < 1.0;
        double amplitude = 0.5 * (p->high - p->low);
        if (now == stable && !p->fold && hypot((p->at - x) / 0.4, amplitude - y) < 0.03)
            continue;
        if (fabs(p->at - w1) > 0.21)
            continue;
        x = p->at;
        y = amplitude;
        if (now != stable)
            rows_break();
        stable = now;
        snprintf(name, sizeof name, now ? "%s" : "%s unstable", curve);
        rows_point(figure, name, x - w1, amplitude);
        snprintf(name, sizeof name, "fig %s, %s: fold at omega", figure, curve);
        if (p->fold)
            rows_number(name, p->at);
    }
    rows_break();
}

static void draw_unmodulated(const char *figure, double beta, double f)
{
    double paper[MODEL_PARAMETERS];
    struct tip_theory t = kirrou_theory(beta, 0.0, 1.0);
    kirrou_paper(beta, 0.0, 1.0, f, paper);
    kirrou_draw_theory(figure, &t, f, -0.2, 0.2);
    draw_branch(figure, &afm_tip_cubic, paper, "truncated", 0.4, -0.2);
    draw_branch(figure, &afm_tip, paper, "true", 0.4, -0.2);
    if (beta < 0.9) { /* else nothing stays in the well below the resonance */
        draw_branch(figure, &afm_tip_cubic, paper, "truncated", -0.2, 0.05);
        draw_branch(figure, &afm_tip, paper, "true", -0.2, 0.05);
    }
}

/* ---- figures 4 and 5: where there are three amplitudes ---- */

static void draw_boundary(const char *figure, const char *curve, double x, const struct tip_theory *t,
                          double f)
{
    double jump[2];
    if (!theory_tip_jumps(t, f, jump))
        return;
    rows_point(figure, curve, x, jump[0]);
    char other[48];
    snprintf(other, sizeof other, "%s other", curve);
    rows_point(figure, other, x, jump[1]);
}

/* Upward jump of the periodic branch, r = 0. */
static void draw_fold(const char *figure, const struct model *model, const char *curve, double f)
{
    static struct branch_point point[BRANCH_POINTS];
    struct branch b = {.model = model,
                       .swept = TIP_PAPER_OMEGA,
                       .turn = MOTION_TWO_PI,
                       .unit = 1.0,
                       .ticks = 64,
                       .from = 0.3,
                       .to = 0.6,
                       .step = 0.02};
    kirrou_paper(0.8, 0.0, 1.0, f, b.paper);
    int n = branch_follow(&b, point);
    rows_point(figure, curve, f, branch_fold(point, n, 0.6) - sqrt(0.2));
}

static void draw_bistable(void)
{
    for (int k = 0; k < 2; k++) {
        struct tip_theory t = kirrou_theory(0.8, 0.4 * k, 1.0);
        for (int i = 1; i <= KIRROU_CURVE; i++)
            draw_boundary("4a", k ? "theory r=0.4" : "theory", 0.012 * i / KIRROU_CURVE, &t,
                          0.012 * i / KIRROU_CURVE);
        rows_break();
    }
    for (int i = 3; i <= 8; i++) {
        draw_fold("4a", &afm_tip_cubic, "truncated", 0.001 * i);
        draw_fold("4a", &afm_tip, "true", 0.001 * i);
    }
    for (int k = 1; k <= 2; k++) {
        for (int i = 0; i <= KIRROU_CURVE; i++) {
            struct tip_theory t = kirrou_theory(0.8, 1.2 * i / KIRROU_CURVE, k);
            draw_boundary(k == 1 ? "4b" : "4b Omega 2", "theory", 1.2 * i / KIRROU_CURVE, &t, KIRROU_DRIVE);
        }
        rows_break();
    }
    /* Figure 5: the edges along r of the region with three amplitudes, for each Omega. */
    for (int k = 0; k < 2; k++) {
        for (int j = 0; j <= 60; j++) {
            double fast = 0.6 + 0.03 * j, a[3];
            int last = 0;
            for (int i = 0; i <= 1200; i++) {
                struct tip_theory t = kirrou_theory(0.8, 0.001 * i, fast);
                int n = t.w1 > 0.0 ? theory_tip_amplitude(&t, KIRROU_DRIVE, k ? -0.08 : 0.0, a) : 0;
                if (i > 0 && n != last)
                    rows_point(k ? "5b" : "5a", "theory", 0.001 * i, fast);
                last = n;
            }
        }
    }
}

void kirrou_draw_unmodulated(void)
{
    draw_unmodulated("2 f=0.004", 0.8, 0.004);
    draw_unmodulated("2 f=0.01", 0.8, 0.01);
    draw_unmodulated("3 b=0.7", 0.7, KIRROU_DRIVE);
    draw_unmodulated("3 b=0.8", 0.8, KIRROU_DRIVE);
    draw_unmodulated("3 b=0.9", 0.9, KIRROU_DRIVE);
    draw_unmodulated("14 r=0", 0.95, KIRROU_DRIVE);
    draw_bistable();
}
