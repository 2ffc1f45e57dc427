/* run_outcome.c - see run_outcome.h. */
#include "host_sim/run/run_outcome.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include "firmware/app/account.h"
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/cli/files.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/commands.h"
#include "host_sim/out/json.h"
#include "host_sim/replay/log_report.h"

enum { CAUSES_OF_FAILURE = 3, WORD = 32 };
enum { MISSED, LATE, FAULT };
static const char *const cause_name[CAUSES_OF_FAILURE] = {"missed", "late", "fault"};

const struct option run_outcome_options[] = {
    {"json", "FILE", "also write the report as JSON: time, hash, state, every counter", OPTION_WRITES,
     .initial = NULL},
    {"fail-on", "LIST",
     "end with status 1 after any of: missed (frames), late (commands), fault; separated by commas",
     OPTION_TEXT, .initial = NULL},
    {.name = NULL},
};

/* Behind the next comma; NULL: there is none. */
static const char *next_word(const char *at)
{
    at = strchr(at, ',');
    return at ? at + 1 : NULL;
}

/* Whether the list has this word. */
static bool has(const char *list, const char *wanted)
{
    size_t n = strlen(wanted);
    for (const char *at = list; at; at = next_word(at))
        if (!strncmp(at, wanted, n) && (at[n] == ',' || !at[n]))
            return true;
    return false;
}

int run_outcome_check(const struct options *o)
{
    const char *list = options_text(o, "fail-on", 0);
    for (const char *at = list; at; at = next_word(at)) {
        char word[WORD];
        bool known = false;
        snprintf(word, sizeof word, "%.*s", (int)strcspn(at, ","), at);
        for (int i = 0; i < CAUSES_OF_FAILURE; i++)
            known = known || !strcmp(word, cause_name[i]);
        if (!known)
            return options_misuse(o->usage, "--fail-on: \"%s\" is no cause of failure%s", word,
                                  options_advise(word, strlen(word), cause_name, CAUSES_OF_FAILURE, NULL));
    }
    return STATUS_DONE;
}

static bool write_json(const struct run_outcome *r, const char *path)
{
    const struct app *a = r->app;
    uint32_t count[DIAG_COUNTERS];
    struct json j;
    FILE *f = files_compose(path);
    if (!f)
        return false;
    account_counts(a, count);
    json_begin_file(&j, f);
    json_put(&j, "{'model': %s, 'method': %s, 'state': %s, 'faults': %u,\n", a->plant.model->name,
             a->plant.method->name, names_text(a->config.model, NAMES_STATE, (unsigned)a->state),
             (uint64_t)r->faults);
    json_put(&j, " 'frames': %u, 'frame_s': %e, 'missed': %u, 'plant_s': %e, 'tick': %u,\n", r->frames,
             a->config.frame_s, r->missed, plant_time(&a->plant), a->plant.now.tick);
    json_put(&j, " 'hash': %h, 'residual_J': %e,\n 'counters': {", plant_hash(&a->plant),
             plant_residual(&a->plant));
    for (int i = 0; i < DIAG_COUNTERS; i++)
        json_item(&j, "'%r': %u", diag_name[i].name, (uint64_t)count[i]);
    json_put(&j, "}}\n");
    return files_finish(f, true);
}

int run_outcome_tell(const struct run_outcome *r, const struct options *o)
{
    const char *list = options_text(o, "fail-on", 0), *json = options_text(o, "json", 0);
    const double n[CAUSES_OF_FAILURE] = {
        [MISSED] = (double)r->missed, [LATE] = r->app->count[DIAG_LATE], [FAULT] = r->faults};
    int status = STATUS_DONE;
    char names[TROUBLE_TEXT];
    trouble_note_faults(r->faults, names);
    for (int i = 0; i < CAUSES_OF_FAILURE; i++)
        if (list && has(list, cause_name[i]) && n[i] > 0.0)
            status = options_failure(o->usage, "--fail-on %s: %.0f%s", cause_name[i], n[i],
                                     i == FAULT ? names : "");
    if (json && !write_json(r, json))
        status = options_failure(o->usage, "--json %s cannot be written: %s", json, strerror(errno));
    return status;
}

/* ---- the page ---- */

int run_report_check(const struct options *o)
{
    if (options_given(o, "report") && !options_given(o, "log"))
        return options_misuse(o->usage, "--report is made from the recording; give --log too");
    return 0;
}

static void put_histogram(struct html *h, const char *title, const struct histogram *t)
{
    html_table(h, title, "less than (µs),frames");
    for (unsigned i = 0; i < TIMING_BINS; i++) {
        if (!t->bin[i])
            continue;
        html_row(h, false);
        html_cell(h, "%u", 1u << i);
        html_cell(h, "%u", t->bin[i]);
    }
}

static void put_counters(struct html *h, const void *context)
{
    const struct app *a = context;
    uint32_t count[DIAG_COUNTERS];
    account_counts(a, count);
    html_table(h, "Counters and hash", "name,value,unit");
    for (unsigned i = 0; i < DIAG_COUNTERS; i++) {
        if (!count[i])
            continue;
        html_row(h, false);
        html_cell(h, "%s", diag_name[i].name);
        html_cell(h, "%u", count[i]);
        html_cell(h, "%s", diag_name[i].unit);
    }
    html_row(h, false);
    html_cell(h, "hash of the state");
    html_cell(h, "%016llx", (unsigned long long)plant_hash(&a->plant));
    if (!a->timing.compute.bin[0] && !a->timing.compute.max_frame)
        return;
    put_histogram(h, "Lateness of frames", &a->timing.lateness);
    put_histogram(h, "Computing time of frames", &a->timing.compute);
}

int run_report(const struct options *o, const struct scene_app *s, int argc, char **argv)
{
    uint32_t count[DIAG_COUNTERS];
    account_counts(&s->app, count);
    return log_report(o, options_text(o, "log", 0), NULL, s, argc, argv, count, put_counters, &s->app);
}
