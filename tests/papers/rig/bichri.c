/* bichri.c - figures 2, 3, 5, 6, 8, 9 of Bichri, Belhaq & Perret-Liaudet 2011, and where the resonance goes:
 * averaged theory (eqs 18, 24, 35), the paper's cubic model and the single-sided contact. Prints
 * docs/img/papers/bichri.csv. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/paper.h"
#include "tests/papers/branch.h"
#include "tests/papers/rows.h"
#include "tests/papers/theory.h"

static const double fast = 8.0, slow_force = 0.04;
static const double leap = 0.3; /* relative change of amplitude from one point to the next that is a jump */
enum { POINTS = 200, CURVE = 80 };

/* A strategy: which parameter the fast amplitude is. */
struct strategy {
    const char *name;
    int amplitude;
};
static const struct strategy strategies[] = {
    {"force", RIG_PAPER_FORCE}, {"base", RIG_PAPER_BASE}, {"stiffness", RIG_PAPER_STIFFNESS}};

static void paper_of(const struct strategy *s, double a, double sigma, double *paper)
{
    paper_defaults(&hertz_rig, paper);
    paper[RIG_PAPER_SIGMA] = sigma;
    paper[RIG_PAPER_FAST_OMEGA] = fast;
    paper[s->amplitude] = a;
}

/* ---- figures 2, 5, 8: motion against time ---- */

static void draw_motion(const char *figure, const char *curve, const struct model *model, const double *paper,
                        double every)
{
    static struct motion m;
    double state[MODEL_STATES], from = 2000.0, to = from + 26.0;
    enum { TICKS_A_POINT = 4 };
    if (motion_start(&m, model, paper, every / TICKS_A_POINT, 1e-8, NULL) != NULL)
        return;
    bool good = motion_settle(&m, from);
    for (double t = from; good && t < to; t += every) {
        motion_state(&m, state);
        rows_point(figure, curve, t - from, state[0]);
        good = plant_run(&m.pl, TICKS_A_POINT);
    }
    rows_break();
}

static void draw_motions(const char *figure, const struct strategy *s, double a, double omega)
{
    double paper[MODEL_PARAMETERS];
    paper_of(s, a, slow_force, paper);
    paper[RIG_PAPER_OMEGA] = omega;
    draw_motion(figure, "theory", &hertz_rig_averaged, paper, 0.25);
    draw_motion(figure, "truncated", &hertz_rig_cubic, paper, 0.1);
    draw_motion(figure, "true", &hertz_rig, paper, 0.1);
    static struct motion m;
    if (motion_start(&m, &hertz_rig, paper, MOTION_TWO_PI / fast / 16.0, 1e-8, NULL) != NULL ||
        !motion_settle(&m, 2000.0))
        return;
    struct seen seen = motion_watch(&m, 0, omega, 2000.0);
    char name[64];
    snprintf(name, sizeof name, "fig %s, true: share without contact", figure);
    rows_number(name, seen.loss);
    rows_number("  amplitude at omega", seen.amplitude);
    rows_number("  lowest q", seen.low);
}

/* ---- figures 3, 6, 9: amplitude against frequency ---- */

static void draw_theory(const char *figure, const double *paper, double from, double to)
{
    struct slow s = theory_slow(&hertz_rig_averaged, paper, 1.5);
    for (int rank = 0; rank < 3; rank++) {
        double last = 0.0;
        int before = 0;
        for (int i = 0; i <= CURVE; i++) {
            double a[3], omega = from + (to - from) * i / CURVE;
            int n = theory_rig(&s, paper[RIG_PAPER_SIGMA], omega, a);
            if (n <= rank || (n != before && fabs(a[rank] - last) > leap)) /* another branch */
                rows_break();
            before = n;
            last = n > rank ? a[rank] : 0.0;
            rows_point(figure, rank == 1 ? "theory unstable" : "theory", omega,
                       n > rank ? last : (double)NAN);
        }
        rows_break();
    }
}

static struct sweep sweep_of(const struct model *model, const double *paper, double from, double to)
{
    struct sweep s = {.model = model,
                      .swept = RIG_PAPER_OMEGA,
                      .omega = RIG_PAPER_OMEGA,
                      .from = from,
                      .to = to,
                      .steps = (int)lround(fabs(to - from) / 0.01),
                      .tick = MOTION_TWO_PI / fast / 16.0,
                      .tol = 1e-7,
                      .wait = 1400.0,
                      .look = 800.0};
    memcpy(s.paper, paper, sizeof s.paper);
    return s;
}

/* A stepped sweep both ways; the jumps as numbers. */
static void draw_sweep(const char *figure, const char *curve, const struct model *model, const double *paper,
                       double from, double to)
{
    static struct seen both[2][POINTS];
    for (int back = 0; back < 2; back++) {
        struct sweep s = sweep_of(model, paper, back ? to : from, back ? from : to);
        struct seen *seen = both[back];
        char name[96];
        sweep_run(&s, seen);
        int at = sweep_jump(&s, seen, back ? -1 : 1, leap);
        for (int i = 0; i <= s.steps; i++) {
            double other = back ? both[0][s.steps - i].amplitude : HUGE_VAL;
            if (at >= 0 && i == at + 1)
                rows_break();
            if (!(fabs(seen[i].amplitude - other) < 0.005)) /* where both ways agree, one point */
                rows_point(figure, curve, sweep_at(&s, i), seen[i].amplitude);
        }
        rows_break();
        snprintf(name, sizeof name, "fig %s, %s, jump %s after", figure, curve, back ? "down" : "up");
        rows_number(name, at < 0 ? (double)NAN : sweep_at(&s, at));
        double loss = 0.0;
        for (int i = 0; i <= s.steps; i++)
            loss = fmax(loss, seen[i].loss);
        snprintf(name, sizeof name, "fig %s, %s, %s: largest share without contact", figure, curve,
                 back ? "down" : "up");
        rows_number(name, loss);
    }
}

