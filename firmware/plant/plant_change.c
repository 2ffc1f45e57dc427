/* plant_change.c - a plant's set-up, changes of parameters while it runs, and the climb to the full model. */
#include "firmware/plant/plant_change.h"

#include <string.h>
#include "firmware/plant/plant_report.h"

const char *plant_check(const struct model *m, const double *si, int *which)
{
    for (*which = 0; *which < m->n_parameters; (*which)++) {
        const struct parameter *p = &m->parameter[*which];
        if (!(si[*which] >= p->min && si[*which] <= p->max))
            return "parameter outside its range";
    }
    *which = -1;
    return m->check(si);
}

/* Numbers derived from SI parameters. */
struct derived {
    double p[MODEL_DERIVED];
    struct scale scale;
    double h;
};

/* NULL, or why model or method refuse these parameters. */
NEVER_INLINE const char *derive(const struct plant *pl, const struct model *m, const double *si,
                                struct derived *d)
{
    int which;
    const char *why = plant_check(m, si, &which);
    if (why)
        return why;
    memset(d, 0, sizeof *d);
    m->prepare(si, d->p, &d->scale);
    d->scale.time_s *= pl->dilation;
    d->h = pl->tick_s / d->scale.time_s;
    return pl->force ? NULL : pl->method->refuse(m, d->p, d->h, pl->tol);
}

const char *plant_accepts(const struct plant *pl, const double *si)
{
    struct derived d;
    return derive(pl, pl->model, si, &d);
}

const char *plant_could_climb(const struct plant *pl, const struct model *to, const double *si)
{
    struct derived d;
    const char *why = model_climb_refused(pl->model, to);
    return why ? why : derive(pl, to, si, &d);
}

/* Derived numbers, scale, step and method tables of new parameters; a reason when they are refused. */
static const char *prepare(struct plant *pl, const double *si)
{
    struct derived d;
    const char *why = derive(pl, pl->model, si, &d);
    if (why)
        return why;
    if (si != pl->si)
        memcpy(pl->si, si, (size_t)pl->model->n_parameters * sizeof *si);
    memcpy(pl->p, d.p, sizeof d.p);
    pl->scale = d.scale;
    pl->h = d.h;
    pl->ticks_per_time = 1.0 / d.h;
    pl->method->prepare(pl->model, d.p, d.h, pl->tol, pl->scratch);
    (void)plant_find_books(pl);
    return NULL;
}

/* The method's functions for the model. */
static void bind(struct plant *pl)
{
    pl->step = pl->method->bind(pl->model);
    pl->bind_run = pl->method->bind_run;
}

const char *plant_init(struct plant *pl, const struct plant_config *c)
{
    double si[MODEL_PARAMETERS] = {0};
    if (!(c->tick_s >= 1e-12 && c->tick_s <= 1e6))
        return "tick outside 1e-12..1e6 s";
    if (!(c->dilation >= 1e-6 && c->dilation <= 1e9))
        return "dilation outside 1e-6..1e9";
    if (c->method->n_scratch(c->model) > 0 && !c->scratch)
        return "this method needs scratch memory: method->n_scratch(model) doubles";
    memset(pl, 0, sizeof *pl);
    pl->model = c->model;
    pl->method = c->method;
    pl->books = c->no_ledger ? BOOKS_NONE : BOOKS_OF_LEDGER;
    bind(pl);
    pl->scratch = c->scratch;
    pl->stage_calls = c->stage_calls;
    pl->stages = c->stages;
    pl->event_x = NULL;
    pl->tick_s = c->tick_s;
    pl->dilation = c->dilation;
    pl->tol = c->tol;
    pl->force = c->force;
    for (int i = 0; i < c->model->n_parameters; i++)
        si[i] = c->si ? c->si[i] : c->model->parameter[i].initial;
    if (c->stage_calls)
        c->stage_calls->clear(c->stages);
    const char *why = prepare(pl, si);
    if (!why)
        plant_reset(pl);
    return why;
}

/* State, inputs and books go on in SI after a change of parameters or model. Before it the scale was `old`
 * and the stored energy `before` joule. */
static void carry_over(struct plant *pl, struct scale old, double before)
{
    const struct model *m = pl->model;
    for (int i = 0; i < m->n_states; i++) {
        enum quantity q = m->state_signal[i].quantity;
        pl->x[i] *= scale_of(&old, q) / scale_of(&pl->scale, q);
    }
    for (int i = 0; i < m->n_inputs; i++) {
        enum quantity q = m->input_signal[i].quantity;
        double factor = scale_of(&old, q) / scale_of(&pl->scale, q);
        drive_rescale(&pl->drive[i], factor);
        for (int k = 0; k < 3; k++) {
            pl->segment.at[k][i].value *= factor;
            pl->segment.at[k][i].rate *= factor * pl->scale.time_s / old.time_s;
        }
    }
    pl->peak_force *= old.force_N / pl->scale.force_N;
    plant_find_regime(pl); /* a gap may be a parameter */
    pl->loss_time *= old.time_s / pl->scale.time_s;
    pl->total_time *= old.time_s / pl->scale.time_s;
    ledger_rescale(&pl->ledger, old.energy_J / pl->scale.energy_J,
                   (plant_energy(pl) - before) / pl->scale.energy_J);
}

const char *plant_change(struct plant *pl, const double *si)
{
    struct scale old = pl->scale;
    double before = plant_energy(pl);
    const char *why = prepare(pl, si);
    if (!why)
        carry_over(pl, old, before);
    return why;
}

const char *plant_promote(struct plant *pl, const struct model *to)
{
    struct scale old = pl->scale;
    double x[MODEL_STATES], before = plant_energy(pl);
    const char *why = plant_could_climb(pl, to, pl->si);
    if (why)
        return why;
    pl->model->climb(pl->p, pl->x, x);
    pl->model = to;
    bind(pl);
    ledger_bind(&pl->ledger, to);
    why = prepare(pl, pl->si);
    memcpy(pl->x, x, (size_t)to->n_states * sizeof *x);
    carry_over(pl, old, before);
    return why;
}
