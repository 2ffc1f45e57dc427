/* ours.c - every method of the table through the public seam: method->step alone over segments as long as the
 * method takes them, and the whole plant tick with drives, events and ledger. */
#include "tests/bench/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"

enum { PIECES = 10000, TICKS_MAX = 2000000, TICKS_TRIED = 32 };
#define TURN 6.283185307179586476925L

struct ours {
    const struct problem *b;
    const struct model *m;
    const struct method *method;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], x0[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS]; /* SI */
    struct scale scale;
    int n;            /* ticks from one input sample, or output, to the next */
    double h, tick_s; /* length of a tick in model time and in seconds */
    double tol, *scratch;
    int held_input;             /* -1: harmonic */
    double *sample, *sample_si; /* model units and SI, one period */
    step_function *step;
    struct segment first; /* waves at time 0 */
    double half_cosine[MODEL_INPUTS], half_sine[MODEL_INPUTS];
    double cosine[CASE_OUTPUTS][MODEL_INPUTS],
        sine[CASE_OUTPUTS][MODEL_INPUTS]; /* where each output interval begins */
    struct plant plant;
};

static long double phase_at(const struct ours *c, int i, long double t_s)
{
    return fmodl((long double)c->drive[i].omega * t_s + c->drive[i].phase, TURN);
}

static double amplitude_of(const struct ours *c, int i)
{
    return c->drive[i].amplitude / scale_of(&c->scale, c->m->input_signal[i].quantity);
}

/* The inputs at the end of output interval k, model units. */
static void inputs_at(const struct ours *c, int k, struct input *u)
{
    long double t = (long double)c->b->interval * c->b->eq.time_unit * (k + 1);
    for (int i = 0; i < c->m->n_inputs; i++) {
        double a = i == c->held_input ? 0.0 : amplitude_of(c, i), w = c->drive[i].omega * c->scale.time_s;
        u[i].value = a * (double)cosl(phase_at(c, i, t));
        u[i].rate = -a * w * (double)sinl(phase_at(c, i, t));
    }
}

/* Model states to the equation's, through the paper's. */
static void convert(void *context, double (*out)[EQUATION_STATES])
{
    const struct ours *c = context;
    const struct problem *b = c->b;
    for (int k = 0; k < b->n_out; k++) {
        struct input u[MODEL_INPUTS];
        double q[MODEL_STATES];
        inputs_at(c, k, u);
        c->m->paper_state(c->p, u, out[k], q);
        if (c->m == &hertz_rig) {
            out[k][0] = 1.0 + (2.0 / 3.0) * q[0] - u[RIG_BASE].value;
            out[k][1] = (2.0 / 3.0) * q[1] - u[RIG_BASE].rate;
        } else if (c->m == &afm_tip) {
            out[k][0] = 1.0 - q[0];
            out[k][1] = -q[1];
        } else {
            for (int i = 0; i < b->eq.n; i++)
                out[k][i] = q[i] / b->eq.length_unit * (i < b->eq.n / 2 ? 1.0 : b->eq.time_unit);
        }
    }
}

/* ---- the method alone ---- */

/* One tick with whatever switches in it. False when the method gave up. */
static bool carry(const struct ours *c, const struct segment *e, unsigned *regime, double *x)
{
    struct crossing cross = {0.0, 0, 0, 0.0};
    enum step_status status = c->step(c->m, c->p, c->scratch, e, *regime, x, &cross);
    if (status == STEP_END)
        return true;
    struct segment rest = *e;
    for (int i = 0; i < PIECES && status != STEP_NOT_FINITE; i++) {
        if (status == STEP_END)
            return true;
        if (status == STEP_SWITCH)
            *regime ^= 1u << cross.contact;
        segment_tail(&rest, c->m->n_inputs, cross.done);
        status = c->step(c->m, c->p, c->scratch, &rest, *regime, x, &cross);
    }
    return false;
}

static void turn(struct wave *w, double c, double s)
{
    double cosine = w->cosine * c - w->sine * s;
    w->sine = w->sine * c + w->cosine * s;
    w->cosine = cosine;
}