static void draw_response(const char *figure, const struct strategy *s, double a, double from, double to)
{
    double paper[MODEL_PARAMETERS];
    paper_of(s, a, slow_force, paper);
    draw_theory(figure, paper, from, to);
    draw_sweep(figure, "truncated", &hertz_rig_cubic, paper, from, to);
    draw_sweep(figure, "true", &hertz_rig, paper, from, to);
}

/* ---- where the resonance is ---- */

/* Resonance of the linear motion about the averaged equation's rest position. */
static double averaged_resonance(const struct strategy *s, double a)
{
    double paper[MODEL_PARAMETERS];
    paper_of(s, a, 0.0, paper);
    struct slow e = theory_slow(&hertz_rig_averaged, paper, 1.5);
    double z = 0.0;
    for (int i = 0; i < 50; i++)
        z -= (e.constant + z * (e.w2 + z * (e.quadratic + z * e.cubic))) /
             (e.w2 + z * (2.0 * e.quadratic + 3.0 * z * e.cubic));
    return sqrt(e.w2 + z * (2.0 * e.quadratic + 3.0 * z * e.cubic));
}

/* Frequency at which a small slow force, a tenth of the paper's and less, moves the rig most; *loss: the
 * share of the time without contact there. NaN where the peak is at an end of the range. */
static double small_resonance(const struct model *model, const struct strategy *s, double a, double *loss)
{
    static struct seen seen[POINTS];
    double paper[MODEL_PARAMETERS];
    int best = 0;
    paper_of(s, a, 0.002, paper);
    struct sweep w = sweep_of(model, paper, 0.55, 1.3);
    w.wait = 500.0;
    w.look = 400.0;
    sweep_run(&w, seen);
    for (int i = 1; i <= w.steps; i++)
        best = seen[i].amplitude > seen[best].amplitude ? i : best;
    *loss = seen[best].loss;
    if (best == 0 || best == w.steps || !seen[best].good)
        return (double)NAN;
    /* Near its peak 1/amplitude^2 of a linear motion is a parabola. */
    double y[3];
    for (int i = 0; i < 3; i++)
        y[i] = 1.0 / (seen[best - 1 + i].amplitude * seen[best - 1 + i].amplitude);
    return sweep_at(&w, best) + 0.005 * (y[0] - y[2]) / (y[0] - 2.0 * y[1] + y[2]);
}

static void draw_resonance(const struct strategy *s, double most, int steps)
{
    char figure[32], name[64];
    snprintf(figure, sizeof figure, "resonance %s", s->name);
    for (int i = 0; i <= 50; i++)
        rows_point(figure, "theory", most * i / 50, averaged_resonance(s, most * i / 50));
    rows_break();
    for (int i = 0; i <= 50 && s->amplitude != RIG_PAPER_STIFFNESS; i++) {
        double shift, a = most * i / 50;
        rows_point(figure, "mean force", a,
                   theory_mean_force(s->amplitude == RIG_PAPER_FORCE ? a / (fast * fast) : a, &shift));
    }
    rows_break();
    for (int i = 0; i <= steps; i++) {
        double loss, a = most * i / steps;
        double truncated = small_resonance(&hertz_rig_cubic, s, a, &loss);
        double w = small_resonance(&hertz_rig, s, a, &loss);
        rows_point(figure, "truncated", a, truncated);
        rows_point(figure, "true", a, w);
        rows_point(figure, "loss", a, loss);
        snprintf(name, sizeof name, "resonance, %s %g: true", s->name, a);
        rows_number(name, w);
        rows_number("  share without contact", loss);
        rows_number("  truncated model", truncated);
        rows_number("  averaged theory", averaged_resonance(s, a));
    }
    rows_break();
}

int main(void)
{
    const struct strategy *force = &strategies[0], *base = &strategies[1], *stiffness = &strategies[2];
    rows_print_header();
    draw_motions("2", force, 60.0, 0.98);
    draw_motions("5", base, 8.0, 0.99);
    draw_motions("8", stiffness, 5.0, 1.12);
    draw_response("3a", force, 0.0, 0.7, 1.3);
    draw_response("3b", force, 60.0, 0.7, 1.3);
    draw_response("3c", force, 70.0, 0.7, 1.3);
    draw_response("6b", base, 5.0, 0.5, 1.3);
    draw_response("6c", base, 8.0, 0.5, 1.3);
    draw_response("9b", stiffness, 4.0, 0.7, 1.3);
    draw_response("9c", stiffness, 5.0, 0.7, 1.3);
    draw_resonance(force, 80.0, 8);
    draw_resonance(base, 8.0, 16);
    draw_resonance(stiffness, 6.0, 6);
    return 0;
}
