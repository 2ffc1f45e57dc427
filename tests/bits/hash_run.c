/* hash_run.c - hashes of trajectories that pass through everything; see hash_run.h. */
#include "tests/bits/hash_run.h"

#include "firmware/method/auto.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/reduced/shaft_mode.h"
#include "models/text.h"
#include "models/afm_lever.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/bits/arithmetic.h"
#include "tests/fixture/afm/paper_tip.h"

#define TWO_PI 6.283185307179586

/* Radians of the eigenfrequency in a tick. */
#define FINE   0.1
#define COARSE 1.0
#define FAR    5.0  /* beyond one series of exact, for models without contacts */
#define FAST   0.8  /* angle of a fast drive in a tick */
#define NEARLY 0.03 /* parameters turn auto's choice when steps this much shorter and longer do */

enum { FIRST_AT = 137, SECOND_AT = 337, STREAM_TICKS = 200 };

static const struct {
    const char *name;
    const struct method *method;
    double angle, tol;
    int blocks; /* a coarse tick has more in it */
} variant[HASH_VARIANTS] = {
    {"rk4", &rk4, FINE, 0.0, HASH_BLOCKS},
    {"rk4_float32", &rk4_float32, FINE, 0.0, HASH_BLOCKS},
    {"rk4_unlocated", &rk4_unlocated, FINE, 0.0, HASH_BLOCKS},
    {"taylor", &taylor, FINE, 0.0, HASH_BLOCKS},
    {"taylor:coarse", &taylor, COARSE, 0.0, HASH_COARSE_BLOCKS},
    {"exact", &exact, FINE, 0.0, HASH_BLOCKS},
    {"exact:coarse", &exact, COARSE, 0.0, HASH_COARSE_BLOCKS},
    {"auto:taylor:rk4", &auto_method, FINE, 0.00304, HASH_BLOCKS},
    {"exact:far", &exact, FAR, 0.0, HASH_COARSE_BLOCKS},
    {"modal", &modal, FINE, 0.0, HASH_BLOCKS},
    {"adams", &adams, FINE, 0.0, HASH_BLOCKS},
};

/* Reduced models stay where they are valid, or they leave the finite numbers. */
static const struct {
    const struct model *model;
    double pace, force;
} driven[] = {
    {&hertz_rig, 1.0, 0.8},
    {&hertz_rig_linear, 1.0, 0.8},
    {&hertz_rig_cubic, 1.0, 0.05},
    {&hertz_rig_averaged, 1.0, 0.05},
    {&rolling_contact, 1.0, 0.8},
    {&rolling_contact_linear, 1.0, 0.8},
    {&afm_tip, 1.0, 0.5},
    {&afm_tip_linear, 1.0, 0.8},
    {&afm_tip_cubic, 1.0, 0.02},
    {&afm_tip_averaged, 1.0, 0.02},
    {&afm_lever, 0.3, 0.3},
    {&shaft_bearing, 0.1, 0.1},
    {&shaft_bearing_linear, 0.1, 0.1},
    {&shaft_bearing_mode, 0.1, 0.1},
};
STATIC_ASSERT(sizeof driven / sizeof driven[0] == MODELS, every_model_is_driven);

/* ---- which there are ---- */

/* A lever low over the sample, with heat, two branches of adhesion and any number of modes. */
static double of_lever(int k, int i)
{
    switch (k) {
    case LEVER_F0:
    case LEVER_K:
        return afm_lever.parameter[k].initial * (1.0 + 0.01 * ((i + 3 * k) % 11));
    case LEVER_TEMPERATURE:
        return 295.0;
    case LEVER_MODES:
        return 1.0 + i % MODEL_MODES;
    case LEVER_HAMAKER_OUT:
        return 1e-19;
    case LEVER_HEIGHT:
        return 5e-9;
    case LEVER_VISCOSITY:
        return 10.0 * (i % 2);
    default:
        return afm_lever.parameter[k].initial;
    }
}

