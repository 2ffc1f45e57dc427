/* stages.h - the actuators and sensors of a plant on a bus: each is a stage before an input or behind an
 * output.
 *
 *     static struct stages stages;
 *     struct app_config c = {.stage_calls = &stages_for_plants, .stages = &stages, ...};
 *
 * An actuator takes its drive's value at the begin of each tick. Over the tick the input runs in a straight
 * line to the actuator's result, so a base never jumps. A sensor takes the output at the end of each tick.
 * Both work in SI; times are those of the real plant, like the model's parameters. The elements of a stage
 * are those settings that are not 0, in this order: gain, slew, hysteresis, creep, resonance, noise, 1/f
 * noise, drift, lag, clip, quantum, delay.
 *
 * The bus's MOTION and CONTACT say what the sensors say. A lock-in slot reads an output's truth or a stage's
 * result. Everything else sees the truth. With a stage on, each tick is taken the general way
 * (docs/reference/stage.md has the costs). */
#ifndef FIRMWARE_STAGES_H
#define FIRMWARE_STAGES_H

#include "firmware/bus/settings.h"
#include "firmware/plant/plant.h"
#include "firmware/stage/stage.h"

STATIC_ASSERT((int)STAGE_SLOTS == (int)PLANT_STAGES, a_slot_is_a_stage);

struct stages {
    double setting[STAGE_SLOTS * STAGE_SETTINGS + 1]; /* in force; the last is the seed */
    struct stage stage[STAGE_SLOTS];
    double from[STAGE_SLOTS];   /* results a tick before */
    double result[STAGE_SLOTS]; /* results of the last tick, SI */
};

extern const struct plant_stage_calls stages_for_plants;

/* A stage by itself, settled at 0, from its STAGE_SETTINGS settings. tick_s: seconds of the real plant a
 * tick; the noise follows from the seed (sensor_seed, below 65536) and the slot, 0 to STAGE_SLOTS - 1. NULL,
 * or why they are refused. */
MUST_CHECK const char *stages_build(struct stage *s, double tick_s, double seed, int slot, const double *own);

#endif
