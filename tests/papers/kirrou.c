/* kirrou.c - figures 2 to 16 of Kirrou & Belhaq 2013: averaged theory (eqs 18-23), the paper's cubic model (eq 3) and
 * the true contact (eq 2, the published sign). Prints docs/papers/kirrou.csv. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/afm_tip_rungs.h"
#include "tests/mathieu.h"
#include "tests/paper.h"
#include "tests/papers/branch.h"
#include "tests/papers/rows.h"
#include "tests/papers/theory.h"

enum { CURVE = 50, STEPS = 36, ROUNDS = 60 };
static const double leap = 0.25;         /* of the amplitude from one point to the next: a jump */
static const double silicon = 29.721805; /* beta of the lever of section 3.3 at the published indentation */
static const double drive = 0.008;

static void paper_of(double beta, double r, double fast, double f, double *paper)
{
    paper_defaults(&afm_tip, paper);
    paper[TIP_PAPER_BETA] = beta;
    paper[TIP_PAPER_R] = r;
    paper[TIP_PAPER_FAST_OMEGA] = fast;
    paper[TIP_PAPER_F] = f;
}

static struct tip_theory theory_of(double beta, double r, double fast)
{
    double paper[MODEL_PARAMETERS];
    paper_of(beta, r, fast, 0.0, paper);
    struct slow s = theory_slow(&afm_tip_averaged, paper, -1.0);
    return theory_tip(&s);
}

/* Eq 21 against the detuning. */
static void draw_theory(const char *figure, const struct tip_theory *t, double f, double from, double to)
{
    for (int rank = 0; rank < 3; rank++) {
        double last = 0.0;
        int before = 0;
        for (int i = 0; i <= CURVE; i++) {
            double a[3], sigma = from + (to - from) * i / CURVE;
            int n = theory_tip_amplitude(t, f, sigma, a);
            if (n <= rank || (n != before && fabs(a[rank] - last) > leap)) /* another branch */
                rows_break();
            before = n;
            last = n > rank ? a[rank] : 0.0;
            rows_point(figure, rank == 1 ? "theory unstable" : "theory", sigma,
                       n > rank ? last : (double)NAN);
        }
        rows_break();
    }
}

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
                       .end = w1 + to,
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
    struct tip_theory t = theory_of(beta, 0.0, 1.0);
    paper_of(beta, 0.0, 1.0, f, paper);
    draw_theory(figure, &t, f, -0.2, 0.2);
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
                       .end = 0.6,
                       .step = 0.02};
    paper_of(0.8, 0.0, 1.0, f, b.paper);
    int n = branch_follow(&b, point);
    rows_point(figure, curve, f, branch_fold(point, n, 0.6) - sqrt(0.2));
}

static void draw_bistable(void)
{
    for (int k = 0; k < 2; k++) {
        struct tip_theory t = theory_of(0.8, 0.4 * k, 1.0);
        for (int i = 1; i <= CURVE; i++)
            draw_boundary("4a", k ? "theory r=0.4" : "theory", 0.012 * i / CURVE, &t, 0.012 * i / CURVE);
        rows_break();
    }
    for (int i = 3; i <= 8; i++) {
        draw_fold("4a", &afm_tip_cubic, "truncated", 0.001 * i);
        draw_fold("4a", &afm_tip, "true", 0.001 * i);
    }
    for (int k = 1; k <= 2; k++) {
        for (int i = 0; i <= CURVE; i++) {
            struct tip_theory t = theory_of(0.8, 1.2 * i / CURVE, k);
            draw_boundary(k == 1 ? "4b" : "4b Omega 2", "theory", 1.2 * i / CURVE, &t, drive);
        }
        rows_break();
    }
    /* Figure 5: the edges along r of the region with three amplitudes, for each Omega. */
    for (int k = 0; k < 2; k++) {
        for (int j = 0; j <= 60; j++) {
            double fast = 0.6 + 0.03 * j, a[3];
            int last = 0;
            for (int i = 0; i <= 1200; i++) {
                struct tip_theory t = theory_of(0.8, 0.001 * i, fast);
                int n = t.w1 > 0.0 ? theory_tip_amplitude(&t, drive, k ? -0.08 : 0.0, a) : 0;
                if (i > 0 && n != last)
                    rows_point(k ? "5b" : "5a", "theory", 0.001 * i, fast);
                last = n;
            }
        }
    }
}

/* ---- figures 6, 7, 13, 14: modulated ---- */

