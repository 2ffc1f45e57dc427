/* rk4_unlocated.c - rk4 through its contact switches: a switch is reported at the end of its step.
 *
 * The trajectory is that of the steps of rk4, to the last bit. The search for the instant, the cut of the
 * step there and their costs are left out. Order 4 in smooth motion; 2.5 across a Hertzian contact as with
 * rk4, with an error a few times larger; 2 across a gap spring, where rk4 keeps 4 (docs/why/accuracy.md). A
 * contact that closes and opens within a step is not seen. */
#include "firmware/method/method.h"

static enum step_status step(const struct model *m, const double *p, double *scratch, const struct segment *e,
                             unsigned regime, double *x, struct crossing *c)
{
    struct input gap[MODEL_CONTACTS];
    enum step_status status = STEP_END;
    if (e->length > 0.0) /* 0 is left after a switch at the end */
        status = rk4.bind(m)(m, p, scratch, e, REGIME_ANY, x, c);
    if (status != STEP_END || (regime & REGIME_ANY))
        return status;
    m->gap(p, e->at[2], x, gap);
    for (int i = 0; i < m->n_contacts; i++) {
        if ((gap[i].value < 0.0) == (((regime >> i) & 1u) != 0))
            continue;
        *c = (struct crossing){e->length, i, 0, 0.0};
        return STEP_SWITCH;
    }
    return STEP_END;
}

static size_t n_scratch(const struct model *m)
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

static void prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    (void)m, (void)p, (void)h, (void)tol, (void)scratch;
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return step;
}

const struct method rk4_unlocated = {
    .name = "rk4_unlocated",
    .title = "rk4 through contact switches, each told at its step's end; order 2 to 2.5 across them",
    .order = 4,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
};
