/* plant_report.c - a plant's outputs, energies, energy balance, time, and the hash of its state. */
#include "firmware/plant/plant_report.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "firmware/plant/hash.h"
#include "models/text.h"

double plant_time(const struct plant *pl)
{
    return ((double)pl->now.tick + (double)pl->now.fraction / TICK_FRACTIONS) * pl->tick_s;
}

void plant_output(const struct plant *pl, double *output)
{
    const struct model *m = pl->model;
    m->output(pl->p, pl->segment.at[2], pl->x, output);
    for (int i = 0; i < m->n_outputs; i++)
        output[i] *= scale_of(&pl->scale, m->output_signal[i].quantity);
}

double plant_read(const struct plant *pl, const char *name)
{
    static const char stage[PLANT_STAGES][sizeof "stage_0"] = {"stage_0", "stage_1", "stage_2", "stage_3"};
    double output[MODEL_OUTPUTS];
    for (int i = 0; pl->staged && i < PLANT_STAGES; i++) {
        if (text_equal(name, stage[i]))
            return pl->stage_calls->results(pl->stages)[i];
    }
    plant_output(pl, output);
    for (int i = 0; i < pl->model->n_outputs; i++) {
        if (text_equal(name, pl->model->output_signal[i].name))
            return output[i];
    }
    return (double)NAN;
}

double plant_energy(const struct plant *pl)
{
    return pl->model->energy(pl->p, pl->segment.at[2], pl->x) * pl->scale.energy_J;
}

double plant_residual(const struct plant *pl)
{
    double stored = pl->model->energy(pl->p, pl->segment.at[2], pl->x);
    return ledger_residual(&pl->ledger, pl->model->n_inputs, stored) * pl->scale.energy_J;
}

/* The terms of the stored energy are rounded four times
 * at most, and at rest they cancel to a seventh at most. */
#define ENERGY_ROUNDING (4.0 * DBL_EPSILON)

/* A method errs by a share of its tolerance in every
 * period: together by that much, from one look to the next. */
#define TOL_SHARE 4.0

/* The rounding of a difference of two stored energies that are about `stored` and, at rest, `lowest`. */
static double rounding(const struct plant *pl, const double *rest, double lowest, double stored)
{
    double size = fabs(lowest) + fabs(stored);
    for (int i = 0; i < pl->model->n_states; i++)
        size += rest[i] * rest[i];
    return ENERGY_ROUNDING * size + DBL_MIN / DBL_EPSILON;
}

double plant_imbalance(struct plant *pl, double *residual_J)
{
    const struct model *m = pl->model;
    struct ledger *l = &pl->ledger;
    struct input still[MODEL_INPUTS] = {{0.0, 0.0}};
    double rest[MODEL_STATES], before_J = *residual_J, tol = pl->tol > 0.0 ? pl->tol : METHOD_TOL_DEFAULT;
    m->rest(pl->p, rest);
    double lowest = m->energy(pl->p, still, rest), stored = m->energy(pl->p, pl->segment.at[2], pl->x);
    double moved = l->gross + fabs(stored - lowest);
    l->gross = 0.0;
    l->most = moved > l->most ? moved : l->most;
    *residual_J = plant_residual(pl);
    double off = fabs(*residual_J - before_J) / pl->scale.energy_J - rounding(pl, rest, lowest, stored) -
                 TOL_SHARE * tol * sqrt(l->most * moved);
    return off <= 0.0 ? 0.0 : off / moved;
}

static uint64_t hash_drive(uint64_t hash, const struct drive *d)
{
    hash = hash_word(hash, d->carrier);
    hash = hash_word(hash, d->offset);
    hash = hash_word(hash, d->step);
    hash = hash_double(hash, d->amplitude);
    hash = hash_word(hash, d->ramp_left);
    if (d->ramp_left > 0) {
        hash = hash_word(hash, d->step_to);
        hash = hash_word(hash, d->offset_to);
        hash = hash_double(hash, d->amplitude_to);
    }
    hash = hash_double(hash, d->sample);
    if (d->noise.active)
        hash = hash_double(hash, d->noise.value);
    return hash_word(hash, d->sample_left);
}

uint64_t plant_hash(const struct plant *pl)
{
    uint64_t hash = HASH_BEGIN;
    hash = hash_word(hash, pl->now.tick);
    hash = hash_word(hash, pl->now.fraction);
    hash = hash_word(hash, pl->regime);
    for (int i = 0; i < pl->model->n_parameters; i++)
        hash = hash_double(hash, pl->si[i]);
    for (int i = 0; i < pl->model->n_states; i++)
        hash = hash_double(hash, pl->x[i]);
    for (int i = 0; i < pl->model->n_inputs; i++) {
        hash = hash_drive(hash, &pl->drive[i]);
        hash = hash_double(hash, sum_of(&pl->ledger.work[i]));
    }
    hash = hash_double(hash, sum_of(&pl->ledger.change));
    hash = hash_double(hash, sum_of(&pl->ledger.damping));
    return pl->staged ? pl->stage_calls->hash(pl->stages, hash) : hash;
}