static struct sweep sweep_of(const struct model *model, const double *paper, double from, double to,
                             int steps)
{
    struct sweep s = {.model = model,
                      .swept = TIP_PAPER_OMEGA,
                      .omega = TIP_PAPER_OMEGA,
                      .from = from,
                      .to = to,
                      .steps = steps,
                      .tick = MOTION_TWO_PI / paper[TIP_PAPER_FAST_OMEGA] / 24.0,
                      .tol = 1e-7,
                      .wait = 1000.0,
                      .look = 700.0};
    memcpy(s.paper, paper, sizeof s.paper);
    return s;
}

/* Both ways. A motion that left the well (for the truncated model: for one that does not exist) is not drawn. */
static void draw_sweep(const char *figure, const char *curve, const struct model *model, const double *paper,
                       double w1, double from, double to)
{
    static struct seen both[2][STEPS + 1];
    double n = (2.0 / 3.0) * paper[TIP_PAPER_BETA];
    double root = (1.0 - n + sqrt((1.0 - n) * (1.0 + 3.0 * n))) / (2.0 * n), saddle = 1.0 - root * root;
    int inside = 0;
    char name[96];
    for (int back = 0; back < 2; back++) {
        struct sweep s = sweep_of(model, paper, w1 + (back ? to : from), w1 + (back ? from : to), STEPS);
        struct seen *seen = both[back];
        sweep_run(&s, seen);
        for (int i = 0; i <= STEPS; i++) {
            double other = back ? both[0][STEPS - i].amplitude : (double)NAN;
            bool left = !seen[i].good || seen[i].low < 2.0 * saddle;
            inside += !left;
            if (i > 0 && !(fabs(seen[i].amplitude - seen[i - 1].amplitude) < leap))
                rows_break();
            if (!left && !(fabs(seen[i].amplitude - other) < 0.005))
                rows_point(figure, curve, sweep_at(&s, i) - w1, seen[i].amplitude);
        }
        rows_break();
        int at = sweep_jump(&s, seen, back ? -1 : 1, leap);
        snprintf(name, sizeof name, "fig %s, %s: jump %s after omega", figure, curve, back ? "down" : "up");
        if (at >= 0)
            rows_number(name, sweep_at(&s, at));
    }
    snprintf(name, sizeof name, "fig %s, %s: share of the points that stay in the well", figure, curve);
    rows_number(name, inside / (2.0 * (STEPS + 1)));
}

static void draw_modulated(const char *figure, double beta, double r, double fast, double from, double to)
{
    double paper[MODEL_PARAMETERS];
    struct tip_theory t = theory_of(beta, r, fast);
    paper_of(beta, r, fast, drive, paper);
    draw_theory(figure, &t, drive, from, to);
    draw_sweep(figure, "truncated", &afm_tip_cubic, paper, t.w1, from, to);
    draw_sweep(figure, "true", &afm_tip, paper, t.w1, from, to);
}

/* ---- figure 8: the peak ---- */

