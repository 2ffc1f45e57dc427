/* taylor.c - power series of fixed order for one Hertzian contact or a polynomial restoring force.
 *
 * The series are in time where contact is kept, lost or does not exist. Close to a switch they are in
 * regularised variables, in which the motion is analytic through the switch: the order stays, where methods
 * in time fall to 2.5. A series reaches as far as its last two terms stay below the tolerance. It is read
 * over all steps within that reach while the inputs only run on. Where inputs change, or where a series would
 * reach less than four steps, a short one serves a single step (taylor_short.c).
 *
 * Error: about the tolerance times the size of the motion (taylor_size.c), independent of the step. Cost at 4
 * GHz (make bench): 130 ns a series in time, 280 ns one in regularised variables, 40 ns a short one. */
#include "firmware/method/taylor/taylor.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_piece.h"
#include "firmware/method/taylor/taylor_short.h"
#include "firmware/method/taylor/taylor_short_cubic.h"
#include "firmware/method/taylor/taylor_size.h"
#include "models/math/elementary.h"

enum {
    PIECES = 32,  /* series per call; one switch needs about 6 */
    FALLBACK = 64 /* steps of rk4 for what is left when the budget ends and the end must be reached */
};

STATIC_ASSERT(sizeof(struct taylor) / sizeof(double) <= METHOD_SCRATCH, taylor_fits);

/* shift_at where inputs shift the coordinate: those in `moving`. */
NEVER_INLINE struct input shift_by(const struct taylor *t, const struct segment *e, unsigned moving, double s)
{
    struct input shift = {t->origin, 0.0}, u;
    for (int i = 0; moving != 0; i++, moving >>= 1) {
        if (!(moving & 1u))
            continue;
        if (s == 0.0 || s == e->length)
            u = e->at[s == 0.0 ? 0 : 2][i];
        else
            wave_at(&e->wave[i], s, &u);
        shift.value += t->shift[i] * u.value;
        shift.rate += t->shift[i] * u.rate;
    }
    return shift;
}

/* eta - side x[0] at s after the start of e, with its rate. */
ALWAYS_INLINE struct input shift_at(const struct taylor *t, const struct segment *e, double s)
{
    unsigned moving = e->active & t->shifting;
    return moving != 0 ? shift_by(t, e, moving, s) : (struct input){t->origin, 0.0};
}

ALWAYS_INLINE void hand_out(struct taylor *t, const struct segment *e, double s, double *x)
{
    struct input shift = shift_at(t, e, s);
    x[0] = t->x[0] = t->side * (t->eta - shift.value);
    x[1] = t->x[1] = t->side * (t->rate - shift.rate);
}

static void take_in(struct taylor *t, const struct segment *e, const double *x)
{
    struct input shift = shift_at(t, e, 0.0);
    t->eta = t->side * x[0] + shift.value;
    t->rate = t->side * x[1] + shift.rate;
    /* Zero to rounding: the contact has just switched. */
    if (fabs(t->eta) <= 8.0 * DBL_EPSILON * (1.0 + fabs(shift.value)))
        t->eta = 0.0;
    t->root = -1.0;
    t->kind = TAYLOR_NONE;
}

/* The rest of a segment whose end must be reached although the budget is spent: small steps of rk4. */
static enum step_status run_through(struct taylor *t, const struct model *m, const double *p,
                                    const struct segment *e, double done, double *x)
{
    struct segment rest = *e, head;
    struct crossing c;
    step_function *step = rk4.bind(m);
    enum step_status status = STEP_END;
    hand_out(t, e, done, x);
    t->kind = TAYLOR_NONE;
    segment_tail(&rest, m->n_inputs, done);
    for (int left = FALLBACK; left > 0 && status == STEP_END; left--) {
        double length = rest.length / left;
        segment_head(&rest, m->n_inputs, length, &head);
        status = step(m, p, NULL, &head, REGIME_ANY, x, &c);
        segment_tail(&rest, m->n_inputs, length);
    }
    return status;
}

