/* kirrou_paper.c - see kirrou_paper.h. */
#include "tests/papers/tip/kirrou_paper.h"

#include <math.h>
#include <string.h>
#include "models/reduced/afm_tip_reduced.h"
#include "tests/fixture/paper.h"
#include "tests/papers/rows.h"

void kirrou_paper(double beta, double r, double fast, double f, double *paper)
{
    paper_defaults(&afm_tip, paper);
    paper[TIP_PAPER_BETA] = beta;
    paper[TIP_PAPER_R] = r;
    paper[TIP_PAPER_FAST_OMEGA] = fast;
    paper[TIP_PAPER_F] = f;
}

struct tip_theory kirrou_theory(double beta, double r, double fast)
{
    double paper[MODEL_PARAMETERS];
    kirrou_paper(beta, r, fast, 0.0, paper);
    struct slow s = theory_slow(&afm_tip_averaged, paper, -1.0);
    return theory_tip(&s);
}

/* One side of the backbone between two amplitudes, closer together where its slope is steep: at both ends. */
static void draw_side(const char *figure, const char *curve, const struct tip_theory *t, double f,
                      double sign, const double between[2], const double range[2])
{
    enum { PIECES = 28 };
    for (int i = 0; i <= PIECES; i++) {
        double share = 0.5 - 0.5 * cos(acos(-1.0) * i / PIECES);
        double a = between[0] + (between[1] - between[0]) * share, sigma = theory_tip_side(t, f, a, sign);
        if (sigma >= range[0] && sigma <= range[1])
            rows_point(figure, curve, sigma, a);
    }
    rows_break();
}

void kirrou_draw_theory(const char *figure, const struct tip_theory *t, double f, double from, double to)
{
    double peak, turn[2] = {0.0, 0.0}, bent = t->rho_n > 0.0 ? -1.0 : 1.0;
    const double range[2] = {from - 0.1, to + 0.1}; /* the chart clips */
    (void)theory_tip_peak(t, f, &peak);
    const double least = 0.01 * peak; /* far below what the charts show */
    draw_side(figure, "theory", t, f, -bent, (double[2]){least, peak}, range);
    if (!theory_tip_turns(t, f, turn)) {
        draw_side(figure, "theory", t, f, bent, (double[2]){least, peak}, range);
        return;
    }
    draw_side(figure, "theory", t, f, bent, (double[2]){least, turn[0]}, range);
    draw_side(figure, "theory unstable", t, f, bent, turn, range);
    draw_side(figure, "theory", t, f, bent, (double[2]){turn[1], peak}, range);
}

struct sweep kirrou_sweep(const struct model *model, const double *paper, double from, double to, int steps)
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
