/* run_report.c - see run_report.h. */
#include "host_sim/live/run_report.h"
#include "firmware/app/account.h"
#include "host_sim/replay/log_report.h"
#include "host_sim/scene/scene_load.h"

#include <string.h>

int run_report_check(const struct options *o, const struct scene_app *s)
{
    const char *path = options_text(o, "report", 0), *log = options_text(o, "log", 0);
    if (!path)
        return 0;
    if (!log)
        return options_misuse(o->usage, "--report is made from the recording; give --log too");
    if (scene_load_same(path, log) || scene_load_is(s->origin, o->n_words ? o->word[0] : "", path))
        return options_misuse(o->usage, "--report %s is another file of this command; choose one of its own",
                              path);
    return 0;
}

static void put_histogram(struct html *h, const char *title, const struct histogram *t)
{
    html_table(h, title, "less than (us),frames");
    for (unsigned i = 0; i < TIMING_BINS; i++) {
        if (!t->bin[i])
            continue;
        html_row(h, false);
        html_cell(h, "%u", 1u << i);
        html_cell(h, "%u", t->bin[i]);
    }
}

static void put_counters(struct html *h, const struct app *a)
{
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

/* All rows and events of the log. NULL, or what went wrong. */
static const char *read_log(struct log_report *p, struct decode *d)
{
    struct decode_row row;
    int got;
    while ((got = decode_next(d, &row)) > 0)
        log_report_row(p, &row);
    return got < 0 ? d->reader.reason : NULL;
}

static void hear(void *context, const struct decode_event *e)
{
    log_report_event(context, e);
}

int run_report(const struct options *o, const struct scene_app *s, int argc, char **argv)
{
    static struct log_report report;
    static struct decode d;
    const char *path = options_text(o, "report", 0), *why, *bad;
    char title[128];
    if (!path)
        return 0;
    snprintf(title, sizeof title, "run %.100s", o->n_words ? o->word[0] : s->config.model->name);
    if ((why = log_report_begin(&report, path, title, s->config.model, argc, argv)))
        return options_failure(o->usage, "--report %s cannot be written: %s", path, why);
    bad = decode_open(&d, options_text(o, "log", 0), &s->app.scene, s->app.plant.tick_s);
    d.heard = hear;
    d.context = &report;
    if (!bad) {
        bad = read_log(&report, &d);
        decode_close(&d);
    }
    log_report_charts(&report, s);
    put_counters(&report.html, &s->app);
    why = log_report_end(&report, s);
    why = bad ? bad : why;
    return why ? options_failure(o->usage, "--report %s is not complete: %s", path, why) : 0;
}
