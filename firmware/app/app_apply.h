/* app_apply.h - commands whose time has come: what they do to the drives. */
#ifndef FIRMWARE_APP_APPLY_H
#define FIRMWARE_APP_APPLY_H

#include <stdbool.h>
#include <stdint.h>

struct app;
struct fire;

/* Plant time has come to the start of `frame`: its sampled commands act. */
void app_apply_samples(struct app *a, uint64_t frame);

/* Plant time has come to a fire's instant: the armed drives and the parameter set that it carries act. True
 * when a set acted: then all windows have begun anew. */
bool app_apply_fire(struct app *a, const struct fire *f);

#endif
