/* kirrou_modulated.c - see kirrou_paper.h: stepped sweeps
 * both ways, resonances of small forces, and figure 16. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/reduced/afm_tip_reduced.h"
#include "tests/papers/tip/kirrou_paper.h"
#include "tests/papers/rows.h"

/* ---- figures 6, 7, 13, 14: modulated ---- */

/* Both ways. A motion that left the well (for the truncated
 * model: for one that does not exist) is not drawn. */
static void draw_sweep(const char *figure, const char *curve, const struct model *model, const double *paper,
                       double w1, double from, double to)
{
    static struct seen both[2][KIRROU_STEPS + 1];
    double n = (2.0 / 3.0) * paper[TIP_PAPER_BETA];
    double root = (1.0 - n + sqrt((1.0 - n) * (1.0 + 3.0 * n))) / (2.0 * n), saddle = 1.0 - root * root;
    int inside = 0;
    char name[96];
    for (int back = 0; back < 2; back++) {
        struct sweep s =
            kirrou_sweep(model, paper, w1 + (back ? to : from), w1 + (back ? from : to), KIRROU_STEPS);
        struct seen *seen = both[back];
        sweep_run(&s, seen);
        for (int i = 0; i <= KIRROU_STEPS; i++) {
            double other = back ? both[0][KIRROU_STEPS - i].amplitude : (double)NAN;
            bool left = !seen[i].good || seen[i].low < 2.0 * saddle;
            inside += !left;
            if (i > 0 && !(fabs(seen[i].amplitude - seen[i - 1].amplitude) < KIRROU_LEAP))
                rows_break();
            if (!left && !(fabs(seen[i].amplitude - other) < 0.005))
                rows_point(figure, curve, sweep_at(&s, i) - w1, seen[i].amplitude);
        }
        rows_break();
        int at = sweep_jump(&s, seen, back ? -1 : 1, KIRROU_LEAP);
        snprintf(name, sizeof name, "fig %s, %s: jump %s after omega", figure, curve, back ? "down" : "up");
        if (at >= 0)
            rows_number(name, sweep_at(&s, at));
    }
    snprintf(name, sizeof name, "fig %s, %s: share of the points that stay in the well", figure, curve);
    rows_number(name, inside / (2.0 * (KIRROU_STEPS + 1)));
}

static void draw_modulated(const char *figure, double beta, double r, double fast, double from, double to)
{
    double paper[MODEL_PARAMETERS];
    struct tip_theory t = kirrou_theory(beta, r, fast);
    kirrou_paper(beta, r, fast, KIRROU_DRIVE, paper);
    kirrou_draw_theory(figure, &t, KIRROU_DRIVE, from, to);
    draw_sweep(figure, "truncated", &afm_tip_cubic, paper, t.w1, from, to);
    draw_sweep(figure, "true", &afm_tip, paper, t.w1, from, to);
}

/* ---- figure 8: the peak ---- */

/* Where a small force moves the tip most; NaN where the motion does not stay. */
static double small_resonance(const struct model *model, double r, double fast)
{
    static struct seen seen[KIRROU_STEPS + 1];
    double paper[MODEL_PARAMETERS];
    struct tip_theory t = kirrou_theory(0.8, r, fast);
    int best = 0;
    kirrou_paper(0.8, r, fast, 0.0003, paper);
    struct sweep s = kirrou_sweep(model, paper, t.w1 - 0.09, t.w1 + 0.09, KIRROU_STEPS);
    sweep_run(&s, seen);
    for (int i = 1; i <= KIRROU_STEPS; i++)
        best = seen[i].good && !(seen[i].amplitude < seen[best].amplitude) ? i : best;
    if (best == 0 || best == KIRROU_STEPS || !seen[best - 1].good || !seen[best + 1].good ||
        seen[best].high > 0.3)
        return (double)NAN;
    double y[3];
    for (int i = 0; i < 3; i++)
        y[i] = 1.0 / (seen[best - 1 + i].amplitude * seen[best - 1 + i].amplitude);
    return sweep_at(&s, best) + 0.0025 * (y[0] - y[2]) / (y[0] - 2.0 * y[1] + y[2]);
}

static void draw_peaks(void)
{
    char figure[32], name[64];
    for (int fast = 1; fast <= 3; fast++) {
        snprintf(figure, sizeof figure, "8 Omega %d", fast);
        for (int i = 0; i <= KIRROU_CURVE; i++) {
            double a, r = 1.0 * i / KIRROU_CURVE;
            struct tip_theory t = kirrou_theory(0.8, r, fast);
            double sigma = theory_tip_peak(&t, KIRROU_DRIVE, &a);
            rows_point(figure, "theory", r, t.w1 + sigma);
            if (fast == 1)
                rows_point(figure, "theory detuning", r, sigma);
            rows_point(figure, "theory small", r, t.w1 - 0.5 * t.rho_l / t.w1);
        }
        rows_break();
        for (int i = 0; i <= 10; i++) {
            double truth = small_resonance(&afm_tip, 0.1 * i, fast);
            rows_point(figure, "truncated", 0.1 * i, small_resonance(&afm_tip_cubic, 0.1 * i, fast));
            rows_point(figure, "true", 0.1 * i, truth);
            snprintf(name, sizeof name, "fig 8, Omega %d, r %.1f: true resonance, small force", fast,
                     0.1 * i);
            rows_number(name, truth);
        }
        rows_break();
    }
}

