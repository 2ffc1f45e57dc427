/* ledger.h - the running energy balance, independent of the method that advances the state.
 *
 *     stored energy now - at the start = work of the inputs + heat + change - damping + residual
 *
 * It takes the states as they come and asks whether energy was kept. The residual is the method's error.
 * Where the method is far more exact than the step is short, it is the ledger's own error.
 *
 * Over each piece between switches the powers are integrated by Simpson's rule. The middle state comes
 * from the quintic Hermite polynomial through positions, velocities and accelerations at both ends. The
 * order is 4 in the step, as that of rk4. With a wave of four ticks a period an error of 1e-4 is left; the
 * Simpson errors cancel over its periods. Sums are compensated, so that 1e9 additions cost no digits.
 * Velocities are the second half of a model's states. All energies are in model units. */
#ifndef FIRMWARE_LEDGER_H
#define FIRMWARE_LEDGER_H

#include <stdbool.h>
#include "models/model.h"
#include "firmware/method/method.h"

struct sum {
    double value, carry; /* the sum is value + carry */
};

/* The weights of the rule for pieces of one length. */
struct ledger_rule {
    double length; /* model time */
    double sixth;  /* a sixth of the length */
    double a, b;   /* middle position: times the difference of the velocities, the sum of the accelerations */
    double c;      /* middle velocity: times the difference of the accelerations */
    double inverse, mean; /* likewise: 15/8 inverse times the way, `mean` times the mean velocity */
};

struct ledger;
/* Behind ledger_begin: books one piece with its inputs at[0] in the middle and at[1] at its end. */
typedef double ledger_function(struct ledger *l, const double *p, const struct input (*at)[MODEL_INPUTS],
                               const double *x0, const double *x1);
/* Behind ledger_begin: books n ticks of a block, 1 or BLOCK_TOGETHER, from the one on whose inputs are at[0]
 * to at[2] and whose states are x[0] and x[1]. Returns the largest contact force at their ends and middles.
 * anew: an input may jump before any of them. Inputs hold in each, and the flow at its begin is found anew.
 */
typedef double ledger_ticks_function(struct ledger *l, const double *p,
                                     const struct input (*at)[MODEL_INPUTS], const double (*x)[MODEL_STATES],
                                     uint32_t n, bool anew);

/* Sums of books that leave shares of their ends (struct method_ends): the ledger's are these less the share
 * of the last end. */
struct ledger_open {
    struct sum work[MODEL_INPUTS], damping;
    struct method_share end;
    bool goes_on; /* books that begin with this share go on from here */
};

struct ledger {
    const struct model *model;
    ledger_function *piece; /* for the model: an instantiation with its flow inlined, or the general one */
    struct sum work[MODEL_INPUTS]; /* delivered by each input */
    struct sum damping;            /* lost in the dampers */
    struct sum heat;               /* brought in by thermal forces */
    struct sum change;             /* brought in by parameter changes and by set states */
    double gross;                  /* sum of |work|, |heat| and damping since plant_imbalance last reset it */
    double most;                   /* largest energy that moved between two looks of plant_imbalance */
    struct ledger_open open;       /* behind ledger_take_ends */
    struct sum start;              /* stored energy when the ledger began */
    struct flow flow;              /* at the end of the last piece; powers of the active inputs */
    struct ledger_rule rule;       /* for pieces as long as the last one */
    unsigned active;               /* bit i: input i sounds in the piece */
    bool flow_valid;               /* it belongs to the state and inputs at the start of the next piece */
};

/* Begins anew with all sums 0, for the model with parameters p at inputs u and state x. */
void ledger_start(struct ledger *l, const struct model *m, const double *p, const struct input *u,
                  const double *x);

/* Goes on with another model and the sums so far. ledger_rescale must follow. */
void ledger_bind(struct ledger *l, const struct model *m);

/* For the model: an instantiation with its flow inlined, or the general one; bits as those of `piece`. */
ledger_ticks_function *ledger_bind_ticks(const struct model *m);

/* Weights for pieces of this length, which stay until another length comes. */
void ledger_weigh(struct ledger *l, double length);

/* A piece as long as e begins at inputs u and state x: weights, and the flow there, unless they are known. */
static inline void ledger_begin(struct ledger *l, const double *p, const struct segment *e,
                                const struct input *u, const double *x)
{
    l->active = e->active;
    if (e->length != l->rule.length)
        ledger_weigh(l, e->length);
    if (!l->flow_valid)
        l->model->flow(p, u, x, &l->flow);
    l->flow_valid = true;
}

/* Books one piece, the whole segment e, over which the state went from x0 to x1. Returns the largest
 * contact force at its begin, middle and end, model units. Costs two evaluations of the model's flow, and
 * a third where the flow at its begin is not known from the last piece. Weights cost a division where its
 * length is not that of the last piece. */
static inline double ledger_piece(struct ledger *l, const double *p, const struct segment *e,
                                  const double *x0, const double *x1)
{
    ledger_begin(l, p, e, e->at[0], x0);
    return l->piece(l, p, &e->at[1], x0, x1);
}

/* Books one piece by the energies that the method itself reports. Returns the largest contact force in it,
 * model units. */
double ledger_take(struct ledger *l, const struct method_books *b);

/* As ledger_take, n ticks in which none but the active inputs did work, and no heat came in. */
double ledger_take_ticks(struct ledger *l, unsigned active, const struct method_books *b, uint32_t n);

/* As ledger_take, n ticks that leave shares of their ends, in which none but the active inputs did work, and
 * no heat came in. The sums have the same bits, however many ticks come at a time. Forces are not looked at.
 */
void ledger_take_ends(struct ledger *l, unsigned active, const struct method_books *b,
                      const struct method_ends *ends, uint32_t n);

/* The residual of the equation above, with the energy `stored` now. */
double ledger_residual(const struct ledger *l, int n_inputs, double stored);

/* For new parameters: converts all sums by `factor`, the old unit of energy over the new one. Then it
 * books `change`, the energy that came in with the parameters, in the new unit. The residual stays but for
 * its unit. */
void ledger_rescale(struct ledger *l, double factor, double change);

/* A compensated sum (Knuth): each addition keeps the rounding of value in carry. An all-zero sum is 0. */
void sum_add(struct sum *s, double x);
double sum_of(const struct sum *s);

#endif
