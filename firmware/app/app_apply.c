/* app_apply.c - commands whose time has come: what they do to the drives. */
#include "firmware/app/app_apply.h"

#include <string.h>
#include "firmware/app/app.h"
#include "firmware/app/parameters.h"
#include "firmware/app/telemetry_send.h"

/* ARM names a drive's fields as the plant does. */
STATIC_ASSERT((int)ARM_AMPLITUDE == DRIVE_AMPLITUDE && (int)ARM_FREQUENCY == DRIVE_FREQUENCY &&
                  (int)ARM_PHASE == DRIVE_PHASE && (int)ARM_RAMP == DRIVE_RAMP &&
                  (int)ARM_NOISE == DRIVE_NOISE && (int)ARM_NOISE_HOLD == DRIVE_NOISE_HOLD &&
                  (int)ARM_NOISE_SEED == DRIVE_NOISE_SEED,
              fields_of_arm_are_those_of_a_drive);

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
        plant_sample(&a->plant, i, (double)s.value, linear ? a->config.substeps : 0);
        a->plant.counts.changes++;
        a->streaming |= 1u << i;
        a->count[DIAG_STREAM_APPLIED]++;
        note_latency(a, WIRE_STREAM + (unsigned)i, s.counter, s.received_tick);
    }
}

void app_apply_codes(struct app *a, uint32_t i)
{
    struct code_block *b = &a->mailbox.block;
    uint32_t bit = UINT32_C(1) << i;
    if (!(b->given & bit)) {
        a->count[DIAG_STREAM_MISSED]++;
        return;
    }
    b->given &= ~bit;
    a->config.stage_calls->dac(&a->plant, b->code[i]);
    a->plant.counts.changes++;
    a->count[DIAG_STREAM_APPLIED]++;
}

void app_read_codes(struct app *a, uint32_t i)
{
    a->config.stage_calls->adc(&a->plant, a->mailbox.block.code[i]);
}

/* Checks the fire's parameter set again: the plant may have climbed since. If it no longer fits, nothing
 * of the fire acts and a second REPLY says so. */
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

bool app_apply_fire(struct app *a, const struct fire *f)
{
    if (!still_fits(a, f))
        return false;
    for (int i = 0; i < a->plant.model->n_inputs; i++) {
        const struct armed *armed = &f->armed[i];
        if ((f->channels >> i) & 1)
            plant_set_drive(&a->plant, i, armed->given, armed->value);
    }
    a->plant.counts.changes += f->channels != 0;
    if (f->parameters)
        parameters_apply(a, &a->mailbox.committed); /* it still fits */
    a->count[DIAG_FIRE_APPLIED]++;
    note_latency(a, WIRE_FIRE, f->counter, f->received_tick);
    capture_trigger_now(&a->capture, TRIGGER_FIRE, a->plant.now.tick);
    return f->parameters;
}
