/* lockin_slots.h - the lock-in of a plant: slots that each measure one output at a harmonic of one drive.
 *
 * All slots share one window. It begins anew when a drive begins to sound or falls silent, and with each set
 * of parameters or settings. It also does when a fault or a climb has ended a frame inside. A slot measures
 * while its drive sounds; harmonic 0 is the mean under the window, tones and all, and needs no drive.
 *
 * A tone is told without what leaks into it (lockin_fit.h): the mean, the waves of all drives that sound, and
 * for harmonics above 1 the slot's own drive too. Drives of equal frequency have one tone together. Other
 * harmonics of the output leak as lockin.h says.
 *
 * In each tick an output costs its sums with each drive that sounds, a harmonic above 1 one more. The rest is
 * done at the end of the window. */
#ifndef FIRMWARE_LOCKIN_SLOTS_H
#define FIRMWARE_LOCKIN_SLOTS_H

#include "firmware/bus/settings.h"
#include "firmware/observe/lockin_fit.h"
#include "firmware/plant/plant.h"

/* A finished window. */
struct lockin_result {
    uint32_t number;         /* windows finished so far */
    double amplitude, phase; /* SI, rad; NaN: not available */
};

struct lockin_output {
    double reference; /* the output at the begin of the window: what is summed is the rest */
    double mean;      /* sum w y */
    struct lockin_sum drive[MODEL_INPUTS]; /* those that sound, in rising order */
};

struct lockin_slots {
    struct lockin_window window;
    unsigned sounding;                         /* bit i: drive i sounds in this window */
    double turns[MODEL_INPUTS];                /* since the window began, by the drives that sound */
    struct lockin_output output[LOCKIN_SLOTS]; /* that of slot i, unless a slot before has the same one */
    struct {
        uint8_t harmonic, drive, output;
        uint8_t first;         /* the first slot with this output */
        struct lockin_sum sum; /* where the harmonic is above 1 */
        struct lockin_result result;
    } slot[LOCKIN_SLOTS];
    uint32_t n_short, n_close; /* results that were not available, by cause */
};

/* The work of each tick in a frame: the mean of each output, its sums with the drives that sound, and those
 * at harmonics above 1. */
struct lockin_frame {
    struct lockin_slots *slots;
    int n_slots; /* that measure */
    int n_outputs, n_drives, n_harmonics;
    struct {
        struct lockin_output *sums;
        int number, n_drives; /* the model's output; 0 drives where only its mean is asked for */
    } output[LOCKIN_SLOTS];
    struct {
        const struct drive *drive;
        int number;
    } drive[MODEL_INPUTS];
    struct {
        struct lockin_sum *sum;
        const struct drive *drive;
        uint32_t harmonic;
        int number; /* which drive that is */
        int output; /* place in `output` */
    } harmonic[LOCKIN_SLOTS];
};

/* Takes settings that were not refused, and begins a window of lockin_frames frames of so many ticks. Results
 * so far stay. */
void lockin_slots_change(struct lockin_slots *l, const double *setting, uint32_t frame_ticks);

/* At the begin of a frame of so many ticks: says what is to be done in them. `frame->n_slots` 0: nothing. */
void lockin_slots_begin_frame(struct lockin_slots *l, const struct plant *pl, uint32_t ticks,
                              struct lockin_frame *frame);

/* A plant_look for each tick of a frame that has slots; `frame` is its struct lockin_frame. */
void lockin_slots_tick(void *frame, const struct plant *pl);

/* A plant_look_ticks for the same: several ticks to the same bits. */
void lockin_slots_ticks(void *frame, const struct plant *pl, const struct method_block *b, uint32_t from,
                        uint32_t n);

/* At the end of the frame: where it ends the window, each slot that measures has a result. */
void lockin_slots_end_frame(const struct lockin_frame *frame, const struct plant *pl);

#endif
