/* test_papers.c - the results in docs/papers/figures.md against references made without this code: folds of
 * periodic branches, jumps of stepped sweeps, closed forms, and the numbers that the papers print. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "tests/fixture/paper.h"
#include "tests/papers/attractor.h"
#include "tests/papers/branch_read.h"
#include "tests/papers/contact.h"
#include "tests/papers/survival.h"
#include "tests/papers/theory.h"

/* ---- folds ---- */

/* The place nearest to `near` where contact is just lost, between two points: the lowest state passes that of
 * no force. NaN: nowhere. */
static double branch_touch(const struct model *model, const struct branch_point *point, int n, double near)
{
    double open = model == &rolling_contact ? 0.0 : -1.5, best = (double)NAN;
    for (int i = 1; i < n; i++) {
        double before = point[i - 1].low - open, after = point[i].low - open;
        double at = point[i - 1].at + (point[i].at - point[i - 1].at) * before / (before - after);
        if (before * after < 0.0 && !(fabs(at - near) > fabs(best - near)))
            best = at;
    }
    return best;
}

/* Between turning points: where the largest multiplier passes 1 inside a bracket. NaN: nowhere. */
static double branch_doubling(const struct branch_point *point, int n, double from, double to)
{
    for (int i = 1; i < n; i++) {
        double before = log(point[i - 1].multiplier), after = log(point[i].multiplier);
        double at = point[i - 1].at + (point[i].at - point[i - 1].at) * before / (before - after);
        if (before * after < 0.0 && at >= from && at <= to)
            return at;
    }
    return (double)NAN;
}

/* One number of a line, or two. */
static void check_critical(const struct branch *b, const struct branch_point *point, int n, char kind,
                           const double *at)
{
    if (kind == 'd') {
        check_near(check_name("%s: period doubling in a bracket", b->model->name),
                   branch_doubling(point, n, at[0], at[1]), 0.5 * (at[0] + at[1]), 0.5 * (at[1] - at[0]));
        return;
    }
    double found = kind == 't'   ? branch_touch(b->model, point, n, at[0])
                   : kind == 'f' ? branch_fold(point, n, at[0])
                                 : branch_crossing(point, n, at[0]);
    check_near(check_name("%s: %s at %g, relative", b->model->name,
                          kind == 't'   ? "contact lost"
                          : kind == 'f' ? "fold"
                                        : "crossing",
                          at[0]),
               found / at[0], 1.0, kind == 't' ? 1e-3 : 1e-6);
}

/* Differences of the map give folds to about 1e-7, the shaft with
 * its kinks included; a first loss of contact is interpolated. */
TEST(papers_folds)
{
    static struct branch_point point[BRANCH_POINTS];
    FILE *file = fopen("tests/data/paper_folds.txt", "r");
    char line[256];
    int lines = 0;
    if (!file) {
        check_true("tests/data/paper_folds.txt can be read", 0);
        return;
    }
    while (fgets(line, sizeof line, file)) {
        struct branch b;
        const char *critical = line[0] == '#' ? NULL : branch_read(line, &b);
        if (!critical)
            continue;
        lines++;
        int n = branch_follow(&b, point), used, critical_points = 0;
        char kind;
        double at[2];
        for (; sscanf(critical, " %c%lf%n", &kind, &at[0], &used) == 2; critical += used) {
            if (kind == 'd' && sscanf(critical, " d%lf%lf%n", &at[0], &at[1], &used) != 2)
                break;
            check_critical(&b, point, n, kind, at);
            critical_points++;
        }
        check_above("points of the branch", n, 8);
        if (critical_points == 0)
            check_nan("no turning point", branch_fold(point, n, 0.7));
    }
    fclose(file);
    check_int("branches compared", lines, 20);
}

/* ---- stepped sweeps ---- */

/* Jumps of the reference, steps of 0.01 with 1400 time units to settle and 800 to measure: the frequency
 * before, and the amplitudes before and after, which it trusts to about 1e-3. */
struct jump {
    const struct model *model;
    int drive;
    double amplitude, up, down, rise[2], fall[2];
};

