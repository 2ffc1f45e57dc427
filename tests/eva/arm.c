/* arm.c - the seam from ARM to the drives.
 *
 * Every value that ARM takes lies within seam_arm. Then a FIRE applies any armed values to drives in any
 * state. The drives must get nothing outside the limits that `drive` begins with. */
#define drive_change drive_change_in_proof
#include "firmware/plant/drive.c"
#undef drive_change
#define noise_aim noise_aim_in_proof
#include "firmware/plant/noise.c"
#undef noise_aim

#include "firmware/app/app_apply.h"
#include "firmware/app/command_drives.h"
#include "firmware/app/parameters.h"
#include "firmware/app/telemetry_send.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"
#include "tests/eva/any_drive.h"
#include "tests/eva/seams.h"

void drive_change(struct drive *d, const struct drive_setting *s);
void noise_aim(struct noise *n, const struct noise_setting *s);

/* Takes the place of drive_change: checks the settings that a fire has turned into. */
void drive_change(struct drive *d, const struct drive_setting *s)
{
    (void)d;
    ASSERT(s->turns_per_tick >= 0.0 && s->turns_per_tick <= SEAM_TURNS);
    ASSERT(s->phase_turns >= -SEAM_PHASE && s->phase_turns <= SEAM_PHASE);
    ASSERT(s->ramp_ticks <= SEAM_RAMP);
}

void noise_aim(struct noise *n, const struct noise_setting *s)
{
    (void)n;
    ASSERT(s->hold >= 1 && s->hold <= NOISE_HOLD_MAX);
}

void parameters_apply(struct app *a, struct staged *staged)
{
    (void)a, (void)staged;
}

const char *parameters_check(const struct app *a, const struct staged *staged)
{
    (void)a, (void)staged;
    return eva_bool() ? "a reason" : NULL;
}

/* Takes the place of the real function, which only sends. */
void telemetry_reply(struct telemetry *t, const struct app *a, const struct message *command,
                     enum cause cause, unsigned index, uint64_t ticks_late)
{
    (void)t, (void)a, (void)command, (void)cause, (void)index, (void)ticks_late;
}

static struct app app;

/* One ARM; what it leaves armed is inside. */
static void arm_with(int channel, int field, double value)
{
    struct remark r = {0, 0};
    struct message m = {.kind = (uint8_t)(WIRE_ARM + channel)};
    struct seam limit = seam_arm(&app, channel, field);
    double *armed = &app.mailbox.armed[channel].value[field];
    m.value[ARM_FIELD] = field;
    m.value[ARM_VALUE] = value;
    *armed = limit.min;
    (void)drives_arm(&app, &m, &r);
    ASSERT(*armed >= limit.min && *armed <= limit.max);
}

/* Any double: those below, inside and above the seam, and what is no number. */
static void one_arm(int channel, int field)
{
    struct seam limit = seam_arm(&app, channel, field);
    arm_with(channel, field, eva_between(-DBL_MAX, limit.below));
    arm_with(channel, field, eva_between(limit.min, limit.max));
    arm_with(channel, field, eva_between(limit.max, DBL_MAX));
    arm_with(channel, field, (double)NAN);
    arm_with(channel, field, HUGE_VAL);
    arm_with(channel, field, -HUGE_VAL);
}

static void any_fire(struct fire *f)
{
    const struct model *m = app.plant.model;
    eva_any(f, sizeof *f);
    f->parameters = eva_bool();
    for (int i = 0; i < m->n_inputs; i++)
        for (int k = 0; k < ARM_FIELDS; k++) {
            struct seam limit = seam_arm(&app, i, k);
            f->armed[i].value[k] = eva_between(limit.min, limit.max);
        }
}

static void any_moment(void)
{
    for (int i = 0; i < MODEL_INPUTS; i++)
        any_drive(&app.plant.drive[i]);
    app.plant.now.tick = eva_word();
    app.frame = eva_word();
}

static void one_model(const struct model *m, double tick_s)
{
    struct fire f;
    double si[MODEL_PARAMETERS];
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    app.plant.model = m;
    app.plant.tick_s = tick_s;
    m->prepare(si, app.plant.p, &app.plant.scale);
    app.config.substeps = eva_uint(1, 4096);
    for (int i = 0; i < m->n_inputs; i++)
        for (int k = 0; k < ARM_FIELDS; k++)
            one_arm(i, k);
    any_moment();
    any_fire(&f);
    (void)app_apply_fire(&app, &f);
}

int main(void)
{
    one_model(&hertz_rig, 1e-6 / 4096);
    one_model(&hertz_rig, 10.0);
    one_model(&shaft_bearing, 1e-3 / 16);
    return 0;
}
