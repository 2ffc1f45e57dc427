/* scene_file.c - see scene_file.h. First the lines, then the model, then every key in the order of the
 * file. */
#include "host_sim/scene/scene_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/method/method.h"
#include "firmware/stage/stage.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/scene/scene_check.h"
#include "host_sim/scene/scene_keys.h"
#include "host_sim/scene/scene_lines.h"
#include "host_sim/scene/scene_name.h"
#include "host_sim/cli/unit.h"
#include "models/models.h"
#include "models/scenes/scenes_table.h"

enum { NAMES = SCENE_MODELS + SCENE_KEYS };

/* ---- values ---- */

static const char *name_of(const struct model *m, enum scene_key_kind kind, int i)
{
    const struct signal *watched = kind == KEY_WATCHED ? model_observable(m, i) : NULL;
    if (kind == KEY_MODEL)
        return i < SCENE_MODELS ? scene_model(i)->name : NULL;
    if (kind == KEY_PROMOTE)
        return i < MODELS ? model_table[i]->name : NULL;
    if (kind == KEY_METHOD)
        return i < METHODS ? method_table[i]->name : NULL;
    if (kind == KEY_WATCHED)
        return watched ? watched->name : NULL;
    return i < m->n_outputs ? m->output_signal[i].name : NULL;
}

/* The number of the model, method, output or observable of this name, or -1 with all their names. */
static int find_name(const struct model *m, enum scene_key_kind kind, struct word w, const char **all, int *n)
{
    *n = 0;
    for (int i = 0; i < NAMES; i++) {
        const char *name = name_of(m, kind, i);
        if (name && scene_text_is(w, name))
            return i;
        if (name)
            all[(*n)++] = name;
    }
    return -1;
}

static bool set_name(struct reader *r, struct line *l, const struct scene_key *k)
{
    const char *name[NAMES];
    int n, i = find_name(r->scene.model, k->kind, l->value, name, &n);
    if (i < 0)
        return scene_lines_wrong(r, l->number, "%s: no %s \"%.*s\"%s", k->name,
                                 k->kind == KEY_PROMOTE ? "model" : k->full, scene_text_shown(l->value),
                                 l->value.at, options_advise(l->value.at, l->value.n, name, n, NULL));
    if (k->kind == KEY_METHOD)
        r->scene.method = method_table[i]->name;
    if (k->kind == KEY_OBSERVABLE)
        r->scene.observable = i;
    if (k->kind == KEY_WATCHED)
        r->scene.watch.observable = i;
    if (k->kind == KEY_PROMOTE)
        r->scene.watch.promote = model_table[i];
    return true;
}

static bool set_number(struct reader *r, struct line *l, const struct scene_key *k)
{
    char reason[UNIT_REASON], range[UNIT_REASON];
    double value;
    bool whole = k->kind == KEY_COUNT;
    snprintf(range, sizeof range, whole ? "%.0f to %.0f%s%s" : "%g to %g%s%s", k->min, k->max,
             *k->unit ? " " : "", k->unit);
    if (!unit_read(l->value.at, l->value.n, k->unit, &value, reason))
        return scene_lines_wrong(r, l->number, "%s: %s; %s is allowed", k->name, reason, range);
    if (!(value >= k->min && value <= k->max))
        return scene_lines_wrong(r, l->number, "%s: %.*s is out of range; give %s", k->name,
                                 scene_text_shown(l->value), l->value.at, range);
    if (whole && value != floor(value))
        return scene_lines_wrong(r, l->number, "%s: %.*s is not a whole number; give one from %s", k->name,
                                 scene_text_shown(l->value), l->value.at, range);
    scene_keys_set(&r->scene, k, value);
    return true;
}

/* ---- keys ---- */

static bool no_key(struct reader *r, const struct line *l, int input)
{
    struct scene_key key[SCENE_KEYS];
    const char *name[SCENE_KEYS];
    int n = 0;
    for (; n < SCENE_KEYS && scene_keys_get(&r->scene, l->section, input, n, &key[n]); n++)
        name[n] = key[n].name;
    if (l->section == SECTION_PLANT && r->scene.paper)
        return scene_lines_wrong(
            r, l->number,
            "%.*s: [plant] has model and method only beside [paper]; keep the parameters of one",
            scene_text_shown(l->key), l->key.at);
    if (l->section == SECTION_DRIVE && r->scene.paper &&
        (scene_text_is(l->key, "amplitude") || scene_text_is(l->key, "frequency") ||
         scene_text_is(l->key, "phase")))
        return scene_lines_wrong(
            r, l->number,
            "%.*s: contradicts [paper], whose own parameters are the harmonic drives; set them there",
            scene_text_shown(l->key), l->key.at);
    return scene_lines_wrong(r, l->number, "%.*s: no such key in [%s] of %s%s", scene_text_shown(l->key),
                             l->key.at, scene_section_name[l->section], r->scene.model->name,
                             options_advise(l->key.at, l->key.n, name, n, NULL));
}