TEST(papers_jumps)
{
    static const struct jump jumps[] = {
        {&hertz_rig, RIG_PAPER_FORCE, 0.0, 0.96, 0.84, {0.586985, 1.32698}, {2.23605, 0.128624}},
        {&hertz_rig_cubic, RIG_PAPER_FORCE, 0.0, 0.96, 0.90, {0.583222, 1.41674}, {2.11216, 0.192909}},
        {&hertz_rig, RIG_PAPER_FORCE, 60.0, 0.92, 0.82, {0.475699, 1.26371}, {2.29745, 0.139822}},
        {&hertz_rig_cubic, RIG_PAPER_FORCE, 60.0, 0.93, 0.84, {0.528431, 1.42415}, {2.24124, 0.153865}},
        {&hertz_rig, RIG_PAPER_BASE, 5.0, 0.70, 0.69, {1.12973, 2.19237}, {2.69785, 0.580673}},
        {&hertz_rig_cubic, RIG_PAPER_BASE, 5.0, 0.95, 0.91, {0.589608, 1.49002}, {2.09597, 0.237974}},
        {&hertz_rig, RIG_PAPER_STIFFNESS, 4.0, 1.02, 0.87, {0.563223, 1.17741}, {2.14833, 0.103959}},
        {&hertz_rig_cubic, RIG_PAPER_STIFFNESS, 4.0, 1.02, 0.93, {0.555465, 1.25309}, {2.06133, 0.143748}}};
    enum { POINTS = 32 };
    static struct seen seen[POINTS];
    for (size_t i = 0; i < sizeof jumps / sizeof *jumps; i++) {
        const struct jump *j = &jumps[i];
        for (int back = 0; back < 2; back++) {
            struct sweep s = {.model = j->model,
                              .swept = RIG_PAPER_OMEGA,
                              .omega = RIG_PAPER_OMEGA,
                              .from = back ? j->up + 0.04 : j->up - 0.03,
                              .to = back ? j->down - 0.03 : j->up + 0.03,
                              .tick = MOTION_TWO_PI / 8.0 / 16.0,
                              .tol = 1e-7,
                              .wait = 1400.0,
                              .look = 800.0};
            paper_defaults(j->model, s.paper);
            s.steps = (int)lround(fabs(s.to - s.from) / 0.01);
            s.paper[RIG_PAPER_SIGMA] = 0.04;
            s.paper[j->drive] = j->amplitude;
            sweep_run(&s, seen);
            /* Base 5, the true contact: a step from 0.72 to 0.73 beside the jump. */
            for (int k = 0; j->up == 0.70 && !back && k < 2; k++)
                check_near(k ? "at 0.73" : "at 0.72", seen[5 + k].amplitude, k ? 1.578029 : 1.89551, 1e-3);
            int at = sweep_jump(&s, seen, back ? -1 : 1, 0.3);
            check_near(check_name("%s, %s %g: jump %s within its bracket of 0.01", j->model->name,
                                  hertz_rig_paper[j->drive].name, j->amplitude, back ? "down" : "up"),
                       at < 0 ? (double)NAN : sweep_at(&s, at), back ? j->down : j->up, 1e-9);
            for (int k = 0; at >= 0 && k < 2; k++) {
                double expected = back ? j->fall[k] : j->rise[k];
                check_near(k ? "  amplitude after it" : "  amplitude before it", seen[at + k].amplitude,
                           expected, 1e-4);
            }
        }
    }
}

/* ---- averaged theory ---- */

