/* drive.c - see drive.h. */
#include "firmware/plant/drive.h"

#include <math.h>
#include "models/check.h"
#include "models/math/elementary.h"

#define TURN_RAD (2.0 * ELEMENTARY_PI)
#define TWO_64   18446744073709551616.0

/* Part `length`/65536 of a phase step. */
static uint64_t phase_part(uint64_t step, uint32_t length)
{
    return (step >> 16) * length + (((step & 0xFFFFu) * length) >> 16);
}

/* from + (to - from) x along the shorter way round, 0 <= x <= 1. In ramps of more than 2^61 parts of a
 * tick the position rounds to 1 before the end. Then half a turn, as a double, is one more than int64_t
 * holds: hence the case x >= 1. */
static uint64_t phase_between(uint64_t from, uint64_t to, double x)
{
    int64_t way = (int64_t)(to - from);
    if (x >= 1.0)
        return to;
    return from + (uint64_t)(int64_t)((double)way * x);
}

/* Turns per tick, [0, 0.5), to a phase step; keeps every bit of the double. */
static uint64_t step_of(double turns_per_tick)
{
    return (uint64_t)(int64_t)(turns_per_tick * TWO_64);
}

void drive_init(struct drive *d)
{
    *d = (struct drive){.cosine = 1.0, .half_cosine = 1.0};
    noise_init(&d->noise, 0, false);
}

static void drop_phasor(struct drive *d)
{
    d->phasor_valid = d->phasor_kept = false;
}

void drive_start(struct drive *d, const struct drive_setting *s)
{
    d->carrier = 0;
    d->offset = turns_of(s->phase_turns);
    d->step = step_of(s->turns_per_tick);
    d->amplitude = s->amplitude;
    d->ramp_left = 0;
    drop_phasor(d);
}

void drive_change(struct drive *d, const struct drive_setting *s)
{
    uint64_t ticks = s->ramp_ticks > 0 ? s->ramp_ticks : 1;
    bool silent = d->amplitude == 0.0 && (d->ramp_left == 0 || d->amplitude_to == 0.0);
    noise_leave(&d->noise);
    if (silent) {
        drive_start(d, s);
        d->amplitude = 0.0;
    }
    d->step_from = d->step;
    d->step_to = step_of(s->turns_per_tick);
    d->offset_from = d->offset;
    d->offset_to = turns_of(s->phase_turns);
    d->amplitude_from = d->amplitude;
    d->amplitude_to = s->amplitude;
    d->ramp_length = ticks * TICK_FRACTIONS;
    d->ramp_left = d->ramp_length;
    drop_phasor(d);
}

struct drive_setting drive_target(const struct drive *d)
{
    bool ramp = d->ramp_left > 0;
    uint64_t step = ramp ? d->step_to : d->step;
    uint64_t offset = ramp ? d->offset_to : d->offset;
    return (struct drive_setting){ramp ? d->amplitude_to : d->amplitude, (double)step / TWO_64,
                                  turns_to_double(offset), 0};
}

double drive_turns_per_tick(const struct drive *d)
{
    return (double)d->step / TWO_64;
}

void drive_sample(struct drive *d, double value, uint64_t ticks)
{
    d->sample_to = value;
    d->sample_left = ticks * TICK_FRACTIONS;
    if (ticks > 0)
        d->sample_slope = (value - d->sample) / (double)ticks;
    else
        d->sample = value;
    d->phasor_kept = d->phasor_valid || d->phasor_kept;
    d->phasor_valid = false;
}

/* The harmonic part over a segment inside a ramp or shorter than a tick; returns its phase advance. Phase
 * and amplitude at its end come from the ramp's closed form. The frequency is the mean over the segment. */
