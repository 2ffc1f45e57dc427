/* scene.c - see scene.h. */
#include "host_sim/scene/scene.h"
#include "host_sim/commands.h"
#include "host_sim/scene/scene_words.h"
#include "models/models.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 64 };

const struct option scene_options[] = {
    {"set", "NAME=VALUE",
     "a model parameter, SI or with its unit (\"mass=5 kg\"), see contactplant list models; repeatable",
     OPTION_TEXT, .many = true},
    {"setting", "NAME=VALUE", "an app setting, see contactplant list settings; repeatable", OPTION_TEXT,
     .many = true},
    {"method", "NAME", "integration method (rk4); auto picks one, see contactplant list methods", OPTION_TEXT,
     .initial = "rk4"},
    {"tol", "E", "tolerance of a method that has one (its default)", OPTION_NUMBER, METHOD_TOL_MIN,
     METHOD_TOL_MAX, .initial = NULL},
    {"rate", "HZ", "frames per second of bus time (1000)", OPTION_NUMBER, 1.0, 20000.0, .initial = "1000"},
    {"substeps", "N", "steps of the method per frame (64)", OPTION_INTEGER, 1.0, 4096.0, .initial = "64"},
    {"dilation", "D", "bus seconds per second of the real rig (1): D > 1 runs it in slow motion",
     OPTION_NUMBER, 1e-6, 1e6, .initial = "1"},
    {"base-id", "ID",
     "first of the plant's 64 CAN identifiers, a multiple of 0x40 (0x200; beside CANopen 0x680)",
     OPTION_INTEGER, 0.0, 536870848.0, .initial = "0x200"},
    {.name = "extended", .meaning = "29-bit identifiers; allows a --base-id above 0x7C0"},
    {.name = NULL},
};

bool scene_init(struct scene_app *s, const char *name, char *why)
{
    memset(s, 0, sizeof *s);
    s->origin = scene_load(name ? name : model_table[0]->name, &s->scene, why);
    if (s->origin == SCENE_OF_NOTHING)
        return false;
    scene_app_configure(s);
    return true;
}

/* An app_config's grow_capture. */
static float *grow_capture(void *scene, uint32_t n)
{
    struct scene_app *s = scene;
    float *more = realloc(s->capture, n * sizeof *more);
    s->capture = more ? more : s->capture;
    return more;
}

/* Memory for the method's tables and the stages. */
static bool provide(struct scene_app *s)
{
    size_t n_scratch = s->config.method->n_scratch(s->config.model);
    const struct model *to = s->config.promote;
    if (to && s->config.method->n_scratch(to) > n_scratch)
        n_scratch = s->config.method->n_scratch(to);
    scene_free(s);
    s->scratch = calloc(n_scratch + 1, sizeof *s->scratch);
    s->stages = calloc(1, sizeof *s->stages);
    s->config.scratch = s->scratch;
    s->config.grow_capture = grow_capture;
    s->config.capture_owner = s;
    s->config.stages = scene_stages(scene_kind(s->config.model), s->stages, s->scratch);
    s->config.stage_calls = scene_kind(s->config.model)->stage_calls;
    return s->scratch && s->stages;
}

bool scene_start(struct scene_app *s, const struct hal *hal, char *why)
{
    s->config.promote = s->promote ? s->scene.watch.promote : NULL;
    if (!provide(s)) {
        snprintf(why, SCENE_REASON, "out of memory");
        return false;
    }
    return scene_app_start(s, hal, why);
}

void scene_warn(const struct scene_app *s, const struct usage *u)
{
    if (scene_load_warns(s->origin, s->config.model))
        scene_load_warn(u->name, s->config.model, s->si, s->drive);
}

void scene_free(struct scene_app *s)
{
    free(s->scratch);
    free(s->capture);
    free(s->stages);
    s->stages = NULL;
    s->scratch = NULL;
    s->capture = NULL;
}

