/* drive.h - one input of the plant as a function of plant time: a harmonic drive, a sampled command and
 * noise, added.
 *
 *     u(t) = amplitude(t) cos(carrier(t) + offset(t)) + sample(t) + noise(t)
 *
 * Phase is an integer (turns * 2^64) and therefore exact after any number of ticks. Changes of amplitude,
 * frequency, phase and noise run over a ramp of whole ticks (at least one). It starts at the instant of
 * the change, inside a tick too. Phase is continuous while a drive sounds; a silent drive starts at the
 * phase commanded.
 *
 * Callers of these functions give model units and ticks and stay within the limits below; plant.h has the
 * interface in SI. The functions check nothing and cannot fail. */
#ifndef FIRMWARE_DRIVE_H
#define FIRMWARE_DRIVE_H

#include <stdbool.h>
#include <stdint.h>
#include "models/check.h"
#include "models/lanes.h"
#include "firmware/method/method.h"
#include "firmware/plant/noise.h"

/* No drive or sample may exceed this many model units: squares and 3/2 powers stay far from overflow. */
#define DRIVE_LIMIT 1e9
#define NOISE_LIMIT (DRIVE_LIMIT / NOISE_PEAK)

/* Fewest ticks in a period of a drive that are sound. rk4 amounts to Simpson's rule over a tick. With four
 * ticks it follows the wave within 2.2e-3 ((pi / 2)^4 / 2880). taylor and exact take the wave itself. */
#define DRIVE_TICKS_MIN     4.0
#define DRIVE_TICKS_TOO_FEW "fewer than 4 steps in a period of "

enum { TICK_FRACTIONS = 65536, PHASOR_RESYNC_TICKS = 256 };

/* The target of a harmonic drive; model units, frequency in turns per tick. */
struct drive_setting {
    double amplitude;
    double turns_per_tick; /* >= 0, < 0.5 */
    double phase_turns;
    uint64_t ramp_ticks; /* 0 counts as 1 */
};

struct drive {
    /* harmonic */
    uint64_t carrier; /* integral of the frequency, turns * 2^64, now */
    uint64_t offset;  /* phase offset, turns * 2^64, now */
    uint64_t step;    /* turns * 2^64 per tick, now */
    double amplitude; /* now, model units */
    /* ramp, while ramp_left > 0 */
    uint64_t ramp_left;   /* in 1/65536 tick */
    uint64_t ramp_length; /* in 1/65536 tick */
    uint64_t step_from, step_to;
    uint64_t offset_from, offset_to;
    double amplitude_from, amplitude_to;
    /* sampled command */
    double sample;       /* now, model units */
    double sample_slope; /* per tick while sample_left > 0 */
    double sample_to;
    uint64_t sample_left; /* in 1/65536 tick */
    struct noise noise;
    /* phasor of carrier + offset now, and its rotation over half a tick at `step` */
    double cosine, sine;
    double half_cosine, half_sine;
    double omega_tick;    /* radians per tick at `step` */
    uint32_t resync_left; /* ticks until the phasor is taken from the integer again */
    bool phasor_kept;     /* only samples were told since it was valid last */
    /* cosine, sine and rotation belong to the current step: no ramp runs, nor a slope that ends in this tick
     */
    bool phasor_valid;
};

/* Silent, at phase zero. */
void drive_init(struct drive *d);

/* Sets the harmonic part now, without a ramp: for initial conditions only, because the input jumps. Sample
 * and noise stay. */
void drive_start(struct drive *d, const struct drive_setting *s);

/* Begins a ramp to a new setting at the current instant; a running ramp is left where it is. Amplitude and
 * frequency go linearly, phase along the shorter way round. The noise goes on to its target along the new
 * ramp; call noise_aim after this to give it another target. */
void drive_change(struct drive *d, const struct drive_setting *s);

/* The setting that the drive has, or is on its way to; ramp_ticks is 0, see d->ramp_left. */
struct drive_setting drive_target(const struct drive *d);

/* The frequency now, also inside a ramp; that of a silent drive means nothing. */
double drive_turns_per_tick(const struct drive *d);

/* A sampled command in model units, |value| <= DRIVE_LIMIT: jumps there now (ticks 0), or moves there
 * linearly over `ticks` whole ticks. */
void drive_sample(struct drive *d, double value, uint64_t ticks);

/* Fractions of a tick until the drive's next corner (end
 * of a ramp or of a sample's slope); UINT64_MAX for none. */
static inline uint64_t drive_corner(const struct drive *d)
{
    if ((d->ramp_left | d->sample_left) == 0)
        return UINT64_MAX;
    uint64_t corner = d->ramp_left > 0 ? d->ramp_left : UINT64_MAX;
    return d->sample_left > 0 && d->sample_left < corner ? d->sample_left : corner;
}

/* The part of the ramp that is done, 0..1; 1 when none runs. */
static inline double drive_ramp_position(const struct drive *d)
{
    return d->ramp_left == 0 ? 1.0 : (double)(d->ramp_length - d->ramp_left) / (double)d->ramp_length;
}

/* The wave has frequency 0, as that of a drive that only samples move: a turn would change nothing. */
static inline bool drive_stands(const struct drive *d)
{
    return d->step == 0;
}

/* True while the drive's input is not identically zero. */
static inline bool drive_active(const struct drive *d)
{
    return d->amplitude != 0.0 || d->sample != 0.0 || d->noise.active || (d->ramp_left | d->sample_left) != 0;
}

