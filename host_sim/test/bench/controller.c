/* controller.c - see controller.h. */
#include "host_sim/test/bench/controller.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/files.h"
#include "host_sim/cli/shell.h"
#include "host_sim/scene/scene_keys.h"
#include "models/afm_lever.h"
#include "models/models.h"

enum { OPTIONS_TEXT = 2048, NUMBER = 32, LOG_END = 128 };

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
static void write_options(const struct test_file *t, const struct scene_app *s,
                          const struct controller_place *at, char text[OPTIONS_TEXT])
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
    for (int i = 0; t->lever.model && i < LEVER_PARAMETERS && n < OPTIONS_TEXT; i++)
        n += (size_t)snprintf(text + n, OPTIONS_TEXT - n, " --set %s=%.17g", c->model->parameter[i].name,
                              s->scene.value[i]);
    for (int i = 0; i < t->plant.n && n < OPTIONS_TEXT; i++) {
        bool setting = t->plant.set[i].index >= SETTING_FIRST;
        n += (size_t)snprintf(text + n, OPTIONS_TEXT - n, " --%s %s=%.17g", setting ? "setting" : "set",
                              scene_parameter(c->model, (int)t->plant.set[i].index)->name,
                              t->plant.set[i].value);
    }
}

bool controller_takes_memory(const struct test_file *t)
{
    return strstr(t->command, "{memory}") != NULL;
}

struct placeholder {
    const char *name, *text;
    bool as_it_is; /* several words of the shell, or none */
};

/* Writes the command with what stands in braces filled in, each as one word of the shell. */
static void put_filled(FILE *f, const char *from, const struct placeholder *known, int n)
{
    struct quotes at = {0, false};
    while (*from) {
        int i = 0;
        while (i < n && strncmp(from, known[i].name, strlen(known[i].name)))
            i++;
        if (i == n) {
            quotes_pass(&at, *from);
            fputc(*from++, f);
            continue;
        }
        if (known[i].as_it_is)
            fputs(known[i].text, f);
        else
            shell_put(f, at, known[i].text);
        from += strlen(known[i].name);
    }
}

/* The command of this run, to be freed; NULL: out of memory. */
static char *fill(const struct bench_setting *s, const struct scene_app *scene,
                  const struct controller_place *at, uint32_t run_seed)
{
    char rate[NUMBER], substeps[NUMBER], seed[NUMBER], options[OPTIONS_TEXT], *text = NULL;
    size_t size;
    const struct placeholder known[] = {
        {"{plant}", at->plant, false},
        {"{me}", at->me, false},
        {"{rate}", rate, false},
        {"{substeps}", substeps, false},
        {"{seed}", seed, false},
        {"{scene}", s->test->lever.model ? scene->config.model->name : s->test->scene_name, false},
        {"{options}", options, true},
        {"{contactplant}", s->program, false},
        {"{memory}", at->memory ? at->memory : "", true}};
    snprintf(rate, sizeof rate, "%.17g", 1.0 / scene->config.frame_s);
    snprintf(substeps, sizeof substeps, "%u", scene->config.substeps);
    snprintf(seed, sizeof seed, "%u", run_seed);
    write_options(s->test, scene, at, options);
    FILE *f = open_memstream(&text, &size);
    if (!f)
        return NULL;
    put_filled(f, s->test->command, known, (int)(sizeof known / sizeof known[0]));
    if (fclose(f) == 0)
        return text;
    free(text);
    return NULL;
}

/* ---- the process ---- */

/* Values that six digits do not tell apart get their number, too. */
static int write_varied(const struct test_case *c, int i, char *text, size_t size)
{
    char before[NUMBER], behind[NUMBER], own[NUMBER];
    snprintf(own, sizeof own, "%.6g", range_value(&c->vary, i));
    snprintf(before, sizeof before, "%.6g", range_value(&c->vary, i > 0 ? i - 1 : i + 1));
    snprintf(behind, sizeof behind, "%.6g", range_value(&c->vary, i + 1 < c->vary.n ? i + 1 : i - 1));
    bool alone = strcmp(own, before) && strcmp(own, behind);
    return alone ? snprintf(text, size, ".%s", own) : snprintf(text, size, ".%s-%d", own, i + 1);
}

void controller_log_path(const struct bench_setting *s, const struct bench_result *r, const char *end,
                         char path[BENCH_PATH])
{
    const struct test_case *c = &s->test->cases[r->i_case];
    int n = snprintf(path, BENCH_PATH - LOG_END, "%s/%s", s->log, c->record);
    n = n < BENCH_PATH - LOG_END ? n : BENCH_PATH - LOG_END - 1;
    if (c->names_seed)
        n += snprintf(path + n, (size_t)(BENCH_PATH - n), ".%u", r->seed);
    if (r->varied)
        n += write_varied(c, r->i_varied, path + n, (size_t)(BENCH_PATH - n));
    snprintf(path + n, (size_t)(BENCH_PATH - n), "%s", end);
}

bool controller_start(struct controller *c, const struct bench_setting *s, const struct scene_app *scene,
                      const struct controller_place *at, struct bench_result *r)
{
    char folder[BENCH_PATH], path[BENCH_PATH], why[CHILD_REASON];
    const char *slash = strrchr(s->test->file, '/');
    if (s->test->attached)
        return true;
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - s->test->file) : 1,
             slash ? s->test->file : ".");
    if (slash == s->test->file)
        snprintf(folder, sizeof folder, "/");
    if (s->log) {
        controller_log_path(s, r, ".controller.txt", path);
        c->output = files_create(path);
        if (!c->output)
            return controller_fail(r, "--log: cannot write %.400s%s", path, "");
    }
    char *command = fill(s, scene, at, r->seed);
    bool started = command && child_start(&c->child, command, folder, c->output, why);
    if (!started)
        controller_fail(r, "%s%s", command ? why : "out of memory", "");
    free(command);
    return started;
}

void controller_end(struct controller *c, struct bench_result *r)
{
    char left[NUMBER];
    int n = child_end(&c->child);
    snprintf(left, sizeof left, "%d", n);
    if (n && r->verdict != VERDICT_ERROR)
        controller_fail(r, "the controller left %s processes behind, which were ended%s", left, "");
    if (c->output && !files_finish(c->output, true) && r->verdict != VERDICT_ERROR)
        controller_fail(r, "--log: cannot write what the controller printed: %s%s", files_unwritten(errno),
                        "");
    c->output = NULL;
}

/* ---- its end before its time ---- */

/* Whether the case says what is expected when the controller ends its session by itself. */
static bool may_stop(const struct test_case *c)
{
    for (int i = 0; i < c->n_expects; i++)
        if (c->expect[i].what.kind == METRIC_STOPPED)
            return true;
    return false;
}

bool controller_has_ended(struct controller *c, const struct test_case *k, double plant_s, bool stopped,
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

void controller_explain_stand(const struct test_case *k, const char *state, double plant_s, bool stopped,
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
