/* any_plant.h - a plant of any model in any state, under any method that keeps to method.h: what the method
 * returns and writes is unknown. State and inputs are any double, NaN and infinities among them, parameters
 * any inside their ranges. */
#ifndef TESTS_EVA_ANY_PLANT_H
#define TESTS_EVA_ANY_PLANT_H

#include "firmware/plant/plant.c"

#include "models/models.h"
#include "tests/eva/angles.h"
#include "tests/eva/any_drive.h"

static uint32_t steps; /* steps of the method in this segment */

/* The method's side of the seam, of one that stops at a switch (crossing.early
 * is 0). It may even break REGIME_ANY's promise to run through. */
static enum step_status any_step(const struct model *m, const double *p, double *scratch,
                                 const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    (void)p, (void)scratch, (void)e, (void)regime;
    steps++;
    /*@ assert pieces_are_bounded: steps <= PLANT_PIECES; */
    eva_any(x, (size_t)m->n_states * sizeof *x);
    c->done = eva_between(0.0, 1.0); /* in ticks, see any_plant */
    c->residual = eva_bool();
    if (m->n_contacts == 0)
        return eva_bool() ? STEP_END : eva_bool() ? STEP_BUDGET : STEP_NOT_FINITE;
    c->contact = Frama_C_interval(0, m->n_contacts - 1);
    return (enum step_status)Frama_C_interval(STEP_END, STEP_NOT_FINITE);
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    (void)m, (void)p, (void)h, (void)tol;
    return eva_bool() ? "a reason" : NULL;
}

static void prepare_nothing(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    (void)m, (void)p, (void)h, (void)tol, (void)scratch;
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return any_step;
}

static size_t n_scratch(const struct model *m)
{
    (void)m;
    return eva_bool();
}

static const struct method_books *books(const double *scratch)
{
    static struct method_books any;
    (void)scratch;
    eva_any(&any, sizeof any);
    return &any;
}

static const struct method any_method = {
    .n_scratch = n_scratch, .refuse = refuse, .prepare = prepare_nothing, .bind = bind, .books = books};

static struct plant pl;
static double event_x[PLANT_EVENTS][MODEL_STATES];

static void any_segment(struct segment *e, int n_inputs)
{
    eva_any(e, sizeof *e);
    e->active = eva_uint(0, (1u << n_inputs) - 1);
    e->changed = eva_bool();
}

static void any_events(struct plant *p)
{
    p->event_x = eva_bool() ? event_x : NULL;
    p->n_event = eva_uint(0, PLANT_EVENTS);
    p->event_head = eva_uint(0, PLANT_EVENTS - 1);
    /*@ loop unroll PLANT_EVENTS; */
    for (int i = 0; i < PLANT_EVENTS; i++) {
        p->event[i].touch = eva_bool();
        p->event[i].fraction = eva_between(0.0, PLANT_PIECES + 1.0);
    }
}

static void any_plant(const struct model *m)
{
    eva_any(&pl, sizeof pl);
    pl.model = m;
    pl.method = &any_method;
    pl.step = any_step;
    pl.bind_run = NULL;
    pl.event_x = NULL;
    pl.h = pl.ticks_per_time = 1.0; /* times in ticks: both only scale */
    pl.force = eva_bool();
    pl.staged = false; /* actuators and sensors stand outside of these proofs */
    pl.stage_calls = NULL;
    pl.stages = NULL;
    pl.books = (enum plant_books)Frama_C_interval(BOOKS_OF_LEDGER, BOOKS_NONE);
    /*@ loop unroll MODEL_PARAMETERS; */
    for (int i = 0; i < m->n_parameters; i++)
        pl.si[i] = eva_between(m->parameter[i].min, m->parameter[i].max);
    m->prepare(pl.si, pl.p, &pl.scale);
    ledger_bind(&pl.ledger, m);
    pl.ledger.flow_valid = eva_bool();
    pl.ledger.open.goes_on = eva_bool();
    any_segment(&pl.segment, m->n_inputs);
    for (int i = 0; i < MODEL_INPUTS; i++)
        any_drive(&pl.drive[i]);
    pl.awake = eva_uint(0, (1u << MODEL_INPUTS) - 1);
    pl.now.fraction = eva_uint(0, TICK_FRACTIONS - 1);
    any_events(&pl);
    pl.counts.pieces_max = eva_uint(0, PLANT_PIECES);
    steps = 0;
}

static void invariants_hold(void)
{
    /*@ assert events_fit: pl.n_event <= PLANT_EVENTS; */
    /*@ assert head_is_inside: pl.event_head < PLANT_EVENTS; */
    /*@ assert pieces_max_is_true: pl.counts.pieces_max <= PLANT_PIECES; */
    for (int i = 0; i < PLANT_EVENTS; i++)
        ASSERT(seam_event(&pl.event[i]));
}

#endif