static struct input input_of(const struct wave *w)
{
    return (struct input){w->offset + w->amplitude * w->cosine, -(w->amplitude * w->omega) * w->sine};
}

/* The tick after the one that `next` was left at; `next` moves on. Its begin is the end of the last one. */
static void excite(const struct ours *c, unsigned harmonic, struct wave *next, struct segment *e)
{
    for (unsigned i = 0; harmonic >> i; i++) {
        struct wave *w = &next[i];
        if (!((harmonic >> i) & 1u))
            continue;
        e->wave[i].cosine = w->cosine;
        e->wave[i].sine = w->sine;
        e->at[0][i] = e->at[2][i];
        turn(w, c->half_cosine[i], c->half_sine[i]);
        e->at[1][i] = input_of(w);
        turn(w, c->half_cosine[i], c->half_sine[i]);
        e->at[2][i] = input_of(w);
    }
}

/* An output interval begins: the phasors in `next` anew. */
static void begin_interval(const struct ours *c, int k, struct wave *next, struct segment *e)
{
    for (int i = 0; i < c->m->n_inputs; i++) {
        next[i].cosine = c->cosine[k][i];
        next[i].sine = c->sine[k][i];
        e->at[2][i] = input_of(&next[i]);
    }
}

static void hold(const struct ours *c, int j, struct segment *e)
{
    int i = c->held_input;
    e->wave[i].offset = e->at[0][i].value = e->at[1][i].value = e->at[2][i].value = c->sample[j];
    e->changed = true;
}

static unsigned regime_at_start(const struct ours *c)
{
    struct input gap[MODEL_CONTACTS], u[MODEL_INPUTS];
    unsigned regime = 0;
    for (int i = 0; i < c->m->n_inputs; i++)
        u[i] = i == c->held_input ? (struct input){c->sample[0], 0.0} : input_of(&c->first.wave[i]);
    c->m->gap(c->p, u, c->x0, gap);
    for (int i = 0; i < c->m->n_contacts; i++)
        regime |= (unsigned)(gap[i].value < 0.0) << i;
    return regime;
}

static void run_method(void *context, double (*out)[EQUATION_STATES])
{
    const struct ours *c = context;
    struct segment e = c->first;
    struct wave next[MODEL_INPUTS];
    double x[MODEL_STATES];
    unsigned regime = regime_at_start(c);
    unsigned harmonic = c->held_input < 0 ? e.active : e.active & ~(1u << c->held_input);
    bool good = true;
    memcpy(x, c->x0, sizeof x);
    memcpy(next, e.wave, sizeof next);
    e.changed = true;
    for (int k = 0; k < c->b->n_out; k++) {
        begin_interval(c, k, next, &e);
        for (int j = 0; j < c->b->holds; j++) {
            if (c->held_input >= 0)
                hold(c, j, &e);
            for (int i = 0; i < c->n && good; i++) {
                excite(c, harmonic, next, &e);
                good = carry(c, &e, &regime, x);
                e.changed = false;
            }
        }
        memcpy(out[k], x, sizeof x);
        out[k][0] = good ? out[k][0] : (double)NAN;
    }
}

/* ---- the whole plant ---- */

static void run_plant(void *context, double (*out)[EQUATION_STATES])
{
    struct ours *c = context;
    struct plant *pl = &c->plant;
    bool good = true;
    plant_reset(pl);
    for (int i = 0; i < c->m->n_inputs; i++) {
        const struct harmonic *d = &c->drive[i];
        if (d->amplitude != 0.0 && i != c->held_input)
            plant_drive_start(pl, i, d->amplitude, (double)((long double)d->omega / TURN), d->phase);
    }
    plant_set_state(pl, c->x0);
    for (int k = 0; k < c->b->n_out; k++) {
        good = good && (c->held_input < 0 ? plant_run(pl, (uint64_t)c->n)
                                          : plant_run_samples(pl, c->held_input, c->sample_si,
                                                              (uint32_t)c->b->holds, (uint64_t)c->n));
        memcpy(out[k], pl->x, sizeof pl->x);
        out[k][0] = good ? out[k][0] : (double)NAN;
    }
}