/* The input of a drive, the input or output of a stage; -1: there is none of this name. */
static int find_signal(const struct model *m, const struct line *l)
{
    for (int i = 0; i < m->n_inputs; i++)
        if (scene_text_is(l->input, m->input_signal[i].name))
            return i;
    for (int i = 0; l->section == SECTION_STAGE && i < m->n_outputs; i++)
        if (scene_text_is(l->input, m->output_signal[i].name))
            return MODEL_INPUTS + i;
    return -1;
}

static bool no_signal(struct reader *r, const struct line *l)
{
    const struct model *m = r->scene.model;
    const char *name[MODEL_INPUTS + MODEL_OUTPUTS];
    int n = 0;
    for (int i = 0; i < m->n_inputs; i++)
        name[n++] = m->input_signal[i].name;
    for (int i = 0; l->section == SECTION_STAGE && i < m->n_outputs; i++)
        name[n++] = m->output_signal[i].name;
    return scene_lines_wrong(r, l->number, "[%s %.*s]: %s has no such %s%s", scene_section_name[l->section],
                             scene_text_shown(l->input), l->input.at, m->name,
                             l->section == SECTION_STAGE ? "signal" : "input",
                             options_advise(l->input.at, l->input.n, name, n, NULL));
}

/* The line of a section, but for its keys. */
static bool set_header(struct reader *r, struct line *l, int signal)
{
    if (l->section == SECTION_WATCH)
        l->target = &r->scene.watch.on;
    if (l->section != SECTION_STAGE)
        return true;
    if (!scene_keys_add_stage(&r->scene, signal))
        return scene_lines_wrong(r, l->number, "[stage %.*s]: a scene has at most %d stages",
                                 scene_text_shown(l->input), l->input.at, SCENE_STAGES);
    l->target = r->scene.stage[scene_keys_stage(&r->scene, signal)];
    return true;
}

/* preset = NAME, the first key of its stage; the others change it. */
static bool set_preset(struct reader *r, struct line *l, int signal)
{
    const struct model *m = r->scene.model;
    const char *name[SCENE_STAGE_PRESETS], *unit;
    unit =
        signal < MODEL_INPUTS ? m->input_signal[signal].unit : m->output_signal[signal - MODEL_INPUTS].unit;
    if (!(l > r->line && l[-1].header))
        return scene_lines_wrong(r, l->number,
                                 "preset: it stands first in its stage; the other keys change it");
    if (strcmp(unit, "m") != 0)
        return scene_lines_wrong(r, l->number, "preset: those are for lengths, and %.*s has the unit %s",
                                 scene_text_shown(l->input), l->input.at, unit);
    return scene_keys_stage_preset(&r->scene, scene_keys_stage(&r->scene, signal), l->value.at, l->value.n,
                                   name)
               ? true
               : scene_lines_wrong(r, l->number, "preset: no preset of a stage is called \"%.*s\"%s",
                                   scene_text_shown(l->value), l->value.at,
                                   options_advise(l->value.at, l->value.n, name, SCENE_STAGE_PRESETS, NULL));
}

static bool set_line(struct reader *r, struct line *l)
{
    struct scene_key k;
    bool named = l->section == SECTION_DRIVE || l->section == SECTION_STAGE;
    int input = named ? find_signal(r->scene.model, l) : 0;
    if (input < 0)
        return no_signal(r, l);
    if (l->section == SECTION_PAPER && !r->scene.model->n_paper)
        return scene_lines_wrong(r, l->number, "[paper]: %s has no parameters of a paper; set [plant]",
                                 r->scene.model->name);
    r->scene.started |= l->section == SECTION_START;
    if (l->header)
        return set_header(r, l, input);
    if (l->section == SECTION_STAGE && scene_text_is(l->key, "preset"))
        return set_preset(r, l, input);
    for (int i = 0; scene_keys_get(&r->scene, l->section, input, i, &k); i++) {
        if (!scene_text_is(l->key, k.name) && !scene_text_is(l->key, k.full))
            continue;
        l->target = (const char *)&r->scene + k.offset;
        for (const struct line *before = r->line; before < l; before++)
            if (before->target == l->target)
                return scene_lines_wrong(r, l->number, "%s: set in line %d already; keep one", k.name,
                                         before->number);
        return k.kind == KEY_NUMBER || k.kind == KEY_COUNT ? set_number(r, l, &k) : set_name(r, l, &k);
    }
    return no_key(r, l, input);
}

/* ---- the scene ---- */

static bool no_model(struct reader *r)
{
    static const char *const key = "model";
    for (const struct line *l = r->line; l < r->line + r->n; l++) {
        char own[SCENE_TEXT_SHOWN + 1];
        snprintf(own, sizeof own, "%.*s", scene_text_shown(l->key), l->key.at);
        if (l->section == SECTION_PLANT && l->key.n && options_nearest(own, &key, 1))
            return scene_lines_wrong(r, l->number, "%s: no such key in [plant]; did you mean model?", own);
    }
    return scene_lines_wrong(r, 0, "no model; write [plant] and below it, for instance, model = hertz_rig");
}

