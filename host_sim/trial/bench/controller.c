/* controller.c - see controller.h. */
#include "host_sim/trial/bench/controller.h"

#include <stdio.h>
#include <string.h>
#include "host_sim/scene/scene_keys.h"
#include "models/afm_lever.h"
#include "models/models.h"

enum { COMMAND_TEXT = 4096, OPTIONS_TEXT = 2048, NUMBER = 32 };

bool controller_fail(struct bench_result *r, const char *format, const char *a, const char *b)
{
    snprintf(r->error, sizeof r->error, format, a, b);
    r->verdict = VERDICT_ERROR;
    return false;
}

/* ---- files ---- */

static bool is_known(const char *name)
{
    bool known = scenes_find(name) != NULL;
    for (int i = 0; i < SCENE_MODELS; i++)
        known = known || !strcmp(name, scene_model(i)->name);
    return known;
}

void bench_scene_path(const char *file, const char *name, char path[BENCH_PATH])
{
    const char *slash = strrchr(file, '/');
    if (is_known(name) || *name == '/' || !slash)
        snprintf(path, BENCH_PATH, "%s", name);
    else
        snprintf(path, BENCH_PATH, "%.*s/%s", (int)(slash - file), file, name);
}

/* ---- the command ---- */

/* The options of contactplant control for this plant: its bus, and what [plant] says of it. */
static void write_options(const struct trial *t, const struct scene_app *s, const struct controller_place *at,
                          char text[OPTIONS_TEXT])
{
    const struct app_config *c = &s->config;
    size_t n = (size_t)snprintf(text, OPTIONS_TEXT, "--rate %.17g --substeps %u --base-id %#x",
                                1.0 / c->frame_s, c->substeps, c->base_id);
    if (at->can)
        n += (size_t)snprintf(text + n, OPTIONS_TEXT - n, " --bus %s", at->can);
    else
        n += (size_t)snprintf(text + n, OPTIONS_TEXT - n, " --bus udp:%s --peer %s", at->me, at->plant);
    if (at->lockstep)
        n += (size_t)snprintf(text + n, OPTIONS_TEXT - n, " --lockstep --patience 0");
    for (int i = 0; t->is_microscope && i < LEVER_PARAMETERS && n < OPTIONS_TEXT; i++)
        n += (size_t)snprintf(text + n, OPTIONS_TEXT - n, " --set %s=%.17g", c->model->parameter[i].name,
                              s->scene.value[i]);
    for (int i = 0; i < t->plant.n && n < OPTIONS_TEXT; i++) {
        bool setting = t->plant.set[i].index >= SETTING_FIRST;
        n += (size_t)snprintf(text + n, OPTIONS_TEXT - n, " --%s %s=%.17g", setting ? "setting" : "set",
                              scene_parameter(c->model, (int)t->plant.set[i].index)->name,
                              t->plant.set[i].value);
    }
}

bool controller_takes_memory(const struct trial *t)
{
    return strstr(t->command, "{memory}") != NULL;
}

/* The command with what stands in braces filled in. */
static bool fill(const struct bench_setting *s, const struct scene_app *scene,
                 const struct controller_place *at, uint32_t run_seed, char text[COMMAND_TEXT])
{
    char rate[NUMBER], substeps[NUMBER], seed[NUMBER], options[OPTIONS_TEXT];
    const struct {
        const char *name, *text;
    } known[] = {{"{plant}", at->plant},
                 {"{me}", at->me},
                 {"{rate}", rate},
                 {"{substeps}", substeps},
                 {"{seed}", seed},
                 {"{scene}", s->trial->is_microscope ? scene->config.model->name : s->trial->scene_name},
                 {"{options}", options},
                 {"{contactplant}", s->program},
                 {"{memory}", at->memory ? at->memory : ""}};
    snprintf(rate, sizeof rate, "%.17g", 1.0 / scene->config.frame_s);
    snprintf(substeps, sizeof substeps, "%u", scene->config.substeps);
    snprintf(seed, sizeof seed, "%u", run_seed);
    write_options(s->trial, scene, at, options);
    size_t n = 0;
    for (const char *from = s->trial->command; *from && n + 1 < COMMAND_TEXT;) {
        size_t i = 0;
        while (i < sizeof known / sizeof known[0] && strncmp(from, known[i].name, strlen(known[i].name)))
            i++;
        if (i == sizeof known / sizeof known[0]) {
            text[n++] = *from++;
            continue;
        }
        n += (size_t)snprintf(text + n, COMMAND_TEXT - n, "%s", known[i].text);
        from += strlen(known[i].name);
    }
    text[n < COMMAND_TEXT ? n : COMMAND_TEXT - 1] = 0;
    return n < COMMAND_TEXT;
}