TEST(papers_theory)
{
    /* Eq 18 without a fast drive, and the mean of the one-sided force: by other code, to all digits given. */
    static const double at_090[3] = {0.21182299, 2.02463770, 2.06753047};
    static const double fast[4][3] = {{1.5, 0.8869434, -0.2388506},
                                      {3.0, 0.7830712, -1.1300830},
                                      {5.0, 0.7264078, -2.6338140},
                                      {8.0, 0.6806811, -5.1270757}};
    double paper[MODEL_PARAMETERS], a[3], jump[2];
    paper_defaults(&hertz_rig, paper);
    struct slow s = theory_slow(&hertz_rig_averaged, paper, 1.5);
    check_int("Bichri eq 18: amplitudes at 0.90", theory_rig(&s, 0.04, 0.90, a), 3);
    for (int i = 0; i < 3; i++)
        check_near("Bichri eq 18", a[i], at_090[i], 1e-8);
    for (int i = 0; i < 4; i++) {
        double shift, frequency = theory_mean_force(fast[i][0], &shift);
        check_near("mean of the one-sided force: frequency", frequency, fast[i][1], 1e-4);
        check_near("and shift", shift, fast[i][2], 1e-5);
    }
    paper_defaults(&afm_tip, paper);
    paper[TIP_PAPER_FAST_OMEGA] = 1.0;
    paper[TIP_PAPER_R] = 0.4;
    s = theory_slow(&afm_tip_averaged, paper, -1.0);
    struct tip_theory t = theory_tip(&s);
    check_near("Kirrou & Belhaq eq 18: w1", t.w1, 0.5066265247, 1e-9);
    check_near("rho_n", t.rho_n, 0.2895515692, 1e-9);
    check_near("rho_l", t.rho_l, -0.0398297502, 1e-9);
    check_near("detuning of the peak", theory_tip_peak(&t, 0.008, a), -0.0052252565, 1e-9);
    check_int("jumps", theory_tip_jumps(&t, 0.008, jump), 1);
    check_near("jump down", jump[0], -0.0057939843, 2e-7);
    check_near("jump up", jump[1], 0.0108604498, 2e-7);
    /* Published: r_l = 0.665 makes rho_n + rho_l vanish, r_s = 0.770 rho_n. */
    static const double edges[2][2] = {{0.6645, 0.6655}, {0.7695, 0.7705}};
    for (int k = 0; k < 2; k++) {
        double value[2];
        for (int i = 0; i < 2; i++) {
            paper[TIP_PAPER_R] = edges[k][i];
            s = theory_slow(&afm_tip_averaged, paper, -1.0);
            t = theory_tip(&s);
            value[i] = t.rho_n + (k == 0 ? t.rho_l : 0.0);
        }
        check_is(k ? "rho_n changes its sign at r = 0.770" : "rho_n + rho_l changes its sign at r = 0.665",
                 value[0], >, 0.0);
        check_is(k ? "rho_n changes its sign at r = 0.770" : "rho_n + rho_l changes its sign at r = 0.665",
                 value[1], <, 0.0);
    }
}

/* ---- Nayak ---- */

TEST(papers_contact)
{
    struct free_vibration f = contact_free(2.5), graze = contact_free(1.8420157493201934);
    double omega[2];
    check_near("free vibration to 2.5: frequency", f.omega, 0.7619291636, 1e-6);
    check_near("amplitude", f.amplitude, 1.9764235376, 1e-8);
    check_near("mean area", f.area, 0.7345361674, 1e-6);
    check_near("frequency at loss of contact, published 0.953", graze.omega, 0.95309931, 1e-6);
    struct balance b = contact_balance(0.8);
    check_near("harmonic balance, a1 = 0.8: a0", b.a0, 0.9102019754, 1e-6);
    check_near("frequency", sqrt(b.stiffness), 0.9628547999, 1e-6);
    check_near("upward jump by balance, xi0 0.45", contact_balance_jump(0.05, 0.45), 0.7771937553, 1e-5);
    check_near("xi0 0.9, published 0.66 to 0.67", contact_balance_jump(0.05, 0.9), 0.6721, 1e-4);
    check_int("forced balance: frequencies of a1 = 0.8", contact_balance_omega(0.8, 0.05, 0.1, omega), 2);
    /* Figure 10: xi0/zeta = 8.6 at 0.66, and the reference's row 8. */
    double low = 1.9, high = 4.0;
    for (int i = 0; i < 50; i++) {
        double middle = 0.5 * (low + high);
        f = contact_free(middle);
        *(2.0 * f.amplitude / f.omega < 8.0 ? &low : &high) = middle;
    }
    check_near("Nayak eq 61 at xi0/zeta = 8", f.omega, 0.6757074774, 1e-5);
    struct density d = contact_density(0.1);
    check_near("random: share above 1.5", contact_above(&d, 1.5), 0.0851449661, 1e-6);
    check_near("up-crossings of 1.5", contact_crossings(&d, 1.5), 0.0662324256, 1e-7);
    check_near("mean contact force", contact_mean(&d, 1.5), 1.0, 1e-6);
    check_near("standard deviation", contact_deviation(&d), sqrt(0.1747065429), 1e-5);
}

