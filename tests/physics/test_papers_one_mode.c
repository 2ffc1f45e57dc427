/* test_papers_one_mode.c - the model of one mode beside the shaft, as docs/papers/shaft.md has it figure
 * by figure: against closed forms, quadrature, an integration of its own, and the shaft. */
#include "tests/unit/test.h"

#include <math.h>
#include "tests/papers/motion.h"
#include "tests/papers/one_mode.h"
#include "tests/papers/survival.h"

/* ---- averaged ---- */

static double over(double x, double gap)
{
    return fmax(x - gap, 0.0) + fmin(x + gap, 0.0);
}

TEST(papers_one_mode_averaged)
{
    enum { N = 4096 };
    double paper[MODEL_PARAMETERS], amplitude[3], linear[3], hz[2], at;
    for (int k = 1; k < 5; k++) {
        double a = 0.6 * k, sum = 0.0;
        for (int i = 0; i < N; i++) {
            double turn = cos(MOTION_TWO_PI * (i + 0.5) / N);
            sum += 2.0 / N * over(a * turn, 1.0) * turn;
        }
        check_near("share of a gap spring's stiffness: first harmonic by quadrature", one_mode_share(a, 1.0),
                   sum / a, 1e-5);
    }
    /* Open: the shaft's own linear answer, less the other modes: at the resonances, 18 and 0.47 mm. */
    static const double resonance[] = {17.97666323, 0.0, 699.87488496};
    for (int mode = 1; mode <= 3; mode += 2) {
        attractor_paper(SHAFT_HARD, resonance[mode - 1], paper);
        paper[SHAFT_G1] = paper[SHAFT_G3] = 1.0;
        struct one_mode m = one_mode_of(paper, mode);
        attractor_linear(paper, linear);
        check_int("open gap: one amplitude", one_mode_amplitudes(&m, resonance[mode - 1], amplitude), 1);
        check_near("over the shaft's", amplitude[0] / linear[0], 1.0, 2e-3);
        check_near("peak over it", one_mode_peak(&m, &at) / amplitude[0], 1.0, 1e-3);
        check_near("its frequency, Hz", at, resonance[mode - 1], 1e-2);
    }
    /* Closed: sqrt((2 k_1 + 2 kg)/(4 m)) but for the shape of the mode, 1 to 0.0013. */
    attractor_paper(SHAFT_SOFT, 25.0, paper);
    struct one_mode m = one_mode_of(paper, 1);
    double far = 1e3 * paper[SHAFT_G1];
    m.force = far * m.damping * MOTION_TWO_PI * 30.0;
    check_int("far beyond the gap: two frequencies", one_mode_balance(&m, far, hz), 2);
    check_near("between them, Hz: gaps closed", sqrt(hz[0] * hz[1]),
               sqrt((4.0 * 8030.0 + 2.0 * SHAFT_SOFT) / (4.0 * 0.629)) / MOTION_TWO_PI, 0.05);
    /* Every amplitude that the balance has at a frequency, it has at that frequency. */
    attractor_paper(SHAFT_HARD, 80.0, paper);
    m = one_mode_of(paper, 1);
    check_int("hard contact at 80 Hz: amplitudes", one_mode_amplitudes(&m, 80.0, amplitude), 3);
    for (int i = 0; i < 3; i++) {
        int n = one_mode_balance(&m, amplitude[i], hz);
        check_above("frequencies of such an amplitude", n, 1);
        check_near("the nearer one, Hz", fmin(fabs(hz[0] - 80.0), fabs(hz[n - 1] - 80.0)), 0.0, 1e-3);
    }
}

/* ---- integrated ---- */

/* A mode for some periods from q, by RK4 of q'' = (F cos w t - C q' - K q - contact)/M in steps of 2 us, and
 * its extremes in the last one. */
