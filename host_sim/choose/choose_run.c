/* choose_run.c - see choose_run.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/method/taylor/taylor_piece.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_ladder.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/scene/plant_of_scene.h"
#include "host_sim/scene/scene_check.h"
#include "models/afm_lever.h"
#include "models/shaft_views.h"

static const double frames_max = 2e6, lever_looks_max = 1e7;
static const double floor_of_span = 1e-6; /* in the model's unit */

/* Frames from one look at the energy balance to the next, as the bus has it. */
enum { BALANCE_EVERY = 100 };

/* Where a frame is looked at besides its end, in TICK_FRACTIONS. These are instants of plant time at any
 * number of substeps. A drive whose period is a frame or half of one does not always show the same phase
 * there. */
static const uint64_t look_at[CHOOSE_LOOKS - 1] = {TICK_FRACTIONS / 64 * 20, TICK_FRACTIONS / 64 * 41};
enum { LOOKS = 24, LOOKS_MAX = 4096 }; /* in a period of a lever, and in its frame */

const char *const choose_statistic_name[STATISTICS] = {"mean", "rms", "peak", "loss"};

struct runner {
    struct plant plant, ahead;
    size_t n_scratch;
    double near;        /* a lever's gap below which modal cuts its ticks */
    double shape[3][3]; /* a shaft's open modes */
    double scratch[METHOD_SCRATCH], scratch_ahead[METHOD_SCRATCH];
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
};

double choose_frames(const struct scene *s)
{
    return floor(ticks_in(s->over * s->dilation, s->frame_s));
}

/* Looks at the observable in a frame. A lever's contacts are short: it has 24 looks a period. */
static int looks_of(const struct scene *s)
{
    if (!s->model->modal_form)
        return CHOOSE_LOOKS;
    double turns = s->frame_s / s->dilation * s->value[LEVER_F0];
    return (int)fmin(ceil(LOOKS * fmax(turns, 1.0 / 8.0)), LOOKS_MAX);
}

/* The k-th of n looks. */
static uint64_t look_of(int k, int n)
{
    return n == CHOOSE_LOOKS ? look_at[k] : (uint64_t)(TICK_FRACTIONS * (k + 1.0 / 3.0) / n);
}

static const char *start(struct runner *o, const struct scene *s, double nudge)
{
    scenes_resolve(s, o->si, o->drive);
    const struct plant_config c = plant_config_of_scene(s, o->si, o->scratch);
    const char *why = plant_of_scene(&o->plant, &c, s, o->drive);
    if (why)
        return why;
    o->n_scratch = c.method->n_scratch(s->model);
    struct modal_form form = {.near = 0.0};
    if (s->model->modal_form)
        s->model->modal_form(o->plant.p, &form);
    o->near = form.near;
    if (choose_ladder_modal(s->model))
        shaft_open_modes(o->plant.p, o->shape);
    double x[MODEL_STATES];
    memcpy(x, o->plant.x, sizeof x);
    x[0] += nudge;
    plant_set_state(&o->plant, x);
    return NULL;
}

/* At the start of frame i: the next hold of the sweep, up to the far end and back. */
static void sweep(struct runner *o, const struct scene *s, const struct choose_sweep *w, int i, int n)
{
    int holds = 2 * w->Hz.n;
    int hold = (int)((double)i * holds / n), before = (int)((double)(i - 1) * holds / n);
    if (i > 0 && hold == before)
        return;
    int place = hold < w->Hz.n ? hold : holds - 1 - hold;
    double Hz = range_value(&w->Hz, place) / s->dilation;
    const struct harmonic *d = &o->drive[w->input];
    if (i == 0)
        plant_drive_start(&o->plant, w->input, d->amplitude, Hz, d->phase);
    else
        plant_drive(&o->plant, w->input, d->amplitude, Hz, d->phase, s->frame_s);
}

/* Compression of the contact, below 0 apart: of a full model from its gaps, of a polynomial one its
 * output. */
static double compression(const struct plant *pl)
{
    struct input gap[MODEL_CONTACTS];
    double output[MODEL_OUTPUTS], most = -HUGE_VAL;
    const struct input *u = pl->segment.at[2];
    pl->model->gap(pl->p, u, pl->x, gap);
    for (int i = 0; i < pl->model->n_contacts; i++)
        most = fmax(most, -gap[i].value);
    if (pl->model->n_contacts > 0)
        return most;
    pl->model->output(pl->p, u, pl->x, output);
    return output[2];
}