static uint64_t ramp_advance(struct drive *d, uint32_t length)
{
    uint64_t offset = d->offset;
    uint64_t advance;
    if (d->ramp_left == 0) {
        advance = phase_part(d->step, length);
        d->carrier += advance;
        return advance;
    }
    double whole = (double)d->ramp_length;
    double begin = (double)(d->ramp_length - d->ramp_left);
    double middle = (begin + 0.5 * (double)length) / whole;
    d->ramp_left -= length;
    if (d->ramp_left == 0) {
        d->offset = d->offset_to;
        d->amplitude = d->amplitude_to;
        d->step = d->step_to;
    } else {
        double end = (begin + (double)length) / whole;
        d->offset = phase_between(d->offset_from, d->offset_to, end);
        d->step = phase_between(d->step_from, d->step_to, end);
        d->amplitude = d->amplitude_from + (d->amplitude_to - d->amplitude_from) * end;
    }
    advance = phase_part(phase_between(d->step_from, d->step_to, middle), length);
    d->carrier += advance;
    return advance + (d->offset - offset);
}

static void sample_advance(struct drive *d, uint32_t length)
{
    if (d->sample_left == 0)
        return;
    d->sample_left -= length;
    d->sample = drive_sample_before(d, d->sample_left);
}

/* Input of a wave at model time `time` from its start, where its phasor is (c, s). */
static void wave_input(const struct wave *w, double time, double c, double s, struct input *u)
{
    double amplitude = w->amplitude + w->growth * time;
    u->value = (w->offset + w->slope * time) + amplitude * c;
    u->rate = (w->slope + w->growth * c) - amplitude * w->omega * s;
}

/* Inside a ramp, at a slope, or for part of a tick. */
NEVER_INLINE void segment_general(struct drive *d, uint32_t length, double ticks_per_time, struct wave *w,
                                  struct input *begin, struct input *middle, struct input *end)
{
    double part = (double)length / TICK_FRACTIONS;
    double per_time = ticks_per_time / part;
    double amplitude = d->amplitude, sample = d->sample;
    uint64_t phase = d->carrier + d->offset;
    uint64_t offset = d->offset;
    uint64_t advance = ramp_advance(d, length);
    /* A phase ramp may turn the wave backwards; one that turns it forwards is up to a whole turn, with the
       carrier's advance. */
    bool forwards = (int64_t)(d->offset - offset) > 0;
    uint64_t half = forwards ? advance >> 1 : (uint64_t)((int64_t)advance / 2);
    double turns = turns_to_double(advance), c1, s1, c2, s2;
    if (forwards && turns < 0.0)
        turns += 1.0;
    sample_advance(d, length);
    cos_sin_turns(phase, &w->cosine, &w->sine);
    cos_sin_turns(phase + half, &c1, &s1);
    cos_sin_turns(phase + advance, &c2, &s2);
    w->offset = sample;
    w->slope = (d->sample - sample) * per_time;
    w->amplitude = amplitude;
    w->growth = (d->amplitude - amplitude) * per_time;
    w->omega = turns * TURN_RAD * per_time;
    double time = 1.0 / per_time;
    wave_input(w, 0.0, w->cosine, w->sine, begin);
    wave_input(w, 0.5 * time, c1, s1, middle);
    wave_input(w, time, c2, s2, end);
    d->cosine = c2;
    d->sine = s2;
    drop_phasor(d);
}

/* The phasor from the integer phase; one that a sample left as it was serves until it is due. */
NEVER_INLINE void synchronise(struct drive *d)
{
    d->phasor_valid = true;
    if (d->phasor_kept && d->resync_left > 0)
        return;
    cos_sin_turns(d->carrier + d->offset, &d->cosine, &d->sine);
    cos_sin_turns(d->step >> 1, &d->half_cosine, &d->half_sine);
    d->omega_tick = turns_to_double(d->step) * TURN_RAD;
    d->resync_left = PHASOR_RESYNC_TICKS;
}

ALWAYS_INLINE struct input begin_steady(struct drive *d, double ticks_per_time, struct wave *w)
{
    if (!d->phasor_valid || d->resync_left == 0)
        synchronise(d);
    w->offset = d->sample;
    w->slope = d->sample_left > 0 ? d->sample_slope * ticks_per_time : 0.0;
    w->amplitude = d->amplitude;
    w->growth = 0.0;
    w->omega = d->omega_tick * ticks_per_time;
    struct input u = steady_input(w, d->cosine, d->sine);
    if (d->sample_left > 0)
        u.rate += w->slope;
    return u;
}

