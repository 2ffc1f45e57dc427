/* sensor.h - faults of the sensors between the plant's outputs and the bus: what MOTION and CONTACT say, and nothing else.
 *
 * Four signals, each with the faults of its settings, in this order: the value of `delay` plant frames ago, plus
 * `offset`, plus noise of standard deviation `noise`, held within +-`saturation`, rounded to the nearest multiple of
 * `quantum`; a `stuck` one repeats what it said last. 0 is no fault of its kind. Noise is the standard normal deviate
 * (noise.h) of word k of sequence 2^32 (MODEL_INPUTS + signal) + seed, k the plant frame in which it is sent: a
 * function of the frame alone, and none of the sequences of the inputs. A value that is not available (NaN) stays so.
 *
 * Everything that belongs to the plant sees the truth: state, ledger, hash, events and the watch, and also lock-in and
 * capture, which look at each tick where a bus sensor is sampled once a frame, and against which a test compares what the
 * faulty sensor said. 40 instructions a signal without a fault, 20 a frame for the ring. */
#ifndef FIRMWARE_SENSOR_H
#define FIRMWARE_SENSOR_H

#include <stdint.h>
#include "firmware/bus/settings.h"

enum { SENSOR_RING = SENSOR_DELAY_MAX + 1 /* frames: the present one, and those before it */ };

struct sensor {
    uint64_t frame;  /* plant frame of the newest values */
    uint32_t active; /* bit k: setting SET_SENSOR_OFFSET + k is not 0 */
    uint32_t newest; /* place in the ring */
    /* true values, SI; NaN: before the first frame */
    double past[SENSOR_RING][SENSOR_SIGNALS];
};

/* No frame seen; then sensor_change says which faults there are. */
void sensor_init(struct sensor *s);

/* The settings changed. */
void sensor_change(struct sensor *s, const double *setting);

/* The true outputs, SI, at the end of a plant frame; each frame has its own, sent or not. */
void sensor_record(struct sensor *s, uint64_t frame, const double *output);

/* The reading of signal i in the newest frame. *said holds what the signal said last (NaN: nothing yet), and takes the
 * new reading. */
double sensor_read(const struct sensor *s, const double *setting, int i, double *said);

#endif
