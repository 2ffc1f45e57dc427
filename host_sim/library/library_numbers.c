/* library_numbers.c - inputs, outputs, states, parameters and settings by name and index. */
#include "host_sim/cli/options_nearest.h"
#include "host_sim/library/library.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "host_sim/cli/options.h"

static const char *const kind_name[] = {"input", "output", "state", "parameter", "setting"};
enum { KINDS = sizeof kind_name / sizeof kind_name[0], NAMES = MODEL_PARAMETERS + SETTINGS };

static const struct signal *signals(const struct model *m, enum contactplant_kind kind, int *n)
{
    *n = kind == CONTACTPLANT_INPUT    ? m->n_inputs
         : kind == CONTACTPLANT_OUTPUT ? m->n_outputs
         : kind == CONTACTPLANT_STATE  ? m->n_states
                                       : 0;
    return kind == CONTACTPLANT_INPUT    ? m->input_signal
           : kind == CONTACTPLANT_OUTPUT ? m->output_signal
                                         : m->state_signal;
}

static int first_of(enum contactplant_kind kind)
{
    return kind == CONTACTPLANT_SETTING ? SETTING_FIRST : 0;
}

static int count(const struct model *m, enum contactplant_kind kind)
{
    int n;
    (void)signals(m, kind, &n);
    return kind == CONTACTPLANT_PARAMETER ? m->n_parameters : kind == CONTACTPLANT_SETTING ? SETTINGS : n;
}

static bool is_kind(struct contactplant *p, enum contactplant_kind kind)
{
    if ((unsigned)kind < KINDS)
        return true;
    (void)library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "no such kind of number: %d", (int)kind);
    return false;
}

int contactplant_count(struct contactplant *p, enum contactplant_kind kind)
{
    return library_is_plant(p) && is_kind(p, kind) ? count(p->scene.config.model, kind) : 0;
}

/* Entry `index` of a kind; false when there is none. */
static bool describe(const struct model *m, enum contactplant_kind kind, int index,
                     struct contactplant_number *number)
{
    int n;
    const struct signal *s = signals(m, kind, &n);
    if (kind == CONTACTPLANT_PARAMETER || kind == CONTACTPLANT_SETTING) {
        const struct parameter *q = scene_parameter(m, index);
        if (q)
            *number = (struct contactplant_number){q->name, q->unit, q->meaning, q->min, q->max, q->initial};
        return q != NULL;
    }
    if (index < 0 || index >= n)
        return false;
    *number = (struct contactplant_number){s[index].name,     s[index].unit,    s[index].meaning,
                                           -(double)INFINITY, (double)INFINITY, 0.0};
    return true;
}

int contactplant_describe(struct contactplant *p, enum contactplant_kind kind, int index,
                          struct contactplant_number *number)
{
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    if (!is_kind(p, kind))
        return CONTACTPLANT_BAD_VALUE;
    if (!number)
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "contactplant_describe: number is NULL");
    if (describe(p->scene.config.model, kind, index, number))
        return CONTACTPLANT_OK;
    return library_fail(&p->error, CONTACTPLANT_BAD_INDEX, "no %s %d; there are %d to %d", kind_name[kind],
                        index, first_of(kind), first_of(kind) + count(p->scene.config.model, kind) - 1);
}

static int no_name(struct contactplant *p, enum contactplant_kind kind, const char *name)
{
    const struct model *m = p->scene.config.model;
    const char *names[NAMES];
    struct contactplant_number number;
    int n = 0;
    for (int i = first_of(kind); describe(m, kind, i, &number) && n < NAMES; i++)
        names[n++] = number.name;
    (void)library_fail(&p->error, CONTACTPLANT_BAD_NAME, "%s has no %s \"%.80s\"%s", m->name, kind_name[kind],
                       name, options_advise(name, strlen(name), names, n, NULL));
    return -1;
}

int contactplant_find(struct contactplant *p, enum contactplant_kind kind, const char *name)
{
    struct contactplant_number number;
    if (!library_is_plant(p) || !is_kind(p, kind))
        return -1;
    if (!name) {
        (void)library_fail(&p->error, CONTACTPLANT_BAD_NAME, "the name of the %s is NULL", kind_name[kind]);
        return -1;
    }
    for (int i = first_of(kind); describe(p->scene.config.model, kind, i, &number); i++)
        if (!strcmp(name, number.name))
            return i;
    return no_name(p, kind, name);
}

