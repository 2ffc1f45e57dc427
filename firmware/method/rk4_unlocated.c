/* rk4_unlocated.c - rk4 that runs through its contact switches: one is told at the end of the step in which it fell.
 *
 * The trajectory is that of rk4's own steps, to the last bit; what is left out is the search for the instant, the cut of the step there
 * and its costs. Order 4 in smooth motion; across a Hertzian contact 2.5 as rk4, with an error a few times larger; across a gap
 * spring 2, where rk4 keeps 4 (docs/why/accuracy.md). A contact that closes and opens within a step is not seen. */
#include "firmware/method/method.h"

static enum step_status step(const struct model *m, const double *p, double *work, const struct segment *e,
                             unsigned regime, double *x, struct crossing *c)
{
    struct input gap[MODEL_CONTACTS];
    enum step_status status = STEP_END;
    if (e->length > 0.0) /* else what is left after a switch at the end */
        status = rk4.bind(m)(m, p, work, e, REGIME_ANY, x, c);
    if (status != STEP_END || (regime & REGIME_ANY))
        return status;
    m->gap(p, e->at[2], x, gap);
    for (int i = 0; i < m->n_contacts; i++) {
        if ((gap[i].value < 0.0) == (((regime >> i) & 1u) != 0))
            continue;
        *c = (struct crossing){e->length, i, 0};
        return STEP_SWITCH;
    }
    return STEP_END;
}

static size_t n_work(const struct model *m)
{
    (void)m;
    return 0;
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    if (m->n_contacts == 0)
        return "this model has no contact whose switches to leave unlocated; take rk4";
    return rk4.refuse(m, p, h, tol);
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *work)
{
    (void)m, (void)p, (void)h, (void)tol, (void)work;
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return step;
}

static bool runs_rk4(const double *work)
{
    (void)work;
    return true;
}

const struct method rk4_unlocated = {
    .name = "rk4_unlocated",
    .title = "rk4 through contact switches, each told at its step's end; order 2 to 2.5 across them",
    .order = 4,
    .n_work = n_work,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
    .runs_rk4 = runs_rk4,
};