/* ---- set-up ---- */

static void release(void *context)
{
    struct ours *c = context;
    free(c->scratch);
    free(c->sample);
    free(c->sample_si);
    free(c);
}

static void set_samples(struct ours *c)
{
    const struct problem *b = c->b;
    c->held_input = -1;
    if (!b->held)
        return;
    for (int i = 0; i < c->m->n_inputs && c->held_input < 0; i++)
        c->held_input = c->drive[i].amplitude != 0.0 ? i : -1;
    c->sample = bench_alloc((size_t)b->holds * sizeof *c->sample);
    for (int j = 0; j < b->holds; j++)
        c->sample[j] =
            amplitude_of(c, c->held_input) * (double)cosl(TURN * (long double)j / (long double)b->holds);
    c->sample_si = bench_alloc((size_t)b->holds * sizeof *c->sample_si);
    for (int j = 0; j < b->holds; j++)
        c->sample_si[j] = c->sample[j] * scale_of(&c->scale, c->m->input_signal[c->held_input].quantity);
}

static void set_waves(struct ours *c)
{
    long double interval_s = (long double)c->b->interval * c->b->eq.time_unit;
    for (int i = 0; i < c->m->n_inputs; i++) {
        struct wave *w = &c->first.wave[i];
        *w = (struct wave){.cosine = 1.0};
        if (c->drive[i].amplitude == 0.0)
            continue;
        c->first.active |= 1u << i;
        if (i == c->held_input) {
            w->amplitude = 0.0;
            continue;
        }
        w->amplitude = amplitude_of(c, i);
        w->omega = c->drive[i].omega * c->scale.time_s;
        w->cosine = cos(c->drive[i].phase);
        w->sine = sin(c->drive[i].phase);
        long double half = 0.5L * c->drive[i].omega * (interval_s / c->b->holds / c->n);
        c->half_cosine[i] = (double)cosl(half);
        c->half_sine[i] = (double)sinl(half);
        for (int k = 0; k < c->b->n_out; k++) {
            c->cosine[k][i] = (double)cosl(phase_at(c, i, interval_s * k));
            c->sine[k][i] = (double)sinl(phase_at(c, i, interval_s * k));
        }
    }
    c->first.length = c->h;
}

static void set_length(struct ours *c, int n)
{
    double interval_s = c->b->interval * c->b->eq.time_unit;
    c->n = n;
    c->tick_s = interval_s / c->b->holds / n;
    c->h = c->tick_s / c->scale.time_s;
}

static struct ours *ours_new(const struct problem *b, const struct method *method)
{
    struct ours *c = bench_alloc(sizeof *c);
    struct input u[MODEL_INPUTS];
    c->b = b;
    c->m = b->c->model;
    c->method = method;
    c->m->from_paper(b->paper, c->si, c->drive);
    c->m->prepare(c->si, c->p, &c->scale);
    set_samples(c);
    inputs_at(c, -1, u);
    c->m->state_from_paper(c->p, u, b->c->state, c->x0);
    c->step = method->bind(c->m);
    c->scratch = bench_alloc((method->n_scratch(c->m) + 1) * sizeof *c->scratch);
    return c;
}

/* Does the step guard accept n ticks? A drive of the plant turns by less than half a turn a tick. */
static bool accepts(struct ours *c, int n, double tol, bool plant)
{
    set_length(c, n);
    for (int i = 0; i < c->m->n_inputs && plant; i++) {
        if (c->drive[i].amplitude != 0.0 && !(c->drive[i].omega * c->tick_s < 0.49 * (double)TURN))
            return false;
    }
    return c->method->refuse(c->m, c->p, c->h, tol) == NULL;
}

