/* app_parts.h - what the files of the app share with each other and nobody else. */
#ifndef FIRMWARE_APP_PARTS_H
#define FIRMWARE_APP_PARTS_H

#include "firmware/app.h"

/* Every drive and sample to zero over ramp_s (at least one tick); nothing that waits may follow. */
void app_drives_to_zero(struct app *a, double ramp_s);

/* No more commands until an ENABLE that knows of it; nothing that waits may follow. */
void app_end_session(struct app *a);

/* A good heartbeat was received in this frame. */
void app_hear_heartbeat(struct app *a);

/* Bus frames since the last good heartbeat, those that the plant has missed among them. */
uint64_t app_command_age(const struct app *a);

/* SELF_TEST goes out again, where there was one. */
void app_tell_selftest(struct app *a);

/* Every item of INFO goes out again, IDENTITY first. */
void app_tell_info(struct app *a);

/* Restarts what depends on settings. */
void app_settings_changed(struct app *a);

/* Settings that name an input or an output must fit the model: NULL, or what does not. */
MUST_CHECK const char *app_check_settings(const struct model *m, const double *setting);

/* NULL where there is nothing to climb to (any more), or from these parameters the plant could; else the reason. */
MUST_CHECK const char *app_could_climb(const struct app *a, const double *si);

/* The parameters and settings with `staged` laid over them: NULL, or why the whole set is refused. */
MUST_CHECK const char *app_check_parameters(const struct app *a, const struct staged *staged);

/* Applies a checked set as a whole and marks it for the echo. False when it no longer fits: nothing changed. */
bool app_apply_parameters(struct app *a, struct staged *staged);

/* Plant time has come to a frame's start, or to a fire's instant: the sampled commands of that frame; the armed drives. */
void app_apply_samples(struct app *a, uint64_t frame);
void app_apply_fire(struct app *a, const struct fire *f);

/* The plant's share of a bus frame, and frames to make up for. Returns how many plant frames plant time moved. */
uint32_t app_advance(struct app *a);

/* What a handler wants to say beyond its cause. */
struct remark {
    unsigned index;
    uint64_t ticks_late;
};

/* The 64-bit number nearest to `now` that ends in these 32 (16) bits. */
static inline uint64_t nearest_32(uint64_t now, double low)
{
    return now + (uint64_t)(int64_t)(int32_t)((uint32_t)low - (uint32_t)now);
}

static inline uint64_t nearest_16(uint64_t now, double low)
{
    return now + (uint64_t)(int64_t)(int16_t)((uint16_t)low - (uint16_t)now);
}

/* The commands ARM, FIRE and STREAM. */
enum cause drives_arm(struct app *a, const struct message *m, struct remark *r);
enum cause drives_fire(struct app *a, const struct message *m, struct remark *r);
enum cause drives_stream(struct app *a, const struct message *m, struct remark *r);

/* The commands PARAM_WRITE, PARAM_COMMIT and PARAM_READ. */
enum cause parameters_write(struct app *a, const struct message *m);
enum cause parameters_commit(struct app *a, const struct message *m);
enum cause parameters_read(struct app *a, const struct message *m);

#endif