/* ---- the process ---- */

void controller_log_path(const struct bench_setting *s, const struct bench_result *r, const char *end,
                         char path[BENCH_PATH])
{
    const struct trial_case *c = &s->trial->cases[r->i_case];
    const char *slash = strrchr(s->trial->file, '/'), *file = slash ? slash + 1 : s->trial->file;
    const char *point = strrchr(file, '.');
    int n = snprintf(path, BENCH_PATH, "%s/%.*s.", s->log, (int)(point ? point - file : (long)strlen(file)),
                     file);
    for (const char *at = c->name; *at && n < BENCH_PATH - 64; at++)
        path[n++] = strchr("/ \t", *at) ? '_' : *at;
    path[n] = 0;
    if (c->n_seeds > 1)
        n += snprintf(path + n, (size_t)(BENCH_PATH - n), ".%u", r->seed);
    if (r->varied)
        n += snprintf(path + n, (size_t)(BENCH_PATH - n), ".%.6g", r->varied_value);
    snprintf(path + n, (size_t)(BENCH_PATH - n), "%s", end);
}

bool controller_start(struct controller *c, const struct bench_setting *s, const struct scene_app *scene,
                      const struct controller_place *at, struct bench_result *r)
{
    char command[COMMAND_TEXT], folder[BENCH_PATH], path[BENCH_PATH], why[CHILD_REASON];
    const char *slash = strrchr(s->trial->file, '/');
    if (s->trial->attached)
        return true;
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - s->trial->file) : 1,
             slash ? s->trial->file : ".");
    if (slash == s->trial->file)
        snprintf(folder, sizeof folder, "/");
    if (s->log) {
        controller_log_path(s, r, ".controller.txt", path);
        c->output = fopen(path, "w");
        if (!c->output)
            return controller_fail(r, "--log: cannot write %.400s%s", path, "");
    }
    if (!fill(s, scene, at, r->seed, command))
        return controller_fail(r, "the command is too long%s%s", "", "");
    return child_start(&c->child, command, folder, c->output, why) ? true
                                                                   : controller_fail(r, "%s%s", why, "");
}

void controller_end(struct controller *c, struct bench_result *r)
{
    char left[NUMBER];
    int n = child_end(&c->child);
    snprintf(left, sizeof left, "%d", n);
    if (n && r->verdict != VERDICT_ERROR)
        controller_fail(r, "the controller left %s processes behind, which were ended%s", left, "");
    if (c->output && fclose(c->output) && r->verdict != VERDICT_ERROR)
        controller_fail(r, "--log: cannot write what the controller printed%s%s", "", "");
    c->output = NULL;
}

/* ---- its end before its time ---- */

/* Whether the case says what is expected when the controller ends its session by itself. */
static bool may_stop(const struct trial_case *c)
{
    for (int i = 0; i < c->n_expects; i++)
        if (c->expect[i].what.kind == METRIC_STOPPED)
            return true;
    return false;
}

bool controller_has_ended(struct controller *c, const struct trial_case *k, double plant_s, bool stopped,
                          struct bench_result *r)
{
    char how[CHILD_REASON], when[NUMBER + 32];
    if (!c->child.pid || child_look(&c->child))
        return false;
    if (stopped && may_stop(k))
        return true;
    child_describe(&c->child, how);
    snprintf(when, sizeof when, plant_s > 0.0 ? "at %g s of plant time" : "before plant time ran", plant_s);
    controller_fail(r, "the controller ended %s: it %s", when, how);
    return true;
}

void controller_explain_stand(const struct trial_case *k, const char *state, double plant_s, bool stopped,
                              struct bench_result *r)
{
    char when[NUMBER], how[2 * NUMBER];
    if (stopped && may_stop(k))
        return;
    snprintf(when, sizeof when, "%g", plant_s);
    snprintf(how, sizeof how, "%s%s", state, stopped ? ", the controller ended its session" : "");
    if (plant_s > 0.0)
        controller_fail(r, "plant time did not go on from %s s (%s)", when, how);
    else
        controller_fail(r, "plant time never ran (%s): the controller must enable and start the plant%s", how,
                        "");
}
