/* shaft_hard.c - figure 8 of the shaft-bearing paper: responses with hard contact at three forces, and at 25
 * N the branch of period 1 and the model of one mode. Prints docs/img/papers/shaft_hard.csv. */
#include <stdio.h>
#include "models/reduced/shaft_mode.h"
#include "tests/papers/response.h"
#include "tests/papers/rows.h"

static void draw_band(const char *figure, double from, double to, int points, int mode)
{
    static const double force[] = {15.0, 25.0, 35.0};
    char name[32];
    for (int k = 0; k < 3; k++) {
        struct response r = {.figure = figure,
                             .from = from,
                             .to = to,
                             .points = points,
                             .starts = 4,
                             .span = 2.54e-4,
                             .seconds = 3.0,
                             .n_coordinates = 3};
        attractor_paper(SHAFT_HARD, 25.0, r.paper);
        r.paper[SHAFT_PAPER_P1 + 1] = force[k];
        r.paper[SHAFT_PAPER_MODE] = mode;
        snprintf(name, sizeof name, "theory %g", force[k]);
        response_theory(&r, name);
        snprintf(name, sizeof name, "true %g", force[k]);
        response_attractors(&r, &shaft_bearing, name, NULL, NULL);
        snprintf(name, sizeof name, "mode %g", force[k]);
        if (k != 1)
            continue;
        response_attractors(&r, &shaft_bearing_mode, name, NULL, NULL);
        response_balance(&r, "balance");
    }
}

static void draw_branch(const char *figure, double from, double to, int ticks, double step)
{
    static struct branch_point point[BRANCH_POINTS];
    struct branch b = {.model = &shaft_bearing,
                       .swept = SHAFT_PAPER_HZ,
                       .turn = 1.0,
                       .unit = 10.0,
                       .ticks = ticks,
                       .from = from,
                       .to = to,
                       .step = step};
    attractor_paper(SHAFT_HARD, from, b.paper);
    response_branch(figure, "branch", point, branch_follow(&b, point));
}

int main(void)
{
    rows_print_header();
    draw_band("8 low", 1.0, 150.0, 74, 1);
    draw_band("8 high", 650.0, 750.0, 50, 3);
    draw_branch("8 low x1", 100.0, 2.0, 512, 0.3);
    draw_branch("8 high x1", 650.0, 750.0, 16, 0.1);
    draw_branch("8 high x1", 750.0, 650.0, 16, 0.1);
    return 0;
}