/* ---- the shaft ---- */

static bool settled(const double *paper, const double *state, struct attractor *a)
{
    struct attractor_shaft s;
    bool good = attractor_open(&s, &shaft_bearing, paper) && attractor_settle(&s, state, 16.0, a);
    attractor_close(&s);
    return good;
}

TEST(papers_shaft)
{
    double paper[MODEL_PARAMETERS], hz[3], amplitude[3];
    static const double open[3] = {17.97666323, 25.43124252, 699.87488496};
    static const double closed[3] = {451.11005415, 1187.82493996, 1302.66230235};
    attractor_paper(SHAFT_HARD, 25.0, paper);
    attractor_frequencies(paper, 0.0, hz);
    for (int k = 0; k < 3; k++)
        check_near("open gap, Hz", hz[k], open[k], 1e-6);
    attractor_frequencies(paper, 1.0, hz);
    for (int k = 0; k < 3; k++)
        check_near("closed gap, Hz (table 2 prints 451.1, 1180, 1303)", hz[k], closed[k], 1e-5);
    attractor_linear(paper, amplitude);
    check_near("linear amplitude of x1 at 25 Hz, mm", 1e3 * amplitude[0], 0.832731826, 1e-6);
    /* Published: peak at 28.9 Hz; order 3 between 55 and 73 Hz;
     * the pair at 18.49 Hz. Reference for the first: 11.4876 mm. */
    struct attractor a;
    attractor_paper(SHAFT_SOFT, 28.9, paper);
    check_true("28.9 Hz runs", settled(paper, NULL, &a));
    check_int("its period", a.period, 1);
    check_near("largest x1, mm", 1e3 * a.high[0], 11.4876, 2e-3);
    uint64_t seed = 1;
    double state[MODEL_STATES];
    int order3 = 0, pair[2] = {0, 0};
    for (int i = 0; i < 24; i++) {
        attractor_paper(SHAFT_SOFT, 60.0, paper);
        attractor_start(&seed, paper[SHAFT_G1], state);
        order3 += settled(paper, state, &a) && a.period == 3;
        attractor_paper(SHAFT_SOFT, 18.49, paper);
        if (settled(paper, state, &a) && a.period == 1)
            pair[a.high[0] > a.high[2]]++;
    }
    check_above("starts at 60 Hz that end on order 3", order3, 1);
    check_is("both of the pair at 18.49 Hz", pair[0], >, 0);
    check_is("both of the pair at 18.49 Hz", pair[1], >, 0);
    attractor_paper(SHAFT_HARD, 25.0, paper);
    check_true("25 Hz runs", settled(paper, NULL, &a));
    check_int("hard contact at 25 Hz: aperiodic", a.period, 0);
    check_near("flattened at the gap: largest x1 over it", a.high[0] / paper[SHAFT_G1], 1.09, 0.05);
}

/* Figure 20: without support 3 the impacting motion reaches from 670 to 760 Hz, with it from 680 to 740 Hz.
 * The standard error of 20 starts is 0.1. */
TEST(papers_survival)
{
    enum { STARTS = 20 };
    static const double hz[] = {670.0, 760.0};
    double paper[MODEL_PARAMETERS], share[2];
    attractor_paper(SHAFT_HARD, 36.0, paper);
    check_near("quiet motion from, Hz", survival_quiet(paper, 25.0, 60.0), 36.273, 1e-3);
    attractor_paper(SHAFT_HARD, 700.0, paper);
    check_near("and none to, Hz: the branch folds there", survival_quiet(paper, 699.8, 750.0), 700.4704,
               1e-4);
    check_near("no quiet motion: share at 700 Hz", survival_share(paper, 3.0, 5), 1.0, 0.0);
    for (int i = 0; i < 2; i++) {
        for (int weak = 0; weak < 2; weak++) {
            attractor_paper(SHAFT_HARD, hz[i], paper);
            paper[SHAFT_KS3] = weak ? 0.0 : 8030.0;
            share[weak] = survival_share(paper, 3.0, STARTS);
        }
        check_above(check_name("%g Hz: share that impacts after 3 s, more without support 3", hz[i]),
                    share[1] - share[0], 0.15);
    }
}