/* ---- figures 4b and 5: the upward jump ---- */

/* Detuning from w1(r) at which the motion jumps up as the frequency is raised, to 0.00125; NaN: it does not
 * stay, or does not jump. */
static double jump_up(const struct model *model, double r, double fast)
{
    enum { STEPS = 40 };
    static struct seen seen[STEPS + 1];
    double paper[MODEL_PARAMETERS], jump[2] = {-0.05, -0.04};
    struct tip_theory t = kirrou_theory(0.8, r, fast);
    (void)theory_tip_jumps(&t, KIRROU_DRIVE, jump);
    kirrou_paper(0.8, r, fast, KIRROU_DRIVE, paper);
    struct sweep s = kirrou_sweep(model, paper, t.w1 + jump[1] - 0.06, t.w1 + jump[1] + 0.04, STEPS);
    sweep_run(&s, seen);
    int at = sweep_jump(&s, seen, 1, 0.15);
    return at < 0 ? (double)NAN : 0.5 * (sweep_at(&s, at) + sweep_at(&s, at + 1)) - t.w1;
}

/* The modulation at which that is detuning 0. */
static double edge_up(const struct model *model, double fast)
{
    double low = 0.1, high = 0.95;
    while (high - low > 0.01) {
        double middle = 0.5 * (low + high);
        *(jump_up(model, middle, fast) < 0.0 ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

static void draw_jumps(void)
{
    static const struct model *const model[] = {&afm_tip_cubic, &afm_tip};
    static const char *const curve[] = {"truncated", "true"};
    char name[64];
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i <= 8; i++) {
            double sigma = jump_up(model[k], 0.1 * i, 2.0);
            rows_point("4b Omega 2", curve[k], 0.1 * i, sigma);
            snprintf(name, sizeof name, "fig 4b, Omega 2, r %.1f, %s: jump up at sigma", 0.1 * i, curve[k]);
            rows_number(name, sigma);
            if (i <= 2) {
                sigma = jump_up(model[k], 0.05 * i, 1.0);
                rows_point("4b", curve[k], 0.05 * i, sigma);
                snprintf(name, sizeof name, "fig 4b, Omega 1, r %.2f, %s: jump up at sigma", 0.05 * i,
                         curve[k]);
                rows_number(name, sigma);
            }
        }
        rows_break();
        for (int i = 0; i <= 3; i++) {
            double fast = 1.8 + 0.2 * i, r = edge_up(model[k], fast);
            rows_point("5a", curve[k], r, fast);
            snprintf(name, sizeof name, "fig 5, sigma 0, Omega %.1f, %s: jump up at r", fast, curve[k]);
            rows_number(name, r);
        }
        rows_break();
    }
}

/* ---- figure 16 ---- */

static void draw_motion(const char *curve, const struct model *model, double every)
{
    static struct motion m;
    double paper[MODEL_PARAMETERS], state[MODEL_STATES];
    struct tip_theory t = kirrou_theory(0.8, 0.2, 3.0);
    kirrou_paper(0.8, 0.2, 3.0, KIRROU_DRIVE, paper);
    paper[TIP_PAPER_C] = 0.05;
    paper[TIP_PAPER_OMEGA] = t.w1 + 0.01;
    if (motion_start(&m, model, paper, 0.02, 1e-9, NULL) != NULL || !motion_settle(&m, 2000.0))
        return;
    int skip = (int)lround(every / 0.02);
    for (int i = 0; i <= 1000; i++) {
        motion_state(&m, state);
        if (i % skip == 0)
            rows_point("16", curve, 0.02 * i, state[0]);
        if (!plant_run(&m.pl, 1))
            return;
    }
    rows_break();
    struct seen seen = motion_watch(&m, 0, paper[TIP_PAPER_OMEGA], 2000.0);
    rows_number("fig 16, highest", seen.high);
    rows_number("fig 16, lowest", seen.low);
}

void kirrou_draw_modulated(void)
{
    draw_modulated("6 Omega=1", 0.8, 0.5, 1.0, -0.1, 0.15);
    draw_modulated("6 Omega=1.5", 0.8, 0.5, 1.5, -0.1, 0.15);
    draw_modulated("6 Omega=2", 0.8, 0.5, 2.0, -0.1, 0.15);
    draw_modulated("7 r=0.4", 0.8, 0.4, 1.0, -0.1, 0.15);
    draw_modulated("7 r=0.7", 0.8, 0.7, 1.0, -0.1, 0.15);
    draw_modulated("7 r=1", 0.8, 1.0, 1.0, -0.1, 0.15);
    draw_modulated("13 r=0.4", 0.8, 0.4, 0.6, -0.1, 0.2);
    draw_modulated("13 r=0.7", 0.8, 0.7, 0.6, -0.1, 0.2);
    draw_modulated("13 r=0.9", 0.8, 0.9, 0.6, -0.1, 0.2);
    draw_modulated("14 r=0.4", 0.95, 0.4, 1.0, -0.2, 0.2);
    draw_modulated("14 r=0.7", 0.95, 0.7, 1.0, -0.2, 0.2);
    draw_modulated("14 r=1", 0.95, 1.0, 1.0, -0.2, 0.2);
    draw_peaks();
    draw_jumps();
    draw_motion("theory", &afm_tip_averaged, 0.2);
    draw_motion("truncated", &afm_tip_cubic, 0.2);
    draw_motion("true", &afm_tip, 0.2);
}
