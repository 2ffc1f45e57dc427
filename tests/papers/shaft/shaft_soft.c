/* shaft_soft.c - figures 12 and 13 of the shaft-bearing paper, kg = 2.626e4 N/m: the branch of period 1,
 * attractors from random starts by period, and histories at two superharmonics. Prints
 * docs/img/papers/shaft_soft.csv. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "models/reduced/shaft_mode.h"
#include "tests/papers/history.h"
#include "tests/papers/response.h"
#include "tests/papers/rows.h"

static void draw_response(void)
{
    static struct branch_point point[BRANCH_POINTS];
    struct response r = {.figure = "12",
                         .from = 3.0,
                         .to = 100.0,
                         .points = 194,
                         .starts = 24,
                         .span = 2.54e-4,
                         .seconds = 16.0,
                         .n_coordinates = 1};
    struct branch b = {.model = &shaft_bearing,
                       .swept = SHAFT_PAPER_HZ,
                       .turn = 1.0,
                       .unit = 10.0,
                       .ticks = 256,
                       .from = 60.0,
                       .to = 10.0,
                       .step = 0.3};
    attractor_paper(SHAFT_SOFT, b.from, r.paper);
    attractor_paper(SHAFT_SOFT, b.from, b.paper);
    r.paper[SHAFT_PAPER_MODE] = 1;
    response_theory(&r, "theory");
    /* Above 40 Hz the motions of longer periods have small basins. */
    r.to = 40.0;
    r.points = 74;
    response_attractors(&r, &shaft_bearing, "true", NULL, NULL);
    r.from = 40.5;
    r.to = 100.0;
    r.points = 119;
    r.starts = 200;
    response_attractors(&r, &shaft_bearing, "true", NULL, NULL);
    r.from = 3.0;
    r.points = 194;
    r.starts = 24;
    response_attractors(&r, &shaft_bearing_mode, "mode", NULL, NULL);
    response_balance(&r, "balance");
    response_branch("12 x1", "branch", point, branch_follow(&b, point));
    /* The enlarged part: all three coordinates. */
    r = (struct response){.figure = "12 zoom",
                          .from = 5.0,
                          .to = 21.0,
                          .points = 128,
                          .starts = 10,
                          .span = 2.54e-4,
                          .seconds = 12.0,
                          .n_coordinates = 3};
    attractor_paper(SHAFT_SOFT, b.from, r.paper);
    r.paper[SHAFT_PAPER_MODE] = 1;
    response_theory(&r, "theory");
    response_attractors(&r, &shaft_bearing, "true", NULL, NULL);
    response_attractors(&r, &shaft_bearing_mode, "mode", NULL, NULL);
}

/* How long the unison of x1 and x3 at 12.47 Hz stays, started from rest: it is exact there. */
static void measure_unison(const double *paper)
{
    struct attractor_shaft s;
    struct attractor a;
    if (!attractor_open(&s, &shaft_bearing, paper))
        return;
    for (double wait = 0.5; wait <= 16.0; wait *= 2.0) {
        if (!attractor_settle(&s, NULL, wait, &a))
            break;
        rows_number("fig 13, 12.47 Hz, from rest: seconds", wait);
        rows_number("  largest x1, mm", a.high[0] * 1e3);
        rows_number("  largest x3 - largest x1, mm", (a.high[2] - a.high[0]) * 1e3);
    }
    attractor_close(&s);
}

/* The superharmonics of the second mode, near 18, 8 and 6 Hz: x1 and x3 differ, x2 is symmetric in time. */
static void tell_pairs(void)
{
    static const double hz[] = {18.49, 7.6, 6.1};
    double paper[MODEL_PARAMETERS], state[MODEL_STATES];
    uint64_t seed = 1;
    for (int i = 0; i < 3; i++) {
        struct attractor_shaft s;
        struct attractor a;
        attractor_paper(SHAFT_SOFT, hz[i], paper);
        attractor_start(&seed, paper[SHAFT_G1], state);
        if (!attractor_open(&s, &shaft_bearing, paper))
            continue;
        if (attractor_settle(&s, state, 30.0, &a)) {
            rows_number("superharmonic pair, Hz", hz[i]);
            rows_number("  period", a.period);
            rows_number("  largest x1, mm", a.high[0] * 1e3);
            rows_number("  largest x3, mm", a.high[2] * 1e3);
            rows_number("  largest and lowest x2 together, mm", (a.high[1] + a.low[1]) * 1e3);
        }
        attractor_close(&s);
    }
}

/* Where x1 is largest of the motions that `starts` lead to between two frequencies, in so many steps. */
static void tell_peak(const char *what, const double *nominal, double from, double to, int steps, int starts)
{
    double paper[MODEL_PARAMETERS], state[MODEL_STATES], best = 0.0, at = 0.0;
    uint64_t seed = 3;
    memcpy(paper, nominal, sizeof paper);
    for (int i = 0; i <= steps; i++) {
        struct attractor_shaft s;
        struct attractor a;
        paper[SHAFT_PAPER_HZ] = from + (to - from) * i / steps;
        if (!attractor_open(&s, &shaft_bearing, paper))
            continue;
        for (int k = 0; k < starts; k++) {
            attractor_start(&seed, paper[SHAFT_G1], state);
            if (attractor_settle(&s, k ? state : NULL, 10.0, &a) && a.high[0] > best) {
                best = a.high[0];
                at = paper[SHAFT_PAPER_HZ];
            }
        }
        attractor_close(&s);
    }
    rows_number(what, at);
    rows_number("  x1, mm", best * 1e3);
}

/* Figures 11 and 20: peaks with softer springs, and with one support weak or gone. */
static void tell_peaks(void)
{
    static const double support[] = {8030.0, 4015.0, 0.0};
    double paper[MODEL_PARAMETERS];
    for (int i = 0; i < 3; i++) {
        attractor_paper(SHAFT_SOFT, 25.0, paper);
        paper[SHAFT_KS3] = support[i];
        rows_number("fig 20, soft, ks3", support[i]);
        tell_peak("  first peak, Hz", paper, 22.0, 33.0, 110, 4);
        tell_peak("  second peak, Hz", paper, 34.5, 45.0, 42, 4);
    }
    attractor_paper(1e3, 25.0, paper);
    tell_peak("fig 11, kg = 1e3: peak, Hz", paper, 17.0, 23.0, 24, 1);
    attractor_paper(1e5, 700.0, paper);
    tell_peak("fig 11, kg = 1e5: high peak from rest, Hz", paper, 695.0, 705.0, 100, 1);
    attractor_paper(SHAFT_MID, 700.0, paper);
    tell_peak("fig 11, kg = 1.4e6: high peak from rest, Hz", paper, 695.0, 705.0, 100, 1);
}

int main(void)
{
    double paper[MODEL_PARAMETERS];
    rows_print_header();
    draw_response();
    attractor_paper(SHAFT_SOFT, 12.47, paper);
    paper[SHAFT_PAPER_MODE] = 1;
    history_draw("13 12.47", &shaft_bearing, paper, 24, 3);
    history_draw("13 12.47", &shaft_bearing_mode, paper, 24, 3);
    measure_unison(paper);
    attractor_paper(SHAFT_SOFT, 18.49, paper);
    paper[SHAFT_PAPER_MODE] = 1;
    history_draw("13 18.49", &shaft_bearing, paper, 24, 3);
    history_draw("13 18.49", &shaft_bearing_mode, paper, 24, 3);
    tell_pairs();
    tell_peaks();
    return 0;
}