/* A step from a state that was taken in; `any`: it runs through switches. */
static enum step_status run(struct taylor *t, const struct segment *e, bool any, double *x,
                            struct crossing *c)
{
    struct taylor_load load;
    double done = 0.0, moved = -1.0; /* moved: where the load stands */
    for (int i = 0; i < PIECES; i++) {
        double left = e->length - done;
        if (t->kind == TAYLOR_NONE) {
            if (done > 0.0)
                hand_out(t, e, done, x);
            taylor_measure(t, x); /* where series begin, so that it does not depend on the ticks */
            if (moved < 0.0)
                taylor_load_begin(&load, &t->lanes, e);
            if (done > 0.0)
                taylor_load_move(&load, moved < 0.0 ? done : done - moved);
            moved = done;
            if (!taylor_begin(t, &load, left, e->changed))
                return STEP_NOT_FINITE;
        }
        double valid = t->end - t->now;
        if (valid > left || (valid == left && !t->event)) {
            t->now += left;
            taylor_read(t);
            hand_out(t, e, e->length, x);
            return STEP_END;
        }
        done += valid;
        bool event = t->event, residual = t->residual;
        t->brief = taylor_is_brief(t, e);
        taylor_finish(t);
        if (!event || any)
            continue;
        hand_out(t, e, done, x);
        *c = (struct crossing){done, 0, residual, 0.0};
        return STEP_SWITCH;
    }
    c->done = done;
    hand_out(t, e, done, x);
    return STEP_BUDGET;
}

static enum step_status step(const struct model *m, const double *p, double *scratch, const struct segment *e,
                             unsigned regime, double *x, struct crossing *c)
{
    struct taylor *t = (struct taylor *)(void *)scratch;
    bool any = (regime & REGIME_ANY) != 0;
    bool closed = (regime & 1u) || !t->contact;
    bool put = t->x[0] != x[0] || t->x[1] != x[1];
    if (any || e->changed || t->closed != closed || put)
        take_in(t, e, x);
    if (put)
        taylor_begin_motion(t, m, p, e, x);
    t->closed = closed;
    bool new = e->changed || (t->brief && !(t->kind != TAYLOR_NONE && t->end - t->now >= e->length));
    if (new)
        taylor_measure(t, x);
    if (new && !any && (t->contact ? taylor_short(t, e) : taylor_short_cubic(t, e))) {
        hand_out(t, e, e->length, x);
        return STEP_END;
    }
    if (any && t->contact)
        t->closed = t->eta > 0.0 || (t->eta == 0.0 && t->rate >= 0.0);
    enum step_status status = run(t, e, any, x, c);
    if (status == STEP_BUDGET && any)
        status = run_through(t, m, p, e, c->done, x);
    if (status == STEP_NOT_FINITE)
        t->x[0] = t->x[1] = DBL_MAX; /* nothing to go on from */
    return status;
}

static size_t n_scratch(const struct model *m)
{
    (void)m;
    return sizeof(struct taylor) / sizeof(double);
}

/* The tolerance that is kept where this one is allowed. */
static double tolerance_of(double tol)
{
    if (tol == 0.0)
        return METHOD_TOL_DEFAULT;
    return tol < TAYLOR_TOL_MOST ? tol : TAYLOR_TOL_MOST;
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    if (!m->hertz_form && !m->polynomial_form)
        return "taylor has no series for this model: it needs one Hertzian contact or a polynomial force";
    if (tol != 0.0 && !(tol >= METHOD_TOL_MIN && tol <= METHOD_TOL_MAX))
        return "taylor: tolerance outside 1e-13..0.1";
    tol = tolerance_of(tol);
    double rate = m->eigenfrequency(p);
    if (!(h * rate <= 2.0 * PIECES * exponential(logarithm(tol) / TAYLOR_ORDER)))
        return "step too long for taylor: it would take more series than the budget of one step";
    return NULL;
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    struct taylor *t = (struct taylor *)(void *)scratch;
    struct hertz_form form;
    double rest[MODEL_STATES];
    (void)h;
    memset(t, 0, sizeof *t);
    m->rest(p, rest);
    t->tol = tolerance_of(tol);
    t->log2_tol = logarithm(t->tol) * 1.4426950408889634;
    t->rest = rest[0];
    t->rate_scale = m->eigenfrequency(p);
    t->side = 1.0;
    t->x[0] = DBL_MAX;
    taylor_lanes_of(m, p, &t->lanes);
    t->contact = m->hertz_form != NULL;
    t->escapes = !m->hertz_form || t->lanes.base[1] < 0.0;
    if (!m->hertz_form)
        return;
    m->hertz_form(p, &form);
    t->side = form.side;
    t->origin = form.origin;
    memcpy(t->shift, form.shift, sizeof t->shift);
    for (int i = 0; i < MODEL_INPUTS; i++)
        t->shifting |= form.shift[i] != 0.0 ? 1u << i : 0u;
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return step;
}

const struct method taylor = {
    .name = "taylor",
    .title = "power series, order and tolerance fixed, the contact in regularised variables",
    .order = 0,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
};