/* The fewest ticks that the guard accepts; 0 for none. */
static int fewest(const struct problem *b, const struct method *method, double tol, bool plant)
{
    struct ours *c = ours_new(b, method);
    int low = 0, high = 1;
    while (!accepts(c, high, tol, plant) && high < TICKS_MAX) {
        low = high;
        high *= 2;
    }
    bool found = high < TICKS_MAX;
    while (found && high - low > 1) {
        int middle = (low + high) / 2;
        *(accepts(c, middle, tol, plant) ? &high : &low) = middle;
    }
    release(c);
    return found ? high : 0;
}

static struct entry *add(struct bench *b, const struct method *method, int n, double tol, bool plant)
{
    static char family[16][32];
    char setting[64];
    struct ours *c = ours_new(&b->problem, method);
    int slot = 0;
    while (method_table[slot] != method)
        slot++;
    slot = 2 * slot + plant;
    snprintf(family[slot], sizeof family[slot], plant ? "%s plant" : "%s", method->name);
    snprintf(setting, sizeof setting, "%d ticks", n);
    set_length(c, n);
    set_waves(c);
    c->tol = tol;
    method->prepare(c->m, c->p, c->h, tol, c->scratch);
    if (plant) {
        struct plant_config config = {.model = c->m,
                                      .si = c->si,
                                      .method = method,
                                      .tick_s = c->tick_s,
                                      .dilation = 1.0,
                                      .tol = tol,
                                      .scratch = c->scratch};
        const char *why = plant_init(&c->plant, &config);
        if (why)
            fprintf(stderr, "%s: %s\n", family[slot], why);
    }
    struct entry *e = bench_add(b, family[slot], setting, tol > 0.0 ? tol : n);
    e->side = plant ? SIDE_PLANT : SIDE_METHOD;
    e->run = plant ? run_plant : run_method;
    e->convert = convert;
    e->release = release;
    e->context = c;
    return e;
}

/* The error depends on the step: from the longest that the guard accepts downwards. */
static void add_steps(struct bench *b, const struct method *method, bool plant)
{
    const struct problem *p = &b->problem;
    int n0 = fewest(p, method, 0.0, plant);
    for (double n = n0; n0 > 0 && n * p->n_out * p->holds <= TICKS_MAX; n = floor(n * 1.5 + 0.5))
        add(b, method, (int)n, 0.0, plant);
}

/* The result does not depend on the tolerance: the loosest and the tightest give the same. */
static bool indifferent(const struct problem *p, const struct entry *loose, const struct entry *tight)
{
    static double a[CASE_OUTPUTS][EQUATION_STATES], b[CASE_OUTPUTS][EQUATION_STATES];
    loose->run(loose->context, a);
    tight->run(tight->context, b);
    return memcmp(a, b, (size_t)p->n_out * sizeof *a) == 0;
}

static void add_ticks(struct bench *b, const struct method *method, double tol, bool plant)
{
    int n0 = fewest(&b->problem, method, tol, plant);
    for (int n = n0; n0 > 0 && (n <= 8 * n0 || n <= TICKS_TRIED) && n <= TICKS_MAX; n *= 2)
        add(b, method, n, tol, plant);
}

/* The error depends on the tolerance, or on nothing. */
static void add_tolerances(struct bench *b, const struct method *method, bool plant)
{
    int first = b->n;
    add_ticks(b, method, bench_tolerance(0), plant);
    int second = b->n;
    add_ticks(b, method, bench_tolerance(BENCH_TOLERANCES / 2), plant);
    if (second == first || b->n == second || indifferent(&b->problem, &b->entry[first], &b->entry[second]))
        return;
    for (int i = 1; i < BENCH_TOLERANCES; i++) {
        if (i != BENCH_TOLERANCES / 2)
            add_ticks(b, method, bench_tolerance(i), plant);
    }
}

void ours_add(struct bench *b)
{
    for (int i = 0; i < METHODS; i++) {
        for (int plant = 0; plant < 2 && method_table[i] != &auto_method; plant++) {
            if (method_table[i]->order > 0)
                add_steps(b, method_table[i], plant);
            else
                add_tolerances(b, method_table[i], plant);
        }
    }
}