/* ---- parameters ---- */

static int is_acceptable(struct contactplant *p, int index, double value)
{
    char why[SCENE_REASON];
    const struct model *m = p->scene.config.model;
    if (!scene_parameter(m, index))
        return library_fail(&p->error, CONTACTPLANT_BAD_INDEX, "no parameter %d; %s has 0 to %d%s", index,
                            m->name, m->n_parameters - 1, p->on_bus ? ", and settings from 64 on" : "");
    if (index >= SETTING_FIRST && !p->on_bus)
        return library_fail(&p->error, CONTACTPLANT_BAD_ORDER,
                            "%s is a setting of the program on a bus; this plant is alone",
                            scene_parameter(m, index)->name);
    if (!scene_accepts(m, index, value, why))
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "%s", why);
    return CONTACTPLANT_OK;
}

/* The app begins anew with other numbers; with the old ones where it refuses them. */
static int restart(struct contactplant *p, const double *si, const double *setting)
{
    struct scene_app *s = &p->scene;
    double old_si[MODEL_PARAMETERS], old_setting[SETTINGS];
    memcpy(old_si, s->si, sizeof old_si);
    memcpy(old_setting, s->setting, sizeof old_setting);
    memcpy(s->si, si, sizeof s->si);
    memcpy(s->setting, setting, sizeof s->setting);
    int code = library_start(p, &p->error);
    if (code == CONTACTPLANT_OK)
        return code;
    memcpy(s->si, old_si, sizeof old_si);
    memcpy(s->setting, old_setting, sizeof old_setting);
    (void)library_start(p, NULL); /* as it was */
    p->error.code = CONTACTPLANT_BAD_VALUE;
    return CONTACTPLANT_BAD_VALUE;
}

static int change(struct contactplant *p, const double *si, const double *setting)
{
    if (p->on_bus)
        return restart(p, si, setting);
    const char *why = plant_change(&p->scene.app.plant, si);
    if (why)
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "these parameters cannot run: %s", why);
    p->scene.app.plant.counts.changes++;
    return CONTACTPLANT_OK;
}

int contactplant_set_parameters(struct contactplant *p, int n, const int *index, const double *value)
{
    double si[MODEL_PARAMETERS], setting[SETTINGS];
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    if (n < 0 || (n > 0 && (!index || !value)))
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE,
                            "the parameters are NULL, or their number is below 0");
    if (p->on_bus && p->scene.app.frame > 0)
        return library_fail(&p->error, CONTACTPLANT_BAD_ORDER,
                            "the bus runs: parameters are the controller's now (PARAM_WRITE, PARAM_COMMIT)");
    memcpy(si, p->on_bus ? p->scene.si : p->scene.app.plant.si, sizeof si);
    memcpy(setting, p->scene.setting, sizeof setting);
    for (int i = 0; i < n; i++) {
        int code = is_acceptable(p, index[i], value[i]);
        if (code != CONTACTPLANT_OK)
            return code;
        *(index[i] < SETTING_FIRST ? &si[index[i]] : &setting[index[i] - SETTING_FIRST]) = value[i];
    }
    return n ? change(p, si, setting) : CONTACTPLANT_OK;
}

int contactplant_set_parameter(struct contactplant *p, int index, double value)
{
    return contactplant_set_parameters(p, 1, &index, &value);
}

double contactplant_parameter(struct contactplant *p, int index)
{
    if (!library_is_plant(p))
        return (double)NAN;
    const struct app *a = &p->scene.app;
    if (!scene_parameter(p->scene.config.model, index) || (index >= SETTING_FIRST && !p->on_bus)) {
        (void)library_fail(&p->error, CONTACTPLANT_BAD_INDEX, "no parameter %d of this plant", index);
        return (double)NAN;
    }
    return index < SETTING_FIRST ? a->plant.si[index] : a->setting[index - SETTING_FIRST];
}
