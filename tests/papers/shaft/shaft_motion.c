/* shaft_motion.c - figures 9, 18, 19 of the shaft-bearing paper, hard contact: chaotic motions by histories,
 * phase portraits, Poincare sections and statistics; chatter; all beside the model of one mode. Prints
 * docs/img/papers/shaft_motion.csv. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/reduced/shaft_mode.h"
#include "tests/papers/history.h"
#include "tests/papers/one_mode.h"
#include "tests/papers/response.h"
#include "tests/papers/rows.h"
#include "tests/papers/survival.h"

static struct motion m;
static const double mm = 1e3;

/* ---- figure 9: chaos ---- */

/* Three periods of the phase portrait, and the section at the drive's maximum over so many: curves
 * NAMEportrait and NAMEsection. */
static void draw_section(const char *figure, const char *name, const struct model *model, const double *paper,
                         const struct attractor *a, int periods)
{
    char curve[32];
    int ticks = history_ticks(paper), every = ticks / 240 + 1;
    double state[MODEL_STATES];
    for (int section = 0; section < 2; section++) {
        int n = section ? periods : 3 * ticks / every;
        snprintf(curve, sizeof curve, "%s%s", name, section ? "section" : "portrait");
        if (!history_start(&m, model, paper, a))
            return;
        for (int i = 0; i < n; i++) {
            history_state(&m, state);
            rows_point(figure, curve, state[0] * mm, state[3]);
            if (!plant_run(&m.pl, (uint64_t)(section ? ticks : every)))
                return;
        }
        rows_break();
    }
}

/* The impacting motion of the shaft, not the quiet one beside
 * it, or of the mode that `paper` keeps: after some seconds. */
static void draw_impacting(const char *figure, const char *name, const struct model *model,
                           const double *paper, double seconds, double average)
{
    double state[MODEL_STATES], hz = paper[SHAFT_PAPER_HZ];
    bool kept = model != &shaft_bearing;
    uint64_t seed = 5;
    int counted = 0;
    struct attractor a = {.switches = 0.0};
    struct attractor_shaft s;
    char section[32];
    if (!attractor_open(&s, model, paper))
        return;
    for (int i = 0; i < 40 && !(a.switches > 0.2 && (kept || a.period == 0)); i++) {
        (kept ? one_mode_start : attractor_start)(&seed, paper[SHAFT_G1], state);
        (void)attractor_settle(&s, state, seconds, &a);
    }
    rows_number(kept ? "fig 9, one mode kept, Hz" : "fig 9, Hz", hz);
    rows_number("  period, 0: none", a.period);
    rows_number("  largest x1, mm", a.high[0] * mm);
    rows_number("  switches in a period", a.switches);
    rows_number("  share of time in contact", 1.0 - a.loss);
    rows_number("  Lyapunov exponent, 1/s",
                kept ? attractor_exponent(&s, a.state, false, (int)(average * hz))
                     : attractor_mean_exponent(&s, paper[SHAFT_G1], average, 40, &counted));
    if (!kept)
        rows_number("    mean of so many starts", counted);
    attractor_close(&s);
    history_sample(figure, name, model, paper, &a, 5, 1);
    snprintf(section, sizeof section, "%s ", name);
    draw_section(figure, section, model, paper, &a, a.period ? a.period : (int)fmin(average * hz, 400.0));
}

static void draw_quiet(const char *figure, const double *paper)
{
    struct attractor a;
    struct attractor_shaft s;
    if (!attractor_open(&s, &shaft_bearing, paper))
        return;
    if (attractor_settle(&s, NULL, 60.0, &a) && a.period == 1) {
        history_sample(figure, "quiet", &shaft_bearing, paper, &a, 5, 1);
        draw_section(figure, "quiet ", &shaft_bearing, paper, &a, 1);
        rows_number("  the quiet motion beside it: largest x1, mm", a.high[0] * mm);
    }
    attractor_close(&s);
}

