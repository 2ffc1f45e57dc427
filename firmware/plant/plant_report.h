/* plant_report.h - a plant's outputs, energies, energy balance, time, and the hash of its state. */
#ifndef FIRMWARE_PLANT_REPORT_H
#define FIRMWARE_PLANT_REPORT_H

#include "firmware/plant/plant.h"

/* Writes output[n_outputs] now, SI, in the order of the model's output table. */
void plant_output(const struct plant *pl, double *output);

/* The output `name` now, SI; NaN when the model has no such output. Where a stage is on, stage_0 to stage_3
 * are their results at the end of the last tick; a stage that is off gives 0. It computes all outputs: to
 * read several, use plant_output. */
double plant_read(const struct plant *pl, const char *name);

/* The stored energy now, and the energy that the ledger cannot account for since it began (ledger.h); J. */
double plant_energy(const struct plant *pl);
double plant_residual(const struct plant *pl);

/* The share of energy that did not balance since the last call: |change of residual| over the energy that
 * flowed since then and the stored energy above rest. 0.01 means that 1 % was lost or gained. Two parts
 * are forgiven: the rounding of the stored energy, and the error of a method that errs by its tolerance of
 * the largest motion so far. *residual_J holds the residual of the last call (0 at first) and takes the
 * present one. Resets the ledger's `gross`, so only one caller may ask. */
double plant_imbalance(struct plant *pl, double *residual_J);

/* Seconds of bus time: (tick + fraction/65536) * tick_s in double; the tick itself is exact. */
double plant_time(const struct plant *pl);

/* FNV-1a, 64 bits, over the bits of tick, regime, parameters, state, drives and ledger, in a fixed order.
 * It does not cover model, method, events and counts. */
uint64_t plant_hash(const struct plant *pl);

#endif