/* Widens the envelope of a reduced model by where it is, which it returns. */
static double reach(const struct plant *pl, double range[2])
{
    double output[MODEL_OUTPUTS], x = pl->x[0];
    if (!(pl->model->full && pl->model->n_contacts > 0)) { /* a mode is seen by its position */
        pl->model->output(pl->p, pl->segment.at[2], pl->x, output);
        x = output[pl->model->modal_form ? (int)LEVER_GAP : 2];
    }
    range[0] = fmin(range[0], x);
    range[1] = fmax(range[1], x);
    return x;
}

static void observe(const struct plant *pl, const struct scene *s, double shape[3][3],
                    struct choose_record *r)
{
    double output[MODEL_OUTPUTS], q[3];
    plant_output(pl, output);
    r->value[r->n_values++] = output[(int)s->observable];
    double c = compression(pl);
    r->low = fmin(r->low, c);
    r->high = fmax(r->high, c);
    if (!choose_ladder_modal(s->model))
        return;
    choose_ladder_modes(pl->p, shape, pl->x, q);
    for (int k = 0; k < 3; k++)
        r->modes[k] = fmax(r->modes[k], fabs(q[k]));
}

/* Part of a tick ahead, in TICK_FRACTIONS, by a copy: the plant itself never stops there. */
static bool look(struct runner *o, const struct scene *s, uint32_t part, struct choose_record *r)
{
    const struct instant to = {o->plant.now.tick, part};
    o->ahead = o->plant;
    o->ahead.scratch = o->scratch_ahead;
    memcpy(o->scratch_ahead, o->scratch, o->n_scratch * sizeof *o->scratch);
    if (!plant_advance(&o->ahead, to))
        return false;
    observe(&o->ahead, s, o->shape, r);
    return true;
}

/* Ticks of a frame, each looked at in a reduced model: as a watch sees them. A lever's ticks near the sample
 * are counted. */
static bool go_ticks(struct runner *o, uint64_t ticks, struct choose_record *r)
{
    struct plant *pl = &o->plant;
    if (!pl->model->full && !pl->model->modal_form)
        return plant_run(pl, ticks);
    double now = reach(pl, r->reach);
    for (uint64_t i = 0; i < ticks; i++) {
        double before = now;
        if (!plant_run(pl, 1))
            return false;
        now = reach(pl, r->reach);
        r->series.near += fmin(before, now) < o->near;
    }
    return true;
}

/* As go_ticks, by the clock. */
static bool go_to(struct runner *o, uint64_t tick, struct choose_record *r)
{
    double begin_s = clock_now_s();
    bool good = go_ticks(o, tick - o->plant.now.tick, r);
    r->ns += (clock_now_s() - begin_s) * 1e9;
    return good;
}

static bool go_frame(struct runner *o, const struct scene *s, struct choose_record *r)
{
    uint64_t begin = o->plant.now.tick;
    for (int k = 0; k < r->looks - 1; k++) {
        uint64_t fractions = look_of(k, r->looks) * (uint64_t)s->substeps;
        if (!go_to(o, begin + fractions / TICK_FRACTIONS, r) ||
            !look(o, s, (uint32_t)(fractions % TICK_FRACTIONS), r))
            return false;
    }
    if (!go_to(o, begin + (uint64_t)s->substeps, r))
        return false;
    observe(&o->plant, s, o->shape, r);
    r->n++;
    return true;
}

/* The series of taylor, per step, and a lever's ticks near the sample. */
static void count_series(const struct runner *o, double steps, struct choose_series *n)
{
    n->near /= steps;
    if (o->plant.method != &taylor)
        return;
    const struct taylor_tally *made = &((const struct taylor *)(const void *)o->scratch)->count;
    *n = (struct choose_series){.time = (double)made->time / steps,
                                .regular = (double)made->regular / steps,
                                .brief = (double)made->brief / steps,
                                .further = (double)made->further / steps};
}

/* Whether the last frame's values differ too much from those of the run beside it. */
static bool parts(const struct choose_record *r, const struct choose_beside *beside)
{
    const struct choose_record *other = beside->record;
    bool parted = false;
    for (int i = r->n_values - r->looks; i < r->n_values && i < other->n_values; i++)
        parted = parted || fabs(r->value[i] - other->value[i]) > beside->most;
    return parted;
}