/* Takes the segment of `length` that begins now: fills the wave and the inputs at its begin, middle and
 * end, and moves the drive to its end. `length` is 1..65536, in 1/65536 tick, and not beyond drive_corner;
 * ticks_per_time is ticks per model time. Returns false when the wave is just the previous one run on,
 * else true. A whole tick of a steady drive, or of one whose sample is on a slope, costs two complex
 * multiplications; anything else three sines and cosines. Noise is added by noise_add. */
bool drive_segment(struct drive *d, uint32_t length, double ticks_per_time, struct wave *w,
                   struct input *begin, struct input *middle, struct input *end);

/* A phasor turned by a rotation: how the middle of a steady
 * tick follows from its begin, and its end from the middle. */
ALWAYS_INLINE void drive_rotate(double *c, double *s, double rotation_c, double rotation_s)
{
    double turned = unfused(*c * rotation_c) - unfused(*s * rotation_s);
    *s = unfused(*s * rotation_c) + unfused(*c * rotation_s);
    *c = turned;
}

/* The input of a steady wave where its phasor is (c, s). */
ALWAYS_INLINE struct input steady_input(const struct wave *w, double c, double s)
{
    return (struct input){w->offset + unfused(w->amplitude * c), (-w->amplitude * w->omega) * s};
}

/* The sample where a slope has `left` to go, in 1/65536 tick: it ends in sample_to, to the last bit. */
ALWAYS_INLINE double drive_sample_before(const struct drive *d, uint64_t left)
{
    return d->sample_to - d->sample_slope * ((double)(int64_t)left * (1.0 / TICK_FRACTIONS));
}

/* Whole ticks in which a slope goes on; UINT64_MAX without one. */
static inline uint64_t drive_slope_ticks(const struct drive *d)
{
    return d->sample_left == 0 ? UINT64_MAX : d->sample_left / TICK_FRACTIONS;
}

/* Whole ticks of constant amplitude, frequency and sample or slope, in three parts of what drive_segment
 * does. drive_steady comes first, at the start of a tick: it sets the wave but for its phase, and returns the
 * input now. drive_turn fills in some ticks of a block behind the one at whose end its input `at` and its
 * phasor stand. drive_climb does so on a slope: the first of its ticks begins at the sample `begin`, with
 * `left` to go. drive_pass ends `ticks` of them, at most resync_left; the caller puts the phasor in place.
 * The ticks of a drive that stands are alike: nothing turns. */
struct input drive_steady(struct drive *d, double ticks_per_time, struct wave *w);

ALWAYS_INLINE void drive_turn(const struct drive *d, const struct wave *w, struct input *at,
                              struct phasor *phasor, int ticks)
{
#if TICK_LANES >                                                                                             \
    1 /* cosine and sine, and value and rate, side by side: the same bits, half the instructions */
    real_lanes now = *(const lanes_in_memory *)(const void *)phasor;
    const real_lanes turn = {d->half_cosine, d->half_cosine}, cross = {-d->half_sine, d->half_sine};
    const real_lanes factor = {w->amplitude, -w->amplitude * w->omega}, offset = {w->offset, -0.0};
    UNROLL
    for (int k = 1; k <= 2 * ticks; k++) {
        now = now * turn + (real_lanes){now[1], now[0]} * cross;
        *(lanes_in_memory *)(void *)&at[k * MODEL_INPUTS] = offset + factor * now;
        if (k % 2 == 0)
            *(lanes_in_memory *)(void *)&phasor[k / 2 * MODEL_INPUTS] = now;
    }
#else
    double c = phasor->cosine, s = phasor->sine;
    for (int k = 1; k <= 2 * ticks; k++) {
        drive_rotate(&c, &s, d->half_cosine, d->half_sine);
        at[k * MODEL_INPUTS] = steady_input(w, c, s);
        if (k % 2 == 0)
            phasor[k / 2 * MODEL_INPUTS] = (struct phasor){c, s};
    }
#endif
}

/* As drive_turn, but what it fills in is right at the ends of ticks only: all that a method with books of its
 * own looks at. */
ALWAYS_INLINE void drive_turn_ends(const struct drive *d, const struct wave *w, struct input *at,
                                   struct phasor *phasor, uint32_t ticks)
{
#if TICK_LANES > 1
    for (uint32_t k = 0; k < ticks; k++)
        drive_turn(d, w, &at[2 * k * MODEL_INPUTS], &phasor[k * MODEL_INPUTS], 1);
#else
    double c = phasor->cosine, s = phasor->sine;
    for (uint32_t k = 1; k <= ticks; k++) {
        drive_rotate(&c, &s, d->half_cosine, d->half_sine);
        drive_rotate(&c, &s, d->half_cosine, d->half_sine);
        at[2 * k * MODEL_INPUTS] = steady_input(w, c, s);
        phasor[k * MODEL_INPUTS] = (struct phasor){c, s};
    }
#endif
}

void drive_climb(const struct drive *d, const struct wave *w, uint64_t left, double begin, struct input *at,
                 struct phasor *phasor, uint32_t ticks);

/* The slope goes on by whole ticks. */
void drive_pass_slope(struct drive *d, uint32_t ticks);

static inline void drive_pass(struct drive *d, uint32_t ticks)
{
    d->carrier += ticks * d->step;
    d->resync_left -= ticks;
    if (d->sample_left > 0)
        drive_pass_slope(d, ticks);
}

/* The unit of the input changed: every amplitude, sample and deviation times `factor`. */
void drive_rescale(struct drive *d, double factor);

#endif
