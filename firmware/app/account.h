/* account.h - what is judged and counted in every frame, whatever is sent. */
#ifndef FIRMWARE_ACCOUNT_H
#define FIRMWARE_ACCOUNT_H

#include <stdint.h>

struct app;

/* Plant time moved by `advanced` frames: raises FAULT_LEDGER where the energy ledger does not balance. It looks once in 100
 * plant frames. */
void account_judge(struct app *a, uint32_t advanced);

/* All counters of HEALTH into count[DIAG_COUNTERS], which is not a->count. */
void account_counts(const struct app *a, uint32_t *count);

#endif
