/* app_apply.h - commands whose time has come: what they do to the drives. */
#ifndef FIRMWARE_APP_APPLY_H
#define FIRMWARE_APP_APPLY_H

#include <stdbool.h>
#include <stdint.h>

struct app;
struct fire;

/* Call it when plant time is at the start of plant frame `frame`. Every input's sample for this frame
 * acts: as a jump, or as a line over one frame where the setting stream_linear_N is 1. An input that has
 * had samples in this session and now lacks one is counted in stream_missed; its value stays. */
void app_apply_samples(struct app *a, uint64_t frame);

/* Call it when plant time is at tick i of a frame, in a session with blocks of codes: the codes of the DACs
 * for this tick act. Where there are none the last ones stay, which counts in stream_missed. */
void app_apply_codes(struct app *a, uint32_t i);

/* Call it when this tick has ended: the codes of the ADCs take their place. */
void app_read_codes(struct app *a, uint32_t i);

/* Call it when plant time is at a fire's instant. The armed drives and the parameter set that it carries
 * act together. Returns true when a parameter set acted: then all lock-in windows have begun anew. If the
 * set no longer fits, because the plant has climbed to the full model meanwhile, nothing acts and a second
 * REPLY says CAUSE_RANGE. */
bool app_apply_fire(struct app *a, const struct fire *f);

#endif
