/* shaft_soft.c - figures 12 and 13 of the shaft-bearing paper, kg = 2.626e4 N/m: the branch of period 1, attractors from
 * random starts by period, and histories at two superharmonics. Prints docs/papers/shaft_soft.csv. */
#include <math.h>
#include <stdio.h>
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
    response_attractors(&r, &shaft_bearing, "true", NULL, NULL);
    r.starts = 3;
    response_attractors(&r, &shaft_bearing_mode, "mode", NULL, NULL);
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
    response_theory(&r, "theory");
    response_attractors(&r, &shaft_bearing, "true", NULL, NULL);
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

int main(void)
{
    double paper[MODEL_PARAMETERS];
    rows_begin();
    draw_response();
    attractor_paper(SHAFT_SOFT, 12.47, paper);
    history_draw("13 12.47", paper, 24, 3);
    measure_unison(paper);
    attractor_paper(SHAFT_SOFT, 18.49, paper);
    history_draw("13 18.49", paper, 24, 3);
    return 0;
}