struct input drive_steady(struct drive *d, double ticks_per_time, struct wave *w)
{
    return begin_steady(d, ticks_per_time, w);
}

static void rise(struct input *u, double sample, double slope)
{
    u->value += sample;
    u->rate += slope;
}

void drive_climb(const struct drive *d, const struct wave *w, uint64_t left, double begin, struct input *at,
                 struct phasor *phasor, uint32_t ticks)
{
    const struct wave turning = {.amplitude = w->amplitude, .omega = w->omega};
    const bool turns = !drive_stands(d) || d->amplitude != 0.0;
    for (uint32_t k = 0; k < ticks; k++, at += 2 * MODEL_INPUTS, phasor += MODEL_INPUTS) {
        left -= TICK_FRACTIONS;
        double end = drive_sample_before(d, left);
        struct input *middle = &at[MODEL_INPUTS], *last = &at[2 * MODEL_INPUTS];
        if (turns) {
            drive_turn(d, &turning, at, phasor, 1);
        } else {
            *middle = *last = (struct input){0.0, 0.0};
            phasor[MODEL_INPUTS] = *phasor;
        }
        rise(middle, 0.5 * (begin + end), w->slope);
        rise(last, end, w->slope);
        begin = end;
    }
}

void drive_pass_slope(struct drive *d, uint32_t ticks)
{
    if (ticks == 0)
        return;
    d->sample_left -= (uint64_t)ticks * TICK_FRACTIONS;
    d->sample = drive_sample_before(d, d->sample_left);
    if (d->sample_left < TICK_FRACTIONS) {
        d->phasor_valid = false;
        d->phasor_kept = true;
    }
}

/* A whole tick on a slope, after drive_steady. */
NEVER_INLINE void climb_once(struct drive *d, struct wave *w, struct input *middle, struct input *end)
{
    struct input at[3][MODEL_INPUTS];
    struct phasor phasor[2][MODEL_INPUTS];
    phasor[0][0] = (struct phasor){d->cosine, d->sine};
    w->cosine = d->cosine;
    w->sine = d->sine;
    drive_climb(d, w, d->sample_left, d->sample, &at[0][0], &phasor[0][0], 1);
    *middle = at[1][0];
    *end = at[2][0];
    d->cosine = phasor[1][0].cosine;
    d->sine = phasor[1][0].sine;
    drive_pass(d, 1);
}

/* The tick after drive_steady. */
ALWAYS_INLINE void turn(struct drive *d, struct wave *w, struct input *middle, struct input *end)
{
    double c = d->cosine, s = d->sine;
    w->cosine = c;
    w->sine = s;
    drive_rotate(&c, &s, d->half_cosine, d->half_sine);
    *middle = steady_input(w, c, s);
    drive_rotate(&c, &s, d->half_cosine, d->half_sine);
    *end = steady_input(w, c, s);
    d->cosine = c;
    d->sine = s;
    drive_pass(d, 1);
}

bool drive_segment(struct drive *d, uint32_t length, double ticks_per_time, struct wave *w,
                   struct input *begin, struct input *middle, struct input *end)
{
    bool steady = d->phasor_valid && length == TICK_FRACTIONS;
    if (steady || (length == TICK_FRACTIONS && d->ramp_left == 0 && drive_slope_ticks(d) > 0)) {
        *begin = begin_steady(d, ticks_per_time, w);
        if (d->sample_left > 0)
            climb_once(d, w, middle, end);
        else
            turn(d, w, middle, end);
    } else {
        segment_general(d, length, ticks_per_time, w, begin, middle, end);
    }
    return !steady;
}

void drive_rescale(struct drive *d, double factor)
{
    d->amplitude *= factor;
    d->amplitude_from *= factor;
    d->amplitude_to *= factor;
    d->sample *= factor;
    d->sample_slope *= factor;
    d->sample_to *= factor;
    noise_rescale(&d->noise, factor);
    drop_phasor(d);
}