static void one_mode_run(const struct one_mode *m, double hz, int periods, double *q, double *high,
                         double *low)
{
    int steps = (int)ceil(0.5e6 / hz);
    double w = MOTION_TWO_PI * hz, h = 1.0 / (hz * steps);
    *high = -HUGE_VAL;
    *low = HUGE_VAL;
    for (int i = 0; i < periods * steps; i++) {
        double k[4][2], add[2] = {0.0, 0.0};
        static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
        for (int s = 0; s < 4; s++) {
            double x = q[0] + (s ? h * at[s] * k[s - 1][0] : 0.0);
            double v = q[1] + (s ? h * at[s] * k[s - 1][1] : 0.0);
            double push = m->force * cos(w * h * (i % steps + at[s])) - m->damping * v - m->stiffness * x;
            for (int b = 0; b < 3; b += 2)
                push -= m->shape[b] * m->contact[b] * over(m->shape[b] * x, m->gap[b]);
            k[s][0] = v;
            k[s][1] = push / m->mass;
            add[0] += weight[s] * k[s][0] / 6.0;
            add[1] += weight[s] * k[s][1] / 6.0;
        }
        q[0] += h * add[0];
        q[1] += h * add[1];
        if (i >= (periods - 1) * steps) {
            *high = fmax(*high, q[0]);
            *low = fmin(*low, q[0]);
        }
    }
}

/* The motion that starts lead to with at least so many switches a period. */
static bool one_mode_settle(const double *paper, int mode, double switches, struct attractor *a)
{
    struct attractor_shaft s;
    double state[MODEL_STATES];
    uint64_t seed = 5;
    bool found = false;
    if (!one_mode_open(&s, paper, mode))
        return false;
    for (int i = 0; i < 20 && !found; i++) {
        one_mode_start(&seed, paper[SHAFT_G1], state);
        found = attractor_settle(&s, state, 20.0, a) && a->switches >= switches;
    }
    attractor_close(&s);
    return found;
}

/* Figures 12, 9 and 19 of one mode: what the exact method finds, by RK4 and equations written out here.
 * Extremes are of its ticks, 128 a period or more, so too small by up to 0.3 %. */
TEST(papers_one_mode_integrated)
{
    static const struct {
        double kg, hz, c;
        int mode;
        double high, switches, contact;
    } motion[] = {{SHAFT_SOFT, 28.9, 4.0, 1, 11.4706, 8.0, 0.986},
                  {SHAFT_SOFT, 18.49, 4.0, 1, 0.8416, 8.0, 0.783},
                  {SHAFT_HARD, 80.0, 4.0, 1, 0.2725, 8.0, 0.096},
                  {SHAFT_HARD, 700.0, 4.0, 3, 0.2568, 8.0, 0.095},
                  {SHAFT_HARD, 5.0, 139.0, 1, 0.2578, 264.0, 0.264}};
    for (size_t i = 0; i < sizeof motion / sizeof *motion; i++) {
        struct attractor a = {.period = -1};
        double paper[MODEL_PARAMETERS], high, low;
        attractor_paper(motion[i].kg, motion[i].hz, paper);
        for (int k = 0; k < 3; k++)
            paper[SHAFT_C1 + k] = motion[i].c;
        struct one_mode m = one_mode_of(paper, motion[i].mode);
        check_true(check_name("%g Hz, c = %g: the mode impacts", motion[i].hz, motion[i].c),
                   one_mode_settle(paper, motion[i].mode, 1.0, &a));
        check_int("its period", a.period, 1);
        check_near("largest x1, mm", 1e3 * a.high[0], motion[i].high, 1e-4);
        check_near("switches in a period", a.switches, motion[i].switches, 0.0);
        check_near("share of time in contact", 1.0 - a.loss, motion[i].contact, 1e-3);
        double q[2] = {a.state[0], a.state[1]};
        one_mode_run(&m, motion[i].hz, 3, q, &high, &low);
        check_near("after three periods by RK4: q over the largest", q[0] / a.high[0], a.state[0] / a.high[0],
                   1e-4);
        check_near("and its rate over that of the circle", q[1] / (MOTION_TWO_PI * motion[i].hz * a.high[0]),
                   a.state[1] / (MOTION_TWO_PI * motion[i].hz * a.high[0]), 1e-3);
        check_near("largest q", high / a.high[0], 1.0, 3e-3);
        check_near("lowest q", low / a.low[0], 1.0, 3e-3);
    }
}

