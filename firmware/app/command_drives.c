/* command_drives.c - the commands that move the inputs: ARM, FIRE, STREAM and DAC. */
#include "firmware/app/command_drives.h"

#include <float.h>
#include <math.h>
#include "firmware/app/app.h"
#include "firmware/app/parameters.h"
#include "firmware/app/telemetry_send.h"

/* Frames that a sample may be ahead. A sample names its frame by 16 bits, which repeat every 65536 frames.
 * With a short reach a sample that was delayed by about that long is hardly ever taken for a new one. */
enum { STREAM_AHEAD = 64 };

static const double ramp_max_s = 1e4;
static const double phase_max_rad = 1e6;
static const double seed_max = 16777215.0; /* whole numbers up to here are exact as float32 */

static bool can_move(const struct app *a)
{
    return a->state == STATE_RUNNING || a->state == STATE_PAUSED;
}

static bool arm_accepts(const struct app *a, int channel, unsigned field, double value)
{
    double unit = scale_of(&a->plant.scale, a->plant.model->input_signal[channel].quantity);
    double min = field == ARM_NOISE_HOLD ? 1.0 : 0.0, max = ramp_max_s;
    if (field == ARM_AMPLITUDE)
        min = -(max = DRIVE_LIMIT * unit);
    if (field == ARM_FREQUENCY)
        max = (1.0 + (double)FLT_EPSILON) / (DRIVE_TICKS_MIN * a->plant.tick_s); /* it came as a float32 */
    if (field == ARM_PHASE)
        min = -(max = phase_max_rad);
    if (field == ARM_NOISE)
        max = NOISE_LIMIT * unit;
    if (field == ARM_NOISE_HOLD)
        max = NOISE_HOLD_MAX;
    if (field == ARM_NOISE_SEED)
        max = seed_max;
    return value >= min && value <= max && (field < ARM_NOISE_HOLD || value == (double)(uint32_t)value);
}

enum cause drives_arm(struct app *a, const struct message *m, struct remark *r)
{
    int channel = m->kind - WIRE_ARM;
    unsigned field = (unsigned)m->value[ARM_FIELD];
    double value = m->value[ARM_VALUE];
    r->index = field;
    if (field >= ARM_FIELDS || channel >= a->plant.model->n_inputs)
        return CAUSE_UNKNOWN;
    if (!arm_accepts(a, channel, field, value))
        return CAUSE_RANGE;
    a->mailbox.armed[channel].given |= (uint8_t)(1u << field);
    a->mailbox.armed[channel].value[field] = value;
    return CAUSE_OK;
}

/* The instant a FIRE names against plant time: late, too far ahead, or fine. */
static enum cause check_instant(const struct app *a, struct instant at, struct remark *r)
{
    uint64_t horizon = (uint64_t)a->setting[SET_HORIZON_FRAMES] * a->config.substeps;
    if ((int64_t)(at.tick - a->plant.now.tick) < 0) {
        r->ticks_late = a->plant.now.tick - at.tick;
        return CAUSE_LATE;
    }
    return at.tick - a->plant.now.tick > horizon ? CAUSE_STALE : CAUSE_OK;
}

enum cause drives_fire(struct app *a, const struct message *m, struct remark *r)
{
    struct mailbox *b = &a->mailbox;
    struct fire f = {.channels = (uint8_t)m->value[FIRE_CHANNELS],
                     .parameters = m->value[FIRE_PARAMETERS] != 0.0};
    f.at.tick = wire_nearest_32(a->plant.now.tick, m->value[FIRE_TICK]);
    f.at.fraction = (uint32_t)(m->value[FIRE_FRACTION] * TICK_FRACTIONS);
    f.counter = m->counter;
    f.received_tick = a->plant.now.tick;
    if (!can_move(a))
        return CAUSE_STATE;
    enum cause cause = check_instant(a, f.at, r);
    if (cause != CAUSE_OK)
        return cause;
    if (f.channels >> a->plant.model->n_inputs)
        return CAUSE_UNKNOWN;
    if ((f.channels == 0 && !f.parameters) || (f.parameters && !b->commit_with_fire))
        return CAUSE_INCOMPLETE;
    for (int i = 0; i < a->plant.model->n_inputs; i++) {
        if (((f.channels >> i) & 1) && b->armed[i].given == 0)
            return CAUSE_INCOMPLETE;
        if ((f.channels >> i) & 1)
            f.armed[i] = b->armed[i];
    }
    if (f.parameters && parameters_check(a, &b->committed))
        return CAUSE_RANGE;
    if (!mailbox_put_fire(b, &f))
        return CAUSE_FULL;
    for (int i = 0; i < a->plant.model->n_inputs; i++) {
        if ((f.channels >> i) & 1)
            b->armed[i].given = 0;
    }
    if (f.parameters)
        b->commit_with_fire = false;
    return CAUSE_OK;
}

enum cause drives_stream(struct app *a, const struct message *m, struct remark *r)
{
    int channel = m->kind - WIRE_STREAM;
    double value = m->value[STREAM_SAMPLE];
    uint64_t now = a->plant.now.tick / a->config.substeps;
    struct sample s = {.frame = wire_nearest_16(now, m->value[STREAM_FRAME]), .channel = (uint8_t)channel};
    s.counter = m->counter;
    s.received_tick = a->plant.now.tick;
    s.value = (float)value;
    r->index = (unsigned)channel;
    if (channel >= a->plant.model->n_inputs)
        return CAUSE_UNKNOWN;
    if (!can_move(a))
        return CAUSE_STATE;
    double limit = DRIVE_LIMIT * scale_of(&a->plant.scale, a->plant.model->input_signal[channel].quantity);
    if (!(fabs(value) <= limit))
        return CAUSE_RANGE;
    if ((int64_t)(s.frame - now) < 0) {
        r->ticks_late = (now - s.frame) * a->config.substeps;
        return CAUSE_LATE;
    }
    if (s.frame - now > STREAM_AHEAD || s.frame - now > (uint64_t)a->setting[SET_HORIZON_FRAMES])
        return CAUSE_STALE;
    return mailbox_put_sample(&a->mailbox, &s) ? CAUSE_OK : CAUSE_FULL;
}

enum cause drives_codes(struct app *a, const struct message *m, struct remark *r)
{
    const struct plant_stage_calls *calls = a->config.stage_calls;
    struct code_block *b = &a->mailbox.block;
    uint64_t now = a->plant.now.tick, tick = wire_nearest_16(now, m->value[DAC_TICK]), i = tick - now;
    if (!calls || !calls->dac)
        return CAUSE_UNKNOWN;
    if (!can_move(a))
        return CAUSE_STATE;
    if ((int64_t)i < 0) {
        r->ticks_late = now - tick;
        return CAUSE_LATE;
    }
    /* No room for a block in here, or on the bus for the last one. */
    if (a->config.substeps > MAILBOX_CODES || telemetry_waits(&a->telemetry, a, WIRE_ADC))
        return CAUSE_FULL;
    if (i >= a->config.substeps)
        return CAUSE_STALE;
    b->given |= UINT32_C(1) << i;
    b->code[i][0] = (int16_t)m->value[DAC_DITHER];
    b->code[i][1] = (int16_t)m->value[DAC_Z];
    a->streaming |= APP_STREAMING_CODES;
    return CAUSE_OK;
}