static void draw_chaos(const char *figure, double hz, double seconds, double average, int mode)
{
    double paper[MODEL_PARAMETERS], amplitude[3];
    attractor_paper(SHAFT_HARD, hz, paper);
    paper[SHAFT_PAPER_MODE] = mode;
    draw_impacting(figure, "true", &shaft_bearing, paper, seconds, average);
    draw_quiet(figure, paper);
    for (double wait = 1.0; wait <= 16.0; wait *= 4.0) {
        rows_number("  seconds", wait);
        rows_number("  share of starts that still impact", survival_share(paper, wait, 40));
    }
    draw_impacting(figure, "mode", &shaft_bearing_mode, paper, 20.0, 10.0);
    for (double wait = 1.0; wait <= 16.0; wait *= 4.0) {
        rows_number("  seconds", wait);
        rows_number("  share of starts that still impact", survival_share_mode(paper, mode, wait, 40));
    }
    struct one_mode averaged = one_mode_of(paper, mode);
    int n = one_mode_amplitudes(&averaged, hz, amplitude);
    for (int i = 0; i < n; i++)
        rows_number("  averaged: amplitude, mm", amplitude[i] * mm);
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
        r.paper[SHAFT_PAPER_MODE] = 1;
        response_theory(&r, "theory");
        response_balance(&r, "balance");
        response_attractors(&r, &shaft_bearing, "true", NULL, NULL);
        response_attractors(&r, &shaft_bearing_mode, "mode", NULL, NULL);
        for (int k = 0; k < 3; k++) {
            double paper[MODEL_PARAMETERS];
            damp(hz[k], proportional, paper);
            paper[SHAFT_PAPER_MODE] = 1;
            snprintf(figure, sizeof figure, "18 C%d %g", proportional + 1, hz[k]);
            history_draw(figure, &shaft_bearing, paper, 24, 1);
            history_draw(figure, &shaft_bearing_mode, paper, 24, 1);
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

enum { HARMONICS = 400, FITTED = 19 };

/* Amplitudes of the harmonics of x1, over whole periods. */
static bool find_harmonics(const struct model *model, const double *paper, const struct attractor *a,
                           double *amplitude)
{
    enum { PERIODS = 20 };
    double complex line[HARMONICS + 1] = {0.0};
    double state[MODEL_STATES];
    int ticks = history_ticks(paper);
    bool good = history_start(&m, model, paper, a);
    for (int i = 0; i < PERIODS * ticks && good; i++) {
        history_state(&m, state);
        double complex turn = cexp(-(double complex)I * MOTION_TWO_PI * (i % ticks) / ticks), power = 1.0;
        for (int k = 1; k <= HARMONICS; k++) {
            power *= turn;
            line[k] += state[0] * power * 2.0 / (PERIODS * ticks);
        }
        good = plant_run(&m.pl, 1);
    }
    for (int k = 1; k <= HARMONICS; k++)
        amplitude[k] = cabs(line[k]);
    return good;
}

/* The chattering motion (figure 19) of the shaft, or of translation alone. */
static void draw_chatter(const char *name, const struct model *model)
{
    double paper[MODEL_PARAMETERS], x[FITTED], y[FITTED], line[HARMONICS + 1];
    struct attractor_shaft s;
    struct attractor a;
    char curve[32];
    damp(5.0, false, paper);
    paper[SHAFT_PAPER_MODE] = 1;
    if (!attractor_open(&s, model, paper))
        return;
    bool good = attractor_settle(&s, NULL, 2.0, &a);
    double exponent = good ? attractor_exponent(&s, a.state, false, 100) : (double)NAN;
    attractor_close(&s);
    if (!good || !find_harmonics(model, paper, &a, line))
        return;
    rows_number(model == &shaft_bearing ? "fig 19, c = 139, 5 Hz: switches in a period"
                                        : "fig 19, one mode kept",
                a.switches);
    rows_number("  share of time in contact", 1.0 - a.loss);
    rows_number("  Lyapunov exponent, 1/s", exponent);
    snprintf(curve, sizeof curve, "%s ", name);
    draw_section("19", curve, model, paper, &a, 300);
    history_sample("19", name, model, paper, &a, 1, 1);
    snprintf(curve, sizeof curve, "%s harmonics", name);
    for (int k = 1; k <= HARMONICS; k += 2) {
        if (k < 40 || k % 8 == 1)
            rows_point("19", curve, 5.0 * k, line[k] * mm);
        if (k >= 3 && k <= 39) {
            x[(k - 3) / 2] = k;
            y[(k - 3) / 2] = line[k];
        }
    }
    rows_break();
    rows_number("  slope of the harmonics, 15 to 195 Hz", slope(x, y, FITTED));
}

int main(void)
{
    rows_print_header();
    draw_chaos("9 25", 25.0, 2.0, 20.0, 1);
    draw_chaos("9 80", 80.0, 1.0, 1.2, 1);
    draw_chaos("9 700", 700.0, 0.5, 4.0, 3);
    draw_damped();
    draw_chatter("true", &shaft_bearing);
    draw_chatter("mode", &shaft_bearing_mode);
    return 0;
}
