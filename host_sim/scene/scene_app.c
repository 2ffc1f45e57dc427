/* scene_app.c - see scene_app.h. */
#include "host_sim/scene/scene_app.h"
#include "firmware/afm/afm_plant.h"
#include "firmware/app/plant_scene.h"
#include "firmware/method/auto.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "models/math/elementary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct parameter *scene_parameter(const struct model *m, int index)
{
    if (index >= 0 && index < m->n_parameters)
        return &m->parameter[index];
    if (index >= SETTING_FIRST && index < SETTING_FIRST + SETTINGS)
        return &setting_table[index - SETTING_FIRST];
    return NULL;
}

bool scene_accepts(const struct model *m, int index, double value, char *why)
{
    const struct parameter *p = scene_parameter(m, index);
    bool inside = value >= p->min && value <= p->max;
    if (index >= SETTING_FIRST ? setting_accepts(index - SETTING_FIRST, value) : inside)
        return true;
    if (inside)
        snprintf(why, SCENE_REASON, "%s=%g is not a whole number", p->name, value);
    else
        snprintf(why, SCENE_REASON, "%s=%g is out of range; give %g to %g%s%s", p->name, value, p->min,
                 p->max, *p->unit ? " " : "", p->unit);
    return false;
}

void scene_set(struct scene_app *s, int index, double value)
{
    if (index >= SETTING_FIRST)
        s->setting[index - SETTING_FIRST] = value;
    else
        s->si[index] = value;
}

bool scene_stage_settings(const struct scene *s, double setting[SETTINGS])
{
    bool any = false;
    memset(setting, 0, SETTINGS * sizeof *setting);
    memcpy(&setting[SET_STAGE], s->stage, sizeof s->stage);
    for (int i = 0; i < SCENE_STAGES; i++)
        any = any || s->stage[i][STAGE_AT] > 0.0;
    return any;
}

const char *scene_refuses_stages(const struct scene *s)
{
    double setting[SETTINGS];
    if (scene_kind(s->model)->without_bus)
        return scene_kind(s->model)->without_bus;
    return scene_stage_settings(s, setting)
               ? "it has a [stage], which works in run, simulate, test, scan and thermal; leave it out here"
               : NULL;
}

void scene_app_default_settings(struct scene_app *s)
{
    for (int i = 0; i < SETTINGS; i++)
        s->setting[i] = setting_initial(i, s->config.model, s->config.frame_s);
    if (scene_kind(s->config.model)->settings)
        scene_kind(s->config.model)->settings(s->setting);
    for (int i = 0; i < SCENE_STAGES; i++)
        for (int k = 0; k < STAGE_SETTINGS && s->scene.stage[i][STAGE_AT] > 0.0; k++)
            s->setting[SET_STAGE + STAGE_SETTINGS * i + k] = s->scene.stage[i][k];
}

void scene_app_configure(struct scene_app *s)
{
    const struct scene *given = &s->scene;
    bool bare = s->origin == SCENE_OF_MODEL;
    s->config = (struct app_config){.model = given->model,
                                    .method = bare && given->model->rhs && !given->model->modal_form
                                                  ? &rk4
                                                  : scene_find_method(given->model, given->method),
                                    .tol = bare ? 0.0 : given->tolerance,
                                    .frame_s = given->frame_s,
                                    .substeps = given->substeps,
                                    .dilation = given->dilation,
                                    .base_id = 0x200};
    scenes_resolve(given, s->si, s->drive);
    scene_app_default_settings(s);
}

/* Why the scene's drives do not fit the rate that is run, or NULL. */
static const char *check_drives(const struct scene_app *s)
{
    double step = s->config.frame_s / s->config.substeps / s->config.dilation; /* real seconds */
    for (int i = 0; i < s->config.model->n_inputs; i++) {
        const struct harmonic *d = &s->drive[i];
        bool silent = !(d->amplitude < 0.0) && !(d->amplitude > 0.0);
        if (!silent && d->omega * step > (1.0 + 1e-9) * 2.0 * ELEMENTARY_PI / DRIVE_TICKS_MIN)
            return DRIVE_TICKS_TOO_FEW "a drive; more --substeps";
        if (s->scene.drive[i].noise > 0.0 && scenes_noise_steps(&s->scene.drive[i], step) > NOISE_HOLD_MAX)
            return "more than 65535 steps in a hold time of the noise; give fewer --substeps";
    }
    return NULL;
}

static double largest_reading(const struct station *s, const struct stage *sensor)
{
    struct stage stage = *sensor;
    struct peak_force p = s->swing;
    double largest = 0.0, ticks = s->number[STATION_TICKS];
    for (uint32_t i = 0; i < 3 * p.samples; i++) {
        double reading = 0.0;
        for (int k = 0; k < ticks; k++)
            reading = stage_run(&stage, 0.0);
        (void)peak_force_z(&p);
        if (peak_force_read(&p, reading, 0.0))
            largest = fmax(largest, p.cycle.peak_N);
    }
    return largest;
}

bool scene_sensor_is_quiet(const struct station *s, const struct stage *sensor, char *why)
{
    double noise = station_swings(s->number) ? largest_reading(s, sensor) : -1.0;
    if (noise < s->number[STATION_PEAK_FORCE])
        return true;
    snprintf(why, SCENE_REASON,
             "%s is below the noise of a cycle: the sensor alone reads up to %.3g nN; give more, or its "
             "[stage] a lower lag or noise_density",
             station_number[STATION_PEAK_FORCE].name, noise * 1e9);
    return false;
}

bool scene_app_is_quiet(const struct app *a, char *why)
{
    struct stage sensor;
    for (int i = 0; i < STAGE_SLOTS && scene_is_microscope(a->plant.model); i++) {
        const struct station *s = afm_plant_station(a->plant.scratch);
        const double *own = &a->setting[SET_STAGE + STAGE_SETTINGS * i];
        if ((int)own[STAGE_AT] == 1 + MODEL_INPUTS + AFM_PLANT_DISPLACEMENT &&
            !stages_build(&sensor, s->microscope.tick_s, a->setting[SET_SENSOR_SEED], i, own))
            return scene_sensor_is_quiet(s, &sensor, why);
    }
    return true;
}

bool scene_app_start(struct scene_app *s, const struct hal *hal, char *why)
{
    char subject[SCENE_SUBJECT];
    bool watched = plant_scene_watch(&s->scene, s->config.dilation, &s->watch);
    s->config.watch = watched ? &s->watch : NULL;
    s->config.si = s->si;
    s->config.setting = s->setting;
    const char *reason = check_drives(s);
    reason = reason ? reason : app_init(&s->app, &s->config, hal);
    if (reason) {
        scene_subject(s->config.model, s->si, subject);
        snprintf(why, SCENE_REASON, "this scene cannot run%s: %s%s",
                 s->config.promote ? " and climb to its full model" : "", subject, reason);
        return false;
    }
    if (s->origin != SCENE_OF_MODEL)
        plant_scene_begin(&s->app.plant, &s->scene, s->si, s->drive);
    return scene_app_is_quiet(&s->app, why);
}

double scene_resonance_Hz(const struct scene_app *s)
{
    const struct plant *pl = &s->app.plant;
    return pl->model->eigenfrequency(pl->p) / (2.0 * ELEMENTARY_PI * pl->scale.time_s);
}

const struct method *scene_method(const struct scene_app *s)
{
    const struct plant *pl = &s->app.plant;
    return pl->method == &auto_method ? auto_now(pl->scratch) : pl->method;
}