static bool is_preset(struct word w)
{
    for (int i = 0; i < SCENES; i++)
        if (scene_text_is(w, scenes_table[i].name))
            return true;
    return false;
}

/* The model first: the other keys are its own. */
static bool find_model(struct reader *r)
{
    const char *name[NAMES];
    const struct line *found = NULL;
    bool paper = false;
    for (int i = 0; i < r->n; i++) {
        const struct line *l = &r->line[i];
        paper |= l->section == SECTION_PAPER;
        if (!found && l->section == SECTION_PLANT && scene_text_is(l->key, "model"))
            found = l;
    }
    if (!found)
        return no_model(r);
    int n, i = find_name(NULL, KEY_MODEL, found->value, name, &n);
    if (i < 0 && is_preset(found->value))
        return scene_lines_wrong(
            r, found->number,
            "model: %.*s is a preset, of which contactplant scene %.*s prints the file; its "
            "first lines name the model",
            scene_text_shown(found->value), found->value.at, scene_text_shown(found->value), found->value.at);
    if (i < 0)
        return scene_lines_wrong(r, found->number, "model: no model \"%.*s\"%s",
                                 scene_text_shown(found->value), found->value.at,
                                 options_advise(found->value.at, found->value.n, name, n, NULL));
    scene_default(&r->scene, i);
    r->scene.paper = paper;
    for (int k = 0; k < MODEL_PARAMETERS && paper; k++)
        r->scene.value[k] = k < r->scene.model->n_paper ? r->scene.model->paper[k].initial : 0.0;
    return true;
}

/* Reads the observable of the watch first: its limits have its unit. */
static void find_watched(struct reader *r)
{
    const char *name[NAMES];
    struct scene_watch *w = &r->scene.watch;
    for (const struct line *l = r->line; l < r->line + r->n; l++) {
        if (l->section != SECTION_WATCH)
            continue;
        if (l->header)
            *w = (struct scene_watch){true, r->scene.observable, SCENE_UNBOUNDED, -SCENE_UNBOUNDED, NULL};
        int n, i = scene_text_is(l->key, "observable")
                       ? find_name(r->scene.model, KEY_WATCHED, l->value, name, &n)
                       : -1;
        if (i >= 0)
            w->observable = i;
    }
}

/* A start is of all states. */
static bool check_whole_start(struct reader *r)
{
    struct scene_key k;
    for (int i = 0; r->scene.started && scene_keys_get(&r->scene, SECTION_START, 0, i, &k); i++) {
        bool given = false;
        int number = 0;
        for (const struct line *l = r->line; l < r->line + r->n; l++) {
            given |= l->target == (const char *)&r->scene + k.offset;
            number = l->header && l->section == SECTION_START ? l->number : number;
        }
        if (!given)
            return scene_lines_wrong(
                r, number, "%s: missing in [start]; give every state, or leave the section out", k.name);
    }
    return true;
}

/* Where a contradiction comes from: the line that set its root, else the model's. */
static bool check(struct reader *r, const void *(*of)(const struct scene *s, char *why))
{
    char reason[SCENE_CHECK_REASON];
    const void *root = of(&r->scene, reason);
    const struct line *at = NULL;
    if (!root)
        return true;
    for (const struct line *l = r->line; l < r->line + r->n; l++)
        if (l->target == root || (!at && l->target == &r->scene.model))
            at = l;
    if (at->header) {
        const char *section = scene_section_name[at->section];
        size_t n = strlen(section);
        bool told = !strncmp(reason, section, n) && !strncmp(reason + n, ": ", 2);
        return scene_lines_wrong(r, at->number, "[%s%s%.*s]: %s", section, at->input.n ? " " : "",
                                 scene_text_shown(at->input), at->input.at, reason + (told ? n + 2 : 0));
    }
    return scene_lines_wrong(r, at->number, "%.*s: %s", scene_text_shown(at->key), at->key.at, reason);
}

static bool parse(const char *file, const char *text, size_t n, struct scene *s, char *why,
                  const void *(*of)(const struct scene *s, char *why))
{
    struct reader r = {.file = file, .why = why};
    bool good = scene_lines_read(&r, text, n) && find_model(&r);
    if (good)
        find_watched(&r);
    for (int i = 0; i < r.n && good; i++)
        good = set_line(&r, &r.line[i]);
    good = good && check_whole_start(&r) && check(&r, of);
    if (good)
        *s = r.scene;
    return good;
}

bool scene_file_parse(const char *file, const char *text, size_t n, struct scene *s, char *why)
{
    return parse(file, text, n, s, why, scene_check);
}

bool scene_file_parse_unstepped(const char *file, const char *text, size_t n, struct scene *s, char *why)
{
    return parse(file, text, n, s, why, scene_check_unstepped);
}
