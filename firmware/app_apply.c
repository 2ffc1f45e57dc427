/* app_apply.c - commands whose time has come: what they do to the drives. */
#include "firmware/app_apply.h"

#include <string.h>
#include "firmware/app.h"
#include "firmware/parameters.h"
#include "models/elementary.h"

static void note_latency(struct app *a, unsigned kind, unsigned counter, uint64_t received_tick)
{
    a->latency = (struct latency){a->latency.number + 1, (uint8_t)kind, (uint8_t)counter, received_tick,
                                  a->plant.now.tick};
}

void app_apply_samples(struct app *a, uint64_t frame)
{
    struct sample s;
    for (int i = 0; i < a->plant.model->n_inputs; i++) {
        if (!mailbox_take_sample(&a->mailbox, frame, i, &s)) {
            a->count[DIAG_STREAM_MISSED] += (a->streaming >> i) & 1u;
            continue;
        }
        bool linear = a->setting[SET_STREAM_LINEAR + i] != 0.0;
        plant_sample(&a->plant, i, s.value, linear ? a->config.substeps : 0);
        a->plant.counts.changes++;
        a->streaming |= 1u << i;
        a->count[DIAG_STREAM_APPLIED]++;
        note_latency(a, WIRE_STREAM + (unsigned)i, s.counter, s.received_tick);
    }
}

static void aim_noise(struct noise *n, const struct armed *armed, double unit)
{
    struct noise_setting to = noise_target(n);
    if (armed->given & (1 << ARM_NOISE))
        to.deviation = armed->value[ARM_NOISE] / unit;
    if (armed->given & (1 << ARM_NOISE_HOLD))
        to.hold = (uint32_t)armed->value[ARM_NOISE_HOLD];
    if (armed->given & (1 << ARM_NOISE_SEED))
        to.seed = (uint32_t)armed->value[ARM_NOISE_SEED];
    noise_aim(n, &to);
}

/* All of a fire or nothing: the plant may have climbed since the set was checked. Then there is a second REPLY. */
static bool still_fits(struct app *a, const struct fire *f)
{
    const struct message fire = {.kind = WIRE_FIRE, .counter = f->counter};
    struct staged *set = &a->mailbox.committed;
    if (!f->parameters || !parameters_check(a, set))
        return true;
    memset(set->given, 0, sizeof set->given);
    a->count[DIAG_RANGE]++;
    telemetry_reply(&a->telemetry, a, &fire, CAUSE_RANGE, 0, UINT64_MAX);
    return false;
}

void app_apply_fire(struct app *a, const struct fire *f)
{
    if (!still_fits(a, f))
        return;
    for (int i = 0; i < a->plant.model->n_inputs; i++) {
        const struct armed *armed = &f->armed[i];
        struct drive_setting s = drive_target(&a->plant.drive[i]);
        if (!((f->channels >> i) & 1))
            continue;
        double unit = scale_of(&a->plant.scale, a->plant.model->input_signal[i].quantity);
        if (armed->given & (1 << ARM_AMPLITUDE))
            s.amplitude = armed->value[ARM_AMPLITUDE] / unit;
        if (armed->given & (1 << ARM_FREQUENCY))
            s.turns_per_tick = armed->value[ARM_FREQUENCY] * a->plant.tick_s;
        if (armed->given & (1 << ARM_PHASE))
            s.phase_turns = armed->value[ARM_PHASE] / (2.0 * ELEMENTARY_PI);
        /* without a new ramp, one that runs goes on in the time it has left */
        s.ramp_ticks = (a->plant.drive[i].ramp_left + TICK_FRACTIONS - 1) / TICK_FRACTIONS;
        if (armed->given & (1 << ARM_RAMP))
            s.ramp_ticks = (uint64_t)(int64_t)(armed->value[ARM_RAMP] / a->plant.tick_s + 0.5);
        drive_change(plant_touch_drive(&a->plant, i), &s);
        aim_noise(&a->plant.drive[i].noise, armed, unit);
    }
    a->plant.counts.changes += f->channels != 0;
    if (f->parameters)
        (void)parameters_apply(a, &a->mailbox.committed); /* it still fits */
    a->count[DIAG_FIRE_APPLIED]++;
    note_latency(a, WIRE_FIRE, f->counter, f->received_tick);
    capture_trigger_now(&a->capture, TRIGGER_FIRE, a->plant.now.tick);
}
