/* shaft_motion.c - figures 9, 18, 19 of the shaft-bearing paper, hard contact: chaotic motions by histories, phase
 * portraits, Poincare sections and statistics; chatter. Prints docs/papers/shaft_motion.csv. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/papers/history.h"
#include "tests/papers/response.h"
#include "tests/papers/rows.h"
#include "tests/papers/survival.h"

static struct motion m;
static const double mm = 1e3;

/* ---- figure 9: chaos ---- */

/* Three periods of the phase portrait, and the section at the drive's maximum over so many: curves NAMEportrait and
 * NAMEsection. */
static void draw_section(const char *figure, const char *name, const double *paper, const struct attractor *a,
                         int periods)
{
    char curve[32];
    int ticks = history_ticks(paper), every = ticks / 240 + 1;
    double state[MODEL_STATES];
    for (int section = 0; section < 2; section++) {
        int n = section ? periods : 3 * ticks / every;
        snprintf(curve, sizeof curve, "%s%s", name, section ? "section" : "portrait");
        if (!history_start(&m, paper, a))
            return;
        for (int i = 0; i < n; i++) {
            motion_state(&m, state);
            rows_point(figure, curve, state[0] * mm, state[3]);
            if (!plant_run(&m.pl, (uint64_t)(section ? ticks : every)))
                return;
        }
        rows_break();
    }
}

static void draw_chaos(const char *figure, double hz, double seconds, double average)
{
    double paper[MODEL_PARAMETERS], state[MODEL_STATES];
    uint64_t seed = 5;
    int counted;
    struct attractor a = {.period = 1}, quiet = {.period = 0};
    struct attractor_shaft s;
    attractor_paper(SHAFT_HARD, hz, paper);
    if (!attractor_open(&s, &shaft_bearing, paper))
        return;
    /* The impacting motion, not the quiet one beside it. */
    for (int i = 0; i < 40 && !(a.period == 0 && a.switches > 0.2); i++) {
        attractor_start(&seed, paper[SHAFT_G1], state);
        (void)attractor_settle(&s, state, seconds, &a);
    }
    rows_number("fig 9, Hz", hz);
    rows_number("  largest x1, mm", a.high[0] * mm);
    rows_number("  switches in a period", a.switches);
    rows_number("  share of time in contact", 1.0 - a.loss);
    rows_number("  Lyapunov exponent, 1/s",
                attractor_mean_exponent(&s, paper[SHAFT_G1], average, 40, &counted));
    rows_number("    mean of so many starts", counted);
    history_sample(figure, "true", paper, &a, 5, 1);
    draw_section(figure, "", paper, &a, (int)fmin(average * hz, 400.0));
    if (attractor_settle(&s, NULL, 60.0, &quiet) && quiet.period == 1) {
        history_sample(figure, "quiet", paper, &quiet, 5, 1);
        draw_section(figure, "quiet ", paper, &quiet, 1);
        rows_number("  the quiet motion beside it: largest x1, mm", quiet.high[0] * mm);
    }
    for (double wait = 1.0; wait <= 16.0; wait *= 4.0) {
        rows_number("  seconds", wait);
        rows_number("  share of starts that still impact", survival_share(paper, wait, 40));
    }
    attractor_close(&s);
}

/* ---- figures 18, 19: strong damping ---- */

static void damp(double hz, bool proportional, double *paper)
{
    attractor_paper(SHAFT_HARD, hz, paper);
    for (int i = 0; i < 3; i++)
        paper[SHAFT_C1 + i] = proportional && i == 1 ? 278.0 : 139.0;
}

static void draw_damped(void)
{
    static const double hz[] = {5.0, 15.0, 25.0};
    char figure[32];
    for (int proportional = 0; proportional < 2; proportional++) {
        struct response r = {.figure = proportional ? "18 C2" : "18 C1",
                             .from = 2.0,
                             .to = 60.0,
                             .points = 116,
                             .starts = 12,
                             .span = 2.54e-4,
                             .seconds = 2.0,
                             .n_coordinates = 1};
        damp(25.0, proportional, r.paper);
        response_theory(&r, "theory");
        response_attractors(&r, &shaft_bearing, "true", NULL, NULL);
        for (int k = 0; k < 3; k++) {
            double paper[MODEL_PARAMETERS];
            damp(hz[k], proportional, paper);
            snprintf(figure, sizeof figure, "18 C%d %g", proportional + 1, hz[k]);
            history_draw(figure, paper, 24, 1);
        }
    }
}

/* Least squares of log y against log x. */
static double slope(const double *x, const double *y, int n)
{
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (int i = 0; i < n; i++) {
        sx += log(x[i]);
        sy += log(y[i]);
        sxx += log(x[i]) * log(x[i]);
        sxy += log(x[i]) * log(y[i]);
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/* Amplitude of harmonic k of x1 over whole periods of the chattering motion (figure 19). */
static void draw_spectrum(void)
{
    enum { HARMONICS = 400, PERIODS = 20, FITTED = 19 };
    static double complex line[HARMONICS + 1];
    double paper[MODEL_PARAMETERS], state[MODEL_STATES], x[FITTED], y[FITTED];
    struct attractor_shaft s;
    struct attractor a;
    damp(5.0, false, paper);
    if (!attractor_open(&s, &shaft_bearing, paper))
        return;
    bool good = attractor_settle(&s, NULL, 2.0, &a) && history_start(&m, paper, &a);
    attractor_close(&s);
    if (!good)
        return;
    rows_number("fig 19: switches in a period, c = 139, 5 Hz", a.switches);
    draw_section("19", "", paper, &a, 300);
    history_sample("19", "true", paper, &a, 1, 1);
    int ticks = history_ticks(paper);
    if (!history_start(&m, paper, &a))
        return;
    for (int i = 0; i < PERIODS * ticks; i++) {
        motion_state(&m, state);
        double complex turn = cexp(-(double complex)I * MOTION_TWO_PI * (i % ticks) / ticks), power = 1.0;
        for (int k = 1; k <= HARMONICS; k++) {
            power *= turn;
            line[k] += state[0] * power * 2.0 / (PERIODS * ticks);
        }
        if (!plant_run(&m.pl, 1))
            return;
    }
    for (int k = 1; k <= HARMONICS; k += 2) {
        if (k < 40 || k % 8 == 1)
            rows_point("19", "harmonics", 5.0 * k, cabs(line[k]) * mm);
        if (k >= 3 && k <= 39) {
            x[(k - 3) / 2] = k;
            y[(k - 3) / 2] = cabs(line[k]);
        }
    }
    rows_break();
    rows_number("fig 19: slope of the harmonics, 15 to 195 Hz", slope(x, y, FITTED));
}

int main(void)
{
    rows_begin();
    draw_chaos("9 25", 25.0, 2.0, 20.0);
    draw_chaos("9 80", 80.0, 1.0, 1.2);
    draw_chaos("9 700", 700.0, 0.5, 4.0);
    draw_damped();
    draw_spectrum();
    return 0;
}