/* In block i. Choices and ratios do not vary by a percent; slow motion needs its fast drive. */
static void parameters_of(const struct model *m, int i, double *si)
{
    for (int k = 0; k < m->n_parameters; k++) {
        const struct parameter *q = &m->parameter[k];
        si[k] = paper_tip_is(m) ? paper_tip_parameter(m, k) : q->initial;
        if (m == &afm_lever)
            si[k] = of_lever(k, i);
        else if (text_equal(q->name, "mode"))
            si[k] = 1.0 + i % 3;
        else if (text_equal(q->name, "fast_stiffness"))
            si[k] = 0.3;
        else if (m == &afm_tip && text_equal(q->name, "sign"))
            si[k] = -1.0; /* from a contact that attracts this tip would not come back */
        else if (!text_equal(q->unit, "1"))
            si[k] *= 1.0 + 0.01 * ((i + 3 * k) % 11);
    }
}

bool hash_case(int i, struct hash_case *c)
{
    int k = i / HASH_VARIANTS, v = i % HASH_VARIANTS;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    *c = (struct hash_case){.model = driven[k].model,
                            .integrator = variant[v].method,
                            .plant = driven[k].model->name,
                            .method = variant[v].name,
                            .angle = variant[v].angle,
                            .tol = variant[v].tol,
                            .pace = driven[k].pace,
                            .force = driven[k].force,
                            .blocks = variant[v].blocks};
    parameters_of(c->model, 0, si);
    c->model->prepare(si, p, &scale);
    double h = c->angle / c->model->eigenfrequency(p);
    if (c->integrator == &auto_method)
        return auto_choice(c->model, p, h * (1.0 - NEARLY), c->tol, NULL, NULL) !=
               auto_choice(c->model, p, h * (1.0 + NEARLY), c->tol, NULL, NULL);
    return !c->integrator->refuse(c->model, p, h, c->tol);
}

/* ---- what is commanded ---- */

/* One harmonic drive: near resonance, or fast every third time; silent every seventh. */
static void drive(const struct hash_case *c, struct plant *pl, int k, int i)
{
    enum quantity q = c->model->input_signal[k].quantity;
    double amplitude = c->force * (0.4 + 0.15 * (i % 5)) * scale_of(&pl->scale, q);
    double angle = (c->angle < COARSE ? c->angle : COARSE) * c->pace * (0.7 + 0.05 * (i % 13));
    if (i % 3 == 2) {
        angle = FAST;
        if (q == QUANTITY_LENGTH) /* the rig feels the acceleration */
            amplitude *= c->angle * c->angle;
    }
    if (i % 7 == 6)
        amplitude = 0.0;
    plant_drive(pl, k, amplitude, angle / (TWO_PI * pl->tick_s), 0.3 * (i % 7) - 0.9,
                pl->tick_s * (97.0 * (i % 6)));
}

static double level(const struct hash_case *c, const struct plant *pl, int k, int i)
{
    return 0.06 * (i % 11 - 5) * c->force * scale_of(&pl->scale, c->model->input_signal[k].quantity);
}

static void silence(struct plant *pl)
{
    for (int k = 0; k < pl->model->n_inputs; k++)
        plant_noise(pl, k, 0.0, 1, 0, 0.0), plant_drive(pl, k, 0.0, 0.0, 0.0, 0.0);
}

/* New straight inputs at every tick: what a controller in a loop sends. */
static const char *stream(const struct hash_case *c, struct plant *pl, int i)
{
    if (!plant_advance(pl, (struct instant){pl->now.tick + 1, 0}))
        return "not finite";
    for (int n = 0; n < STREAM_TICKS; n++) {
        for (int k = 0; k < pl->model->n_inputs; k++)
            plant_sample(pl, k, level(c, pl, k, i + (n + k) * n), 1);
        if (!plant_run(pl, 1))
            return "not finite";
    }
    return NULL;
}