/* Where a small force moves the tip most; NaN where the motion does not stay. */
static double small_resonance(const struct model *model, double r, double fast)
{
    static struct seen seen[STEPS + 1];
    double paper[MODEL_PARAMETERS];
    struct tip_theory t = theory_of(0.8, r, fast);
    int best = 0;
    paper_of(0.8, r, fast, 0.0003, paper);
    struct sweep s = sweep_of(model, paper, t.w1 - 0.09, t.w1 + 0.09, STEPS);
    sweep_run(&s, seen);
    for (int i = 1; i <= STEPS; i++)
        best = seen[i].good && !(seen[i].amplitude < seen[best].amplitude) ? i : best;
    if (best == 0 || best == STEPS || !seen[best - 1].good || !seen[best + 1].good || seen[best].high > 0.3)
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
        for (int i = 0; i <= CURVE; i++) {
            double a, r = 1.0 * i / CURVE;
            struct tip_theory t = theory_of(0.8, r, fast);
            double sigma = theory_tip_peak(&t, drive, &a);
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

/* ---- figures 9 to 12 and 15: the critical amplitudes ---- */

/* rho_n, with (which 1) or without (0) rho_l. */
static double criterion(double beta, double r, double fast, int which)
{
    struct tip_theory t = theory_of(beta, r, fast);
    return t.rho_n + which * t.rho_l;
}

/* The smallest r up to `most` where the criterion changes its sign with w1 real on both sides; NaN: none. */
static double critical(double beta, double fast, int which, double most)
{
    double step = most / 400.0;
    for (int i = 1; i <= 400; i++) {
        double low = step * (i - 1), high = step * i, sign = criterion(beta, low, fast, which);
        if (!(sign * criterion(beta, high, fast, which) < 0.0))
            continue;
        for (int k = 0; k < ROUNDS; k++) {
            double middle = 0.5 * (low + high);
            *(sign * criterion(beta, middle, fast, which) > 0.0 ? &low : &high) = middle;
        }
        return low;
    }
    return (double)NAN;
}

/* The smallest r at which the modulation destabilises the rest position of the linear part; NaN above 2. */
static double unstable_from(double beta, double fast)
{
    double low = 0.0;
    for (double step = 0.02; step > 1e-4; step *= 0.5) {
        for (;; low += step) {
            struct mathieu m = {0.02, 1.0 - beta, beta * (low + step), fast};
            double map[2][2];
            double complex mu[2];
            mathieu_map(&m, &taylor, 1e-11, 40, map);
            mathieu_multipliers(map, mu);
            if (cabs(mu[0]) >= 1.0)
                break;
            if (low > 2.0)
                return (double)NAN;
        }
    }
    return low;
}

static void draw_critical(void)
{
    for (int i = 0; i <= CURVE; i++) {
        struct tip_theory t = theory_of(0.8, 1.0 * i / CURVE, 1.0);
        rows_point("9", "rho_n", 1.0 * i / CURVE, t.rho_n);
        rows_point("9", "rho_l", 1.0 * i / CURVE, t.rho_l);
        rows_point("9", "sum", 1.0 * i / CURVE, t.rho_n + t.rho_l);
    }
    rows_break();
    double at = 0.0, best = -1.0, a;
    for (double r = 0.0; r <= 1.0; r += 0.001) {
        struct tip_theory t = theory_of(0.8, r, 1.0);
        double sigma = theory_tip_peak(&t, drive, &a);
        if (sigma > best) {
            best = sigma;
            at = r;
        }
    }
    rows_number("fig 8: largest detuning of the peak at r", at);
    rows_number("r_l", critical(0.8, 1.0, 1, 1.0));
    rows_number("r_s", critical(0.8, 1.0, 0, 1.0));
    for (int i = 0; i <= 60; i++) {
        double fast = 0.4 + 0.02 * i;
        rows_point("10", "linear", critical(0.8, fast, 1, 1.5), fast);
        rows_point("10", "turn", critical(0.8, fast, 0, 1.5), fast);
        rows_point("10", "unstable", unstable_from(0.8, fast), fast);
        rows_point("15", "silicon", critical(silicon, 4.0 * fast, 1, 1.5), 4.0 * fast);
        rows_point("15", "linear", critical(0.8, fast, 1, 1.5), fast);
    }
    rows_break();
    rows_number("linear part unstable at Omega 1 from r", unstable_from(0.8, 1.0));
    rows_number("linear part unstable at Omega 1.5 from r", unstable_from(0.8, 1.5));
    rows_number("linear part unstable at Omega 0.6 from r", unstable_from(0.8, 0.6));
    rows_number("linear part unstable at Omega 1, beta 0.95 from r", unstable_from(0.95, 1.0));
}

/* ---- figure 16 ---- */

static void draw_motion(const char *curve, const struct model *model, double every)
{
    static struct motion m;
    double paper[MODEL_PARAMETERS], state[MODEL_STATES];
    struct tip_theory t = theory_of(0.8, 0.2, 3.0);
    paper_of(0.8, 0.2, 3.0, drive, paper);
    paper[TIP_PAPER_C] = 0.05;
    paper[TIP_PAPER_OMEGA] = t.w1 + 0.01;
    if (motion_start(&m, model, paper, 0.02, 1e-9, NULL) != NULL || !motion_settle(&m, 2000.0))
        return;
    int skip = (int)lround(every / 0.02);
    for (int i = 0; i <= 1000; i++) {
        motion_state(&m, state);
        if (i % skip == 0)
            rows_point("16", curve, 2000.0 + 0.02 * i, state[0]);
        if (!plant_run(&m.pl, 1))
            return;
    }
    rows_break();
    struct seen seen = motion_watch(&m, 0, paper[TIP_PAPER_OMEGA], 2000.0);
    rows_number("fig 16, highest", seen.high);
    rows_number("fig 16, lowest", seen.low);
}

int main(void)
{
    rows_begin();
    draw_unmodulated("2 f=0.004", 0.8, 0.004);
    draw_unmodulated("2 f=0.01", 0.8, 0.01);
    draw_unmodulated("3 b=0.7", 0.7, drive);
    draw_unmodulated("3 b=0.8", 0.8, drive);
    draw_unmodulated("3 b=0.9", 0.9, drive);
    draw_bistable();
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
    draw_unmodulated("14 r=0", 0.95, drive);
    draw_peaks();
    draw_critical();
    draw_motion("theory", &afm_tip_averaged, 0.2);
    draw_motion("truncated", &afm_tip_cubic, 0.2);
    draw_motion("true", &afm_tip, 0.2);
    return 0;
}
