/* hash_run.h - trajectories that pass through everything: the same bits on every compiler, level and
 * target, or the build is wrong.
 *
 * Every model runs with every method that takes it. Each run has drives on every input with ramps, ramps
 * inside ramps, samples, parameter changes, noise, and straight samples at every tick. They begin at
 * fractions of ticks where they can. Contacts are lost. The first ten blocks have all of it. */
#ifndef TESTS_HASH_RUN_H
#define TESTS_HASH_RUN_H

#include "firmware/plant/plant.h"
#include "models/models.h"

/* A block is HASH_TICKS ticks; so many of each trajectory
 * are in tests/data/hash.txt, fewer where ticks are coarse. */
enum { HASH_BLOCKS = 100, HASH_COARSE_BLOCKS = 20, HASH_TICKS = 1000 };
enum { HASH_VARIANTS = 11, HASH_RUNS = MODELS * HASH_VARIANTS };

/* Trajectory i. */
struct hash_case {
    const struct model *model;
    const struct method *integrator;
    const char *plant, *method; /* its name is "plant:method" */
    double angle, tol;          /* angle: of the plant's eigenfrequency in a tick */
    double pace, force; /* slow drives: frequency over the eigenfrequency, amplitude over the input's unit */
    int blocks;         /* in the golden file */
};

/* False when there is no trajectory i, 0 <= i < HASH_RUNS: the method refuses the model, or auto would never
 * turn from one method to another. */
bool hash_case(int i, struct hash_case *c);

/* At most `blocks` and c->blocks blocks. Calls `block` after each with the hash of all that the plant is and
 * gives: state, outputs, energy, contact events. NULL, or why it stopped. *pl and scratch[METHOD_SCRATCH] are
 * the caller's; what was counted is in pl->counts. */
const char *hash_run(const struct hash_case *c, int blocks, struct plant *pl, double *scratch,
                     void (*block)(uint32_t hash));

/* The operations one by one (tests/bits/arithmetic.h), 1000 pairs of operands a block. */
void hash_arithmetic(int blocks, void (*block)(uint32_t hash));

#endif