static void go(struct runner *o, const struct scene *s, const struct choose_sweep *w,
               const struct choose_beside *beside, struct choose_record *r)
{
    double residual_J = 0.0;
    for (int i = 0; i < r->wanted && !r->trouble; i++) {
        if (w && w->Hz.n > 0)
            sweep(o, s, w, i, r->wanted);
        if (!go_frame(o, s, r))
            r->trouble = "the motion escapes";
        if (r->n % BALANCE_EVERY == 0 || r->n == r->wanted)
            r->imbalance = fmax(r->imbalance, plant_imbalance(&o->plant, &residual_J));
        if (o->plant.counts.budget || o->plant.counts.residual)
            r->trouble = "a contact switch was not located";
        r->is_apart = beside && !r->trouble && parts(r, beside);
        if (r->is_apart)
            r->trouble = "it parts from the run beside it";
    }
    double steps = fmax(r->n, 1.0) * s->substeps;
    r->ns /= steps;
    count_series(o, steps, &r->series);
    r->switches = o->plant.counts.switches;
    r->loss = o->plant.total_time > 0.0 ? o->plant.loss_time / o->plant.total_time : 0.0;
}

static const char *run(const struct scene *s, const struct choose_sweep *w, double nudge,
                       const struct choose_beside *beside, struct choose_record *r)
{
    double n = choose_frames(s);
    *r = (struct choose_record){.low = HUGE_VAL, .high = -HUGE_VAL, .reach = {HUGE_VAL, -HUGE_VAL}};
    if (n < 2.0)
        return "fewer than two frames in the time asked; ask for a longer time or give a shorter frame";
    r->looks = looks_of(s);
    if (n > frames_max)
        return "more than 2e6 frames in the time asked; ask for a shorter time or give a longer frame";
    if (n * r->looks > lever_looks_max)
        return "more than 1e7 looks at a lever, 24 a period and 3 a frame or more; ask for a shorter time";
    struct runner *o = calloc(1, sizeof *o);
    r->wanted = (int)n;
    r->value = calloc((size_t)r->wanted * (size_t)r->looks, sizeof *r->value);
    const char *why = o && r->value ? start(o, s, nudge) : "out of memory";
    if (!why)
        go(o, s, w, beside, r);
    free(o);
    return why;
}

const char *choose_run(const struct scene *s, const struct choose_sweep *w, double nudge,
                       struct choose_record *r)
{
    return run(s, w, nudge, NULL, r);
}

const char *choose_run_beside(const struct scene *s, const struct choose_sweep *w,
                              const struct choose_beside *beside, struct choose_record *r)
{
    return run(s, w, 0.0, beside, r);
}

void choose_record_free(struct choose_record *r)
{
    free(r->value);
    r->value = NULL;
}

double choose_span(const struct choose_record *r, double unit)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int i = 0; i < r->n_values; i++) {
        low = fmin(low, r->value[i]);
        high = fmax(high, r->value[i]);
    }
    return (high - low) + floor_of_span * unit;
}

/* Largest difference of the first n values. */
static double difference(const struct choose_record *a, const struct choose_record *b, int n)
{
    double most = 0.0;
    for (int i = 0; i < n; i++)
        most = fmax(most, fabs(a->value[i] - b->value[i]));
    return most;
}

double choose_difference(const struct choose_record *a, const struct choose_record *b, double span)
{
    if (a->n < a->wanted || b->n < b->wanted || a->trouble || b->trouble)
        return HUGE_VAL;
    return difference(a, b, a->n_values) / span;
}

double choose_growth(const struct choose_record *a, const struct choose_record *b, double span, double least)
{
    int n = a->n_values < b->n_values ? a->n_values : b->n_values;
    double most = 1.0, before = difference(a, b, n / 2) / span + least;
    for (int i = CHOOSE_SPELLS / 2 + 1; i <= CHOOSE_SPELLS; i++) {
        double now = difference(a, b, (int)((double)n * i / CHOOSE_SPELLS)) / span + least;
        most = fmax(most, now / before);
        before = now;
    }
    return most;
}

void choose_statistics(const struct choose_record *r, double span, double statistic[STATISTICS])
{
    double sum = 0.0, squares = 0.0, peak = -HUGE_VAL;
    for (int i = 0; i < r->n_values; i++) {
        sum += r->value[i];
        peak = fmax(peak, r->value[i]);
    }
    double mean = sum / r->n_values;
    for (int i = 0; i < r->n_values; i++)
        squares += (r->value[i] - mean) * (r->value[i] - mean);
    statistic[STATISTIC_MEAN] = mean / span;
    statistic[STATISTIC_RMS] = sqrt(squares / r->n_values) / span;
    statistic[STATISTIC_PEAK] = peak / span;
    statistic[STATISTIC_LOSS] = r->loss;
}
