/* account.h - judges the energy balance and collects the counters, in every frame and whatever is sent. */
#ifndef FIRMWARE_ACCOUNT_H
#define FIRMWARE_ACCOUNT_H

#include <stdint.h>

struct app;

/* Call it once per bus frame, after plant time has moved by `advanced` plant frames (0: plant time
 * stands). Once in 100 plant frames it asks plant_imbalance for the share of energy that does not balance.
 * A share above the setting ledger_alarm, or one that is not a number, latches FAULT_LEDGER; the plant
 * goes on. */
void account_judge(struct app *a, uint32_t advanced);

/* Writes all counters of HEALTH, in the order of enum diag, into count[DIAG_COUNTERS]. Changes nothing in
 * the app; `count` must not be a->count. Tick and frame numbers are given by their low 32 bits. */
void account_counts(const struct app *a, uint32_t *count);

#endif
