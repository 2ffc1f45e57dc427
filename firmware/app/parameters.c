/* parameters.c - staged writes that become one set: checked as a whole, applied as a whole, echoed.
 *
 * A wire index below SETTING_FIRST is a parameter of the model, from there on a setting of the app. */
#include "firmware/app/parameters.h"

#include <string.h>
#include "firmware/app/app.h"
#include "firmware/plant/plant_change.h"

enum { ECHO_MARGIN = 4 /* frames */ };

static bool exists(const struct app *a, unsigned index)
{
    return index < (unsigned)a->plant.model->n_parameters ||
           (index >= SETTING_FIRST && index < SETTING_FIRST + SETTINGS);
}

enum cause parameters_write(struct app *a, const struct message *m)
{
    const struct model *model = a->plant.model;
    unsigned index = (unsigned)m->value[PARAM_WRITE_INDEX];
    double value = m->value[PARAM_WRITE_VALUE];
    if (!exists(a, index))
        return CAUSE_UNKNOWN;
    if (index >= SETTING_FIRST) {
        if (!setting_accepts((int)index - SETTING_FIRST, value))
            return CAUSE_RANGE;
    } else if (!(value >= model->parameter[index].min && value <= model->parameter[index].max)) {
        return CAUSE_RANGE;
    }
    staged_put(&a->mailbox.staged, index, value);
    return CAUSE_OK;
}

/* Writes the n values from wire index `first` on that would be in force: those of `staged`, else those of
 * `now`. `laid` may be `now`. */
static void overlay(const struct staged *staged, unsigned first, int n, const double *now, double *laid)
{
    for (int i = 0; i < n; i++) {
        unsigned index = first + (unsigned)i;
        laid[i] = staged_has(staged, index) ? staged->value[index] : now[i];
    }
}

/* A slot may measure an output of the model, or the result of a stage that is on. A plant without an equation
 * of its own, a microscope, has cycles of peak force in their place (afm_plant.h). */
static const char *check_lockin_output(const struct model *m, const double *setting, int output)
{
    if (output < MODEL_OUTPUTS)
        return output < m->n_outputs ? NULL : "lock-in output: the model has fewer outputs";
    return !m->rhs || setting[SET_STAGE + STAGE_SETTINGS * (output - MODEL_OUTPUTS) + STAGE_AT] > 0.0
               ? NULL
               : "lock-in output: this stage is off";
}

const char *parameters_check_settings(const struct model *m, const double *setting)
{
    for (int i = 0; i < LOCKIN_SLOTS; i++) {
        const char *why = check_lockin_output(m, setting, (int)setting[SET_LOCKIN_OUTPUT + i]);
        if (setting[SET_LOCKIN_CHANNEL + i] >= m->n_inputs)
            return "lock-in channel: the model has fewer inputs";
        if (why)
            return why;
    }
    /* an echo is as old as the STATUS or SYNC it was read from, and the way there and back */
    if (setting[SET_AGE_LIMIT_FRAMES] < setting[SET_STATUS_EVERY] + ECHO_MARGIN)
        return "age_limit_frames: below status_every + 4, no heartbeat could be fresh";
    return NULL;
}

const char *parameters_check_stages(const struct app_config *c, const struct model *m, const double *setting)
{
    if (c->stage_calls)
        return c->stage_calls->refuse(m, c->frame_s / c->substeps / c->dilation, setting);
    for (int i = 0; i < STAGE_SLOTS; i++)
        if (setting[SET_STAGE + STAGE_SETTINGS * i + STAGE_AT] > 0.0)
            return "stage: this image has none";
    return NULL;
}

const char *parameters_could_climb(const struct app *a, const double *si)
{
    bool climbed = a->plant.model != a->config.model;
    return a->config.promote && !climbed ? plant_could_climb(&a->plant, a->config.promote, si) : NULL;
}

const char *parameters_check(const struct app *a, const struct staged *staged)
{
    double si[MODEL_PARAMETERS], setting[SETTINGS];
    for (unsigned i = (unsigned)a->plant.model->n_parameters; i < SETTING_FIRST; i++)
        if (staged_has(staged, i))
            return "a parameter of the model that the plant has left";
    overlay(staged, 0, a->plant.model->n_parameters, a->plant.si, si);
    overlay(staged, SETTING_FIRST, SETTINGS, a->setting, setting);
    const char *why = parameters_check_settings(a->plant.model, setting);
    why = why ? why : parameters_check_stages(&a->config, a->plant.model, setting);
    why = why ? why : plant_accepts(&a->plant, si);
    return why ? why : parameters_could_climb(a, si);
}

/* Sensor faults, stages, lock-in windows and everything else that follows from the settings. */
void parameters_settings_changed(struct app *a)
{
    sensor_change(&a->sensor, a->setting);
    if (a->config.stage_calls)
        a->config.stage_calls->change(a->config.stages, &a->plant, a->setting);
    lockin_slots_change(&a->lockin, a->setting, a->config.substeps);
}

void parameters_apply(struct app *a, struct staged *staged)
{
    bool model = false;
    for (unsigned i = 0; i < SETTING_FIRST + SETTINGS; i++) {
        if (!staged_has(staged, i))
            continue;
        model |= i < SETTING_FIRST;
        telemetry_echo(&a->telemetry, i);
    }
    overlay(staged, 0, a->plant.model->n_parameters, a->plant.si,
            staged->value); /* a board's stack is short */
    const char *why = model ? plant_change(&a->plant, staged->value) : NULL;
    ASSERT(!why); /* parameters_check has accepted it */
    a->plant.counts.changes += model;
    overlay(staged, SETTING_FIRST, SETTINGS, a->setting, a->setting);
    parameters_settings_changed(a);
    memset(staged->given, 0, sizeof staged->given);
}

/* The committed set belongs to a fire that waits. */
static bool set_in_use(const struct mailbox *b)
{
    for (uint32_t i = 0; i < b->n_fires; i++) {
        if (b->fire[i].parameters)
            return true;
    }
    return false;
}

/* A set whose count and CRC do not match is torn: it is dropped, and must be written again. */
enum cause parameters_commit(struct app *a, const struct message *m)
{
    struct mailbox *b = &a->mailbox;
    unsigned when = (unsigned)m->value[PARAM_COMMIT_WHEN];
    bool whole = staged_count(&b->staged) > 0 &&
                 staged_count(&b->staged) == (unsigned)m->value[PARAM_COMMIT_COUNT] &&
                 staged_crc(&b->staged) == (uint32_t)m->value[PARAM_COMMIT_CRC];
    enum cause cause = CAUSE_OK;
    if (!whole)
        cause = CAUSE_INCOMPLETE;
    else if (when > COMMIT_WITH_FIRE)
        cause = CAUSE_UNKNOWN;
    else if (parameters_check(a, &b->staged))
        cause = CAUSE_RANGE;
    else if (set_in_use(b))
        cause = CAUSE_FULL; /* a waiting FIRE was checked against the set that is in force now */
    else if (when == COMMIT_WITH_FIRE) {
        b->committed = b->staged;
        b->commit_with_fire = true;
    } else
        parameters_apply(a, &b->staged); /* checked above: it fits */
    memset(b->staged.given, 0, sizeof b->staged.given);
    return cause;
}

enum cause parameters_read(struct app *a, const struct message *m)
{
    unsigned index = (unsigned)m->value[PARAM_READ_INDEX];
    if (!exists(a, index))
        return CAUSE_UNKNOWN;
    telemetry_echo(&a->telemetry, index);
    return CAUSE_OK;
}