static bool take_settings(struct scene_app *s, const struct options *o, const char *option, char *why)
{
    for (int i = 0; i < options_count(o, option); i++) {
        const char *text = options_text(o, option, i), *equal = strchr(text, '=');
        double value;
        if (!equal || equal == text) {
            snprintf(why, SCENE_REASON, "--%s %s: write NAME=VALUE with a finite number", option, text);
            return false;
        }
        int index = scene_words_read(s->config.model, (struct word){text, (size_t)(equal - text)},
                                     (struct word){equal + 1, strlen(equal + 1)}, &value, why);
        if (index < 0)
            return false;
        scene_set(s, index, value);
    }
    return true;
}

static bool take_numbers(struct scene_app *s, const struct options *o, char *why)
{
    struct app_config *c = &s->config;
    const char *method = options_text(o, "method", 0);
    if (options_given(o, "method"))
        c->method = scene_find_method(c->model, method);
    if (options_given(o, "tol"))
        c->tol = options_number(o, "tol");
    if (c->method)
        scene_load_tell_tolerance(o, c->model, c->method);
    if (options_given(o, "rate"))
        c->frame_s = 1.0 / options_number(o, "rate");
    scene_app_default_settings(s);
    if (options_given(o, "substeps"))
        c->substeps = (uint32_t)options_number(o, "substeps");
    if (options_given(o, "dilation"))
        c->dilation = options_number(o, "dilation");
    if (!c->method && scene_kind(c->model)->method)
        snprintf(why, SCENE_REASON, "--method %s: a %s has a method of its own; leave it out", method,
                 c->model->name);
    else if (!c->method)
        scene_method_refuse(method, why);
    else
        return scene_take_identifiers(s, o, why);
    return false;
}

bool scene_take_identifiers(struct scene_app *s, const struct options *o, char *why)
{
    struct app_config *c = &s->config;
    c->base_id = (uint32_t)options_number(o, "base-id");
    c->extended = options_given(o, "extended");
    if (c->base_id % WIRE_BASE_ALIGN)
        snprintf(why, SCENE_REASON, "--base-id 0x%X is not a multiple of 0x%X; 0x%X is", c->base_id,
                 WIRE_BASE_ALIGN, c->base_id / WIRE_BASE_ALIGN * WIRE_BASE_ALIGN);
    else if (!c->extended && c->base_id > 0x7FF - (WIRE_KINDS - 1))
        snprintf(why, SCENE_REASON, "--base-id 0x%X needs 29-bit identifiers; add --extended", c->base_id);
    else
        return true;
    return false;
}

static bool take_promote(struct scene_app *s, const struct options *o, char *why)
{
    const struct model *m = s->scene.model;
    const char *reason = model_climb_refused(m, m->full);
    s->promote = options_given(o, "promote");
    if (!s->promote || s->scene.watch.promote)
        return true;
    if (reason)
        snprintf(why, SCENE_REASON, "--promote: %s: %s", m->name, reason);
    else
        snprintf(why, SCENE_REASON,
                 "--promote: the scene does not say when to climb; give it a [watch] with promote = %s",
                 m->full->name);
    return false;
}

bool scene_from_name(struct scene_app *s, const struct options *o, const char *name, char *why)
{
    return scene_init(s, name, why) && take_numbers(s, o, why) && take_settings(s, o, "set", why) &&
           take_settings(s, o, "setting", why) && take_promote(s, o, why);
}

bool scene_from_options(struct scene_app *s, const struct options *o, int i_word)
{
    char why[SCENE_REASON];
    if (scene_from_name(s, o, o->n_words > i_word ? o->word[i_word] : options_text(o, "model", 0), why))
        return true;
    options_misuse(o->usage, "%s", why);
    return false;
}

int scene_open(struct scene_app *s, const struct options *o, int i_word, const struct hal *hal)
{
    char why[SCENE_REASON];
    if (!scene_from_options(s, o, i_word))
        return STATUS_MISUSED;
    return scene_start(s, hal, why) ? 0 : options_misuse(o->usage, "%s", why);
}