/* ---- the figures ---- */

/* The largest x1 and x3 of some starts, the first from rest; of the shaft (mode 0) or of a mode. */
static void find_largest(const double *paper, int mode, int starts, double *x1, double *x3)
{
    struct attractor_shaft s;
    struct attractor a;
    double state[MODEL_STATES];
    uint64_t seed = 3;
    *x1 = *x3 = 0.0;
    if (!(mode ? one_mode_open(&s, paper, mode) : attractor_open(&s, &shaft_bearing, paper)))
        return;
    for (int i = 0; i < starts; i++) {
        (mode ? one_mode_start : attractor_start)(&seed, paper[SHAFT_G1], state);
        if (!attractor_settle(&s, i ? state : NULL, 6.0, &a))
            continue;
        *x1 = fmax(*x1, 1e3 * a.high[0]);
        *x3 = fmax(*x3, 1e3 * a.high[2]);
    }
    attractor_close(&s);
}

/* Figure 13: the pair in unison, mirror images, stays with one mode kept (the shaft: papers_exponents). */
static void check_pair(void)
{
    double paper[MODEL_PARAMETERS], state[MODEL_STATES];
    struct attractor_shaft s;
    struct attractor a;
    uint64_t seed = 3;
    int seen[2] = {0, 0};
    attractor_paper(SHAFT_SOFT, 12.47, paper);
    if (!one_mode_open(&s, paper, 1)) {
        check_true("12.47 Hz opens", 0);
        return;
    }
    for (int i = 0; i < 12; i++) {
        one_mode_start(&seed, paper[SHAFT_G1], state);
        if (!attractor_settle(&s, state, 16.0, &a) || a.period != 1)
            continue;
        int down = a.high[0] < -a.low[0];
        seen[down]++;
        check_near("the larger side, mm", 1e3 * (down ? -a.low[0] : a.high[0]), 0.838, 1e-3);
        check_near("the smaller one", 1e3 * (down ? a.high[0] : -a.low[0]), 0.482, 1e-3);
    }
    attractor_close(&s);
    check_int("12.47 Hz: all starts of the mode end on one of the pair, both are found", seen[0] + seen[1],
              12);
    check_is("12.47 Hz: all starts of the mode end on one of the pair, both are found", seen[0], >, 0);
    check_is("12.47 Hz: all starts of the mode end on one of the pair, both are found", seen[1], >, 0);
}

/* Figures 8 and 17: where impacts end. */
static void check_ends(void)
{
    double paper[MODEL_PARAMETERS];
    attractor_paper(SHAFT_HARD, 200.0, paper);
    check_near("200 Hz: no start of the shaft impacts after 3 s", survival_share(paper, 3.0, 20), 0.0, 0.0);
    check_above("of the mode many do", survival_share_mode(paper, 1, 3.0, 40), 0.3);
    attractor_paper(SHAFT_HARD, 690.0, paper);
    check_above("690 Hz: of the shaft some do", survival_share(paper, 3.0, 20), 0.1);
    check_near("of bending none", survival_share_mode(paper, 3, 3.0, 40), 0.0, 0.0);
    /* c = 139 (figure 18). */
    attractor_paper(SHAFT_HARD, 36.0, paper);
    paper[SHAFT_C1] = paper[SHAFT_C1 + 1] = paper[SHAFT_C1 + 2] = 139.0;
    check_near("36 Hz, c = 139: of the shaft none", survival_share(paper, 2.0, 20), 0.0, 0.0);
    check_above("of the mode more than a third", survival_share_mode(paper, 1, 2.0, 40), 0.33);
}

