/* history.c - see history.h. */
#include "tests/papers/history.h"

#include <math.h>
#include <stdio.h>
#include "tests/papers/one_mode.h"
#include "tests/papers/rows.h"

enum { POINTS = 120 /* in a period */, FINER = 4 /* than the method needs */, ATTRACTORS = 4 };
static const double mm = 1e3, same = 0.006;

int history_ticks(const double *paper)
{
    return FINER * attractor_ticks(paper);
}

bool history_start(struct motion *m, const struct model *model, const double *paper,
                   const struct attractor *a)
{
    double tick = 1.0 / (paper[SHAFT_PAPER_HZ] * history_ticks(paper));
    return motion_start(m, model, paper, tick, 0.0, a->state) == NULL;
}

void history_state(const struct motion *m, double *state)
{
    const struct plant *pl = &m->pl;
    double full[MODEL_STATES];
    if (pl->model == &shaft_bearing) {
        motion_state(m, state);
        return;
    }
    pl->model->climb(pl->p, pl->x, full);
    shaft_bearing.paper_state(pl->p, pl->segment.at[2], full, state);
}

void history_sample(const char *figure, const char *name, const struct model *model, const double *paper,
                    const struct attractor *a, int periods, int n_coordinates)
{
    static struct motion m;
    int ticks = history_ticks(paper), every = ticks / POINTS + 1;
    double state[MODEL_STATES], ms = 1e3 / (paper[SHAFT_PAPER_HZ] * ticks);
    char of[48];
    for (int k = 0; k < n_coordinates; k++) {
        snprintf(of, sizeof of, "%s x%d", figure, k + 1);
        if (!history_start(&m, model, paper, a))
            return;
        for (int i = 0; i <= periods * ticks; i++) {
            history_state(&m, state);
            if (i % every == 0)
                rows_point(of, name, i * ms, state[k] * mm);
            if (!plant_run(&m.pl, 1))
                return;
        }
        rows_break();
    }
}

static void tell(const char *figure, const char *curve, const struct attractor *a)
{
    char name[96];
    snprintf(name, sizeof name, "fig %s, %s (period %d): largest x1, mm", figure, curve, a->period);
    rows_number(name, a->high[0] * mm);
    rows_number("  lowest x1, mm", a->low[0] * mm);
    rows_number("  largest x2, mm", a->high[1] * mm);
    rows_number("  lowest x2, mm", a->low[1] * mm);
    rows_number("  largest x3, mm", a->high[2] * mm);
    rows_number("  switches in a period", a->switches);
    rows_number("  share of time in contact", 1.0 - a->loss);
}

void history_draw(const char *figure, const struct model *model, const double *paper, int starts,
                  int n_coordinates)
{
    uint64_t seed = 3;
    bool kept = model != &shaft_bearing;
    struct attractor_shaft s;
    struct attractor a;
    double state[MODEL_STATES], seen[ATTRACTORS][2];
    int n = 0;
    char name[32];
    if (!attractor_open(&s, model, paper))
        return;
    for (int k = 0; k < starts && n < ATTRACTORS; k++) {
        bool known = false;
        (kept ? one_mode_start : attractor_start)(&seed, paper[SHAFT_G1], state);
        if (!attractor_settle(&s, state, 16.0, &a))
            continue;
        for (int j = 0; j < n; j++)
            known = known || (fabs(seen[j][0] - a.high[0]) < same * a.high[0] &&
                              fabs(seen[j][1] - a.low[0]) < same * a.high[0]);
        if (known)
            continue;
        seen[n][0] = a.high[0];
        seen[n++][1] = a.low[0];
        snprintf(name, sizeof name, "%s %d", kept ? "mode" : "attractor", n);
        tell(figure, name, &a);
        history_sample(figure, name, model, paper, &a, 2, n_coordinates);
    }
    attractor_close(&s);
}
