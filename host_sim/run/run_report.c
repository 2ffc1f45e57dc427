/* run_report.c - see run_report.h. */
#include "firmware/plant/plant_report.h"
#include "host_sim/run/run_report.h"
#include "firmware/app/account.h"
#include "host_sim/replay/log_report.h"

int run_report_check(const struct options *o)
{
    if (options_given(o, "report") && !options_given(o, "log"))
        return options_misuse(o->usage, "--report is made from the recording; give --log too");
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
