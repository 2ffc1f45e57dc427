/* kirrou_paper.c - see kirrou_paper.h. */
#include "tests/papers/kirrou_paper.h"

#include <math.h>
#include <string.h>
#include "models/afm_tip_rungs.h"
#include "tests/paper.h"
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

void kirrou_draw_theory(const char *figure, const struct tip_theory *t, double f, double from, double to)
{
    for (int rank = 0; rank < 3; rank++) {
        double last = 0.0;
        int before = 0;
        for (int i = 0; i <= KIRROU_CURVE; i++) {
            double a[3], sigma = from + (to - from) * i / KIRROU_CURVE;
            int n = theory_tip_amplitude(t, f, sigma, a);
            if (n <= rank || (n != before && fabs(a[rank] - last) > KIRROU_LEAP)) /* another branch */
                rows_break();
            before = n;
            last = n > rank ? a[rank] : 0.0;
            rows_point(figure, rank == 1 ? "theory unstable" : "theory", sigma,
                       n > rank ? last : (double)NAN);
        }
        rows_break();
    }
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