static const char *command(const struct hash_case *c, struct plant *pl, int i)
{
    double si[MODEL_PARAMETERS];
    int n = pl->model->n_inputs;
    switch (i % 5) {
    case 0:
        drive(c, pl, i % n, i + 1); /* inside the first one's ramp */
        drive(c, pl, (i + 1) % n, i + 2);
        break;
    case 1:
        for (int k = 0; k < n; k++)
            plant_sample(pl, k, level(c, pl, k, i + k), (uint64_t)(k + i) % 4 * 37);
        break;
    case 2:
        parameters_of(pl->model, i, si);
        return plant_change(pl, si);
    case 3:
        for (int k = 0; k < n; k++)
            plant_noise(pl, k, level(c, pl, k, 6 + (i + k) % 3), (uint32_t)(1 + (i + k) % 5), (uint32_t)i,
                        pl->tick_s * (40.0 * (i % 4)));
        break;
    default:
        return stream(c, pl, i);
    }
    return NULL;
}

static const char *block_of(const struct hash_case *c, struct plant *pl, int i)
{
    uint64_t begin = (uint64_t)i * HASH_TICKS;
    struct instant first = {begin + FIRST_AT, (uint32_t)(7919 * i % TICK_FRACTIONS)};
    struct instant second = {begin + SECOND_AT, (uint32_t)(104729 * i % TICK_FRACTIONS)};
    if (!plant_advance(pl, first))
        return "not finite";
    if (i % 5 == 4)
        silence(pl);
    else
        drive(c, pl, i % pl->model->n_inputs, i);
    if (!plant_advance(pl, second))
        return "not finite";
    const char *why = command(c, pl, i);
    if (!why && !plant_advance(pl, (struct instant){begin + HASH_TICKS, 0}))
        why = "not finite";
    return why;
}

/* ---- the hash ---- */

/* FNV-1a over the bits of n doubles. */
static uint64_t hash_doubles(uint64_t hash, const double *x, int n)
{
    union {
        double x;
        uint64_t bits;
    } word;
    for (int i = 0; i < n; i++) {
        word.x = x[i];
        for (int k = 0; k < 64; k += 8)
            hash = (hash ^ (word.bits >> k & 0xFF)) * UINT64_C(0x100000001B3);
    }
    return hash;
}

static uint32_t hash_of(struct plant *pl)
{
    double output[MODEL_OUTPUTS];
    struct event e;
    uint64_t hash = plant_hash(pl);
    plant_output(pl, output);
    hash = hash_doubles(hash, output, pl->model->n_outputs);
    hash = hash_doubles(hash, (double[]){plant_energy(pl), plant_residual(pl), pl->peak_force, pl->loss_time},
                        4);
    while (plant_take_event(pl, &e))
        hash = hash_doubles(
            hash, (double[]){(double)e.tick, e.fraction, e.speed, e.peak_force, e.contact, e.touch}, 6);
    return (uint32_t)(hash ^ hash >> 32);
}

const char *hash_run(const struct hash_case *c, int blocks, struct plant *pl, double *scratch,
                     void (*block)(uint32_t hash))
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    parameters_of(c->model, 0, si);
    c->model->prepare(si, p, &scale);
    struct plant_config config = {.model = c->model,
                                  .si = si,
                                  .method = c->integrator,
                                  .tick_s = c->angle / c->model->eigenfrequency(p) * scale.time_s,
                                  .dilation = 1.0,
                                  .tol = c->tol,
                                  .scratch = scratch};
    const char *why = plant_init(pl, &config);
    for (int i = 0; !why && i < blocks && i < c->blocks; i++) {
        why = block_of(c, pl, i);
        block(hash_of(pl));
    }
    if (!why && c->model->n_contacts && !pl->counts.switches)
        why = "contact was never lost";
    return why;
}

void hash_arithmetic(int blocks, void (*block)(uint32_t hash))
{
    uint64_t random = 1, hash = 0;
    for (int i = 0; i < blocks; i++) {
        hash = arithmetic_hash(&random, HASH_TICKS, hash);
        block((uint32_t)(hash ^ hash >> 32));
    }
}
