/* ledger.h - the running energy balance, independent of the method that advances the state.
 *
 * Over each piece between switches the powers are integrated by Simpson's rule with the middle state from the quintic
 * Hermite polynomial through positions, velocities and accelerations at both ends (order 4 in the step, as good as rk4; of a wave of
 * four ticks a period, whose own Simpson errors cancel over its periods, 1e-4 is left). It takes the states as they come and
 * asks whether energy was kept: what does not balance is the method's error, or, for a method far more exact than
 * the step is short, the ledger's own. Sums are compensated, so that 1e9 additions cost no digits. Velocities are the second half
 * of a model's states. */
#ifndef FIRMWARE_LEDGER_H
#define FIRMWARE_LEDGER_H

#include <stdbool.h>
#include "models/model.h"
#include "firmware/method/method.h"

struct sum {
    double value, carry; /* the sum is value + carry */
};

struct ledger;
typedef double ledger_function(struct ledger *l, const double *p, const struct segment *e, const double *x0,
                               const double *x1);

struct ledger {
    const struct model *model;
    ledger_function *piece; /* for the model: an instantiation with its flow inlined, or the general one */
    struct sum work[MODEL_INPUTS]; /* delivered by each input */
    struct sum damping;            /* lost in the dampers */
    struct sum heat;               /* brought in by thermal forces */
    struct sum change;             /* brought in by parameter changes and by set states */
    double gross;                  /* sum of |work| and damping over all pieces; whoever asks sets it back */
    double most;                   /* largest energy that moved between two looks of plant_imbalance */
    struct sum start;              /* stored energy when the ledger began */
    struct flow flow;              /* at the end of the last piece; powers of the active inputs */
    bool flow_valid;               /* it belongs to the state and inputs at the start of the next piece */
};

/* Begins anew at this state. */
void ledger_start(struct ledger *l, const struct model *m, const double *p, const struct input *u,
                  const double *x);

/* Goes on with another model, from the same sums. */
void ledger_bind(struct ledger *l, const struct model *m);

/* Books one piece, the whole segment e, from x0 to x1: the largest contact force seen at the three instants. */
static inline double ledger_piece(struct ledger *l, const double *p, const struct segment *e,
                                  const double *x0, const double *x1)
{
    if (!l->flow_valid)
        l->model->flow(p, e->at[0], x0, &l->flow);
    l->flow_valid = true;
    return l->piece(l, p, e, x0, x1);
}

/* Books one piece by what the method says it moved. Returns the largest contact force of it. */
double ledger_take(struct ledger *l, const struct method_books *b);

/* What does not balance: stored - start - work - heat - change + damping, `stored` the energy now. Model units. */
double ledger_residual(const struct ledger *l, int n_inputs, double stored);

/* The unit of energy changed by `factor` (old over new) and `change` (new units) came in with the parameters. */
void ledger_rescale(struct ledger *l, double factor, double change);

void sum_add(struct sum *s, double x);
double sum_of(const struct sum *s);

#endif
