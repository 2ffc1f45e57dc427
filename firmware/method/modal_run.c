/* modal_run.c - many ticks of `modal` in a row, without books. */
#include "firmware/method/modal_run.h"

#include <float.h>
#include <math.h>
#include "firmware/method/modal.h"

/* The state against the base at the begin of a tick; its end is the state again. */
ALWAYS_INLINE void enter(const struct modal *s, const struct modal_tick *in, const double *y,
                         const double *rate, struct tick *t, int n)
{
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        t->q[i] = y[i] - s->form.participation[i] * in->base[0];
        t->v[i] = rate[i] - s->form.participation[i] * in->base_rate;
    }
    t->base = in->base[0];
    t->base_at[0] = in->base[0];
    t->base_at[1] = 0.5 * (in->base[0] + in->base[1]);
    t->base_at[2] = in->base[1];
    t->base_rate = (in->base[1] - in->base[0]) / s->h;
    t->peak = 0.0;
}

ALWAYS_INLINE void leave(const struct modal *s, struct modal_tick *in, const struct tick *t, double *y,
                         double *rate, int n)
{
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        y[i] = t->q[i] + s->form.participation[i] * in->base[1];
        rate[i] = t->v[i] + s->form.participation[i] * in->base_rate;
    }
    in->peak = t->peak;
}

ALWAYS_INLINE bool is_finite(const double *y, const double *rate, int n)
{
    double size = 0.0;
    MODES_UNROLL
    for (int i = 0; i < n; i++)
        size += fabs(y[i]) + fabs(rate[i]);
    return size <= DBL_MAX;
}

ALWAYS_INLINE bool run(const struct model *m, const double *p, struct modal *s, struct modal_tick *in,
                       uint32_t ticks, uint64_t first, double *x, int n)
{
    const struct tip_law *w = &s->form.law;
    struct felt felt = s->felt;
    struct tick t = {.branch = x[MODEL_MODES], .moves = true};
    double y[MODEL_MODES], rate[MODEL_MODES], half = 0.5 * s->h;
    t.side = tip_side_of(w, 0.0, t.branch);
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        y[i] = x[i];
        rate[i] = x[MODEL_MODES + 1 + i];
    }
    for (uint32_t k = 0; k < ticks; k++) {
        enter(s, &in[k], y, rate, &t, n);
        push_modes(half * in[k].force[0], &t, n);
        double gap = gap_of(s, &t, n);
        if (kicks_for(s, s->h, gap, &t, n) == 1)
            swing(m, p, w, s, s->h, &s->whole, 1, gap, &felt, &t, n, false);
        else
            swing(m, p, w, s, s->part, &s->in_part, MODAL_KICKS, gap, &felt, &t, n, false);
        push_modes(half * in[k].force[1], &t, n);
        heat(s, s->decay, s->spread, (first + k) << 16, &t, n, false);
        leave(s, &in[k], &t, y, rate, n);
    }
    s->felt = felt;
    MODES_UNROLL
    for (int i = 0; i < n; i++) {
        x[i] = y[i];
        x[MODEL_MODES + 1 + i] = rate[i];
    }
    x[MODEL_MODES] = t.branch;
    return is_finite(y, rate, n);
}

#define RUN(n)                                                                                               \
    NEVER_INLINE bool run_##n(const struct model *m, const double *p, struct modal *s,                       \
                              struct modal_tick *in, uint32_t ticks, uint64_t first, double *x)              \
    {                                                                                                        \
        return run(m, p, s, in, ticks, first, x, n);                                                         \
    }
RUN(1)
RUN(2)
RUN(3)
RUN(4)
STATIC_ASSERT(MODEL_MODES == 4, each_number_of_modes_has_its_run);

bool modal_run(const struct model *m, const double *p, double *scratch, struct modal_tick *ticks, uint32_t n,
               uint64_t first, double *x)
{
    static bool (*const of_modes[MODEL_MODES])(const struct model *, const double *, struct modal *,
                                               struct modal_tick *, uint32_t, uint64_t,
                                               double *) = {run_1, run_2, run_3, run_4};
    struct modal *s = (struct modal *)(void *)scratch;
    return of_modes[s->form.n_modes - 1](m, p, s, ticks, n, first, x);
}

void modal_change_sample(const struct model *m, const double *p, double *scratch)
{
    struct modal *s = (struct modal *)(void *)scratch;
    struct modal_form form;
    m->modal_form(p, &form);
    s->form.law = form.law;
    s->felt.known = false;
}
