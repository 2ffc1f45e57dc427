/* sensor.h - faults of the sensors between the plant's outputs and the bus: what MOTION and CONTACT say, and
 * nothing else.
 *
 * Each of four signals has the faults of its settings, in this order. The value of `delay` plant frames ago
 * is taken. `offset` is added, and noise of standard deviation `noise`. The sum is held within +-`saturation`
 * and rounded to the nearest multiple of `quantum`. A `stuck` one repeats its last value. 0 is no fault of
 * its kind. Noise is the standard normal deviate (noise.h) of word k of sequence 2^32 (MODEL_INPUTS + signal)
 * + seed. k is the plant frame in which it is sent. So it is a function of the frame alone, and no sequence
 * of an input. A value that is not available (NaN) stays so.
 *
 * Everything that belongs to the plant sees the truth: state, ledger, hash, events and the watch. Lock-in and
 * capture see it, too, so that a test can compare the faulty values with them. They look at each tick, but a
 * bus sensor is sampled once a frame. 40 instructions a signal without a fault, 20 a frame for the ring. */
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

/* Starts without any frame: until sensor_record was called, readings are NaN. Call sensor_change next. */
void sensor_init(struct sensor *s);

/* Notes which faults setting[SETTINGS] asks for. Call it after each change of settings. */
void sensor_change(struct sensor *s, const double *setting);

/* Takes the first SENSOR_SIGNALS of the true outputs, SI, at the end of plant frame `frame`. Call it in
 * every plant frame, also where nothing is sent: delays count frames. */
void sensor_record(struct sensor *s, uint64_t frame, const double *output);

/* Returns the reading, SI, of signal i (0..SENSOR_SIGNALS - 1) in the newest frame; NaN where it is not
 * available. *said holds the signal's last reading (NaN: none yet), which a stuck signal repeats; the new
 * reading is stored there. */
double sensor_read(const struct sensor *s, const double *setting, int i, double *said);

#endif