/* Figures 10, 11, 17, 20, 23: both sides of what each sentence says. */
static void check_maps(void)
{
    double paper[MODEL_PARAMETERS], x1, x3, at;
    attractor_paper(SHAFT_HARD, 660.0, paper);
    paper[SHAFT_G1] = paper[SHAFT_G3] = 4.681e-5;
    check_near("gap 0.047 mm, 660 Hz: share of the shaft", survival_share(paper, 1.0, 8), 1.0, 0.0);
    check_near("of bending", survival_share_mode(paper, 3, 1.0, 20), 0.0, 0.0);
    attractor_paper(SHAFT_HARD, 22.0, paper);
    paper[SHAFT_G1] = paper[SHAFT_G3] = 3.557e-3;
    for (int mode = 0; mode < 2; mode++) {
        find_largest(paper, mode, 12, &x1, &x3);
        check_near("gap 3.6 mm, 22 Hz: x1, mm", x1, mode ? 3.59 : 3.66, 0.05);
    }
    attractor_paper(6.921e5, 94.5, paper);
    struct one_mode m = one_mode_of(paper, 1);
    check_near("kg = 6.9e5: averaged peak, mm", 1e3 * one_mode_peak(&m, &at), 2.94, 0.01);
    check_near("at, Hz", at, 112.75, 0.01);
    find_largest(paper, 1, 12, &x1, &x3);
    check_near("94.5 Hz: x1 of the mode, mm", x1, 0.897, 5e-3);
    attractor_paper(SHAFT_HARD, 100.0, paper);
    paper[SHAFT_C1] = paper[SHAFT_C1 + 1] = paper[SHAFT_C1 + 2] = 27.13;
    check_near("c = 27, 100 Hz: share of the shaft", survival_share(paper, 3.0, 12), 0.0, 0.0);
    check_above("of the mode", survival_share_mode(paper, 1, 3.0, 40), 0.1);
    attractor_paper(SHAFT_SOFT, 24.5, paper);
    paper[SHAFT_KS3] = 0.0;
    m = one_mode_of(paper, 1);
    check_near("no support 3: x1 over x3 of the first mode", m.shape[0] / m.shape[2], 0.0, 1e-9);
    find_largest(paper, 0, 2, &x1, &x3);
    check_near("24.5 Hz: x1 of the shaft, mm", x1, 6.71, 0.1);
    attractor_paper(SHAFT_HARD, 32.0, paper);
    paper[SHAFT_KG3] = 2.631e4;
    find_largest(paper, 0, 4, &x1, &x3);
    check_above("kg3 = 2.63e4, 32 Hz: x3 of the shaft, mm", x3, 4.5);
    find_largest(paper, 1, 4, &x1, &x3);
    check_near("of the mode", x3, 0.27, 0.04);
}

TEST(papers_one_mode_figures)
{
    double paper[MODEL_PARAMETERS], x1, x3, at;
    check_pair();
    check_ends();
    check_maps();
    /* Figures 14 and 15: the turning point (of the shaft 706.796 Hz, as published, about 707), averaged. */
    attractor_paper(SHAFT_MID, 700.0, paper);
    struct one_mode m = one_mode_of(paper, 3);
    (void)one_mode_peak(&m, &at);
    check_near("kg = 1.4e6: averaged turning point, Hz", at, 706.796, 0.02);
    /* Figure 22: a bearing alone far from its gap turns about
     * the other one, sqrt(8 ks/(6 m)): published, near 22 Hz. */
    attractor_paper(SHAFT_HARD, 20.76, paper);
    paper[SHAFT_KS1] = 1e9;
    double hz[3];
    attractor_frequencies(paper, 0.0, hz);
    check_near("bearing 1 held: first eigenfrequency, Hz", hz[0],
               sqrt(8.0 * 8030.0 / (6.0 * 0.629)) / MOTION_TWO_PI, 0.02);
    attractor_paper(SHAFT_HARD, 22.0, paper);
    paper[SHAFT_G3] = 0.02;
    find_largest(paper, 0, 6, &x1, &x3);
    check_near("gap 3 of 20 mm, 22 Hz: x1 at its gap, mm", x1, 0.27, 0.03);
    check_above("x3, mm", x3, 5.0);
    find_largest(paper, 1, 6, &x1, &x3);
    check_near("of the mode: x3, mm", x3, 0.27, 0.02);
    check_near("and x1", x1, x3, 1e-6);
}
