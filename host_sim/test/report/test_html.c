/* test_html.c - see test_html.h. */
#include "host_sim/test/report/test_html.h"
#include "host_sim/replay/decode_log.h"
#include "host_sim/replay/log_report.h"
#include "host_sim/test/bench/bench_plant.h"

#include <math.h>
#include <stdio.h>
#include "host_sim/cli/trouble.h"
#include "host_sim/cli/unit.h"
#include "host_sim/out/plural.h"

static const double around_s = 0.25; /* before and behind what decided a failure */

/* The first expectation that failed at a time, or NULL. */
static const struct outcome *failure(const struct bench_result *w)
{
    for (int i = 0; i < w->n; i++)
        if (w->outcome[i].verdict == VERDICT_FAIL && w->outcome[i].value.known &&
            w->outcome[i].value.when_s >= 0.0)
            return &w->outcome[i];
    return NULL;
}

/* How many of the cases went well, and which of them had trouble. */
static void put_headline(struct html *h, const struct report_case *r, int n)
{
    int good = 0;
    char text[TROUBLE_TEXT];
    for (int i = 0; i < n; i++)
        good += r[i].worst->verdict == VERDICT_OK;
    html_words(h, "%d of %d case%s %s ok.", good, n, plural(n), good == 1 ? "is" : "are");
    for (int i = 0; i < n; i++)
        if (trouble_list(r[i].worst->count, r[i].worst->faults, text))
            html_words(h, "%s: %s.", r[i].c->name, text);
}

static void put_verdicts(struct html *h, const struct report_case *r, int n)
{
    html_table(h, "Verdicts", "case,verdict,bad runs,runs,plant time (s),hash of the worst run");
    for (int i = 0; i < n; i++) {
        html_row(h, r[i].worst->verdict != VERDICT_OK);
        html_cell(h, "%s", r[i].c->name);
        html_cell(h, "%s", report_verdict[r[i].worst->verdict]);
        html_cell(h, "%d", r[i].n_bad);
        html_cell(h, "%d", r[i].n_runs);
        html_cell(h, "%.6g", r[i].plant_s);
        html_cell(h, "%016llx", (unsigned long long)r[i].worst->hash);
    }
}

/* The first expectation with the verdict of the case. */
static const struct outcome *decisive(const struct bench_result *w)
{
    for (int i = 0; i < w->n; i++)
        if (w->outcome[i].verdict == w->verdict)
            return &w->outcome[i];
    return NULL;
}

static void put_traced(struct html *h, const struct report_case *r, const char *id, const char *text)
{
    const struct bench_result *w = r->worst;
    const struct outcome *o = decisive(w);
    html_row(h, w->verdict != VERDICT_OK);
    html_cell(h, "%s", id);
    html_cell(h, "%s", text);
    html_cell(h, "%s", r->c->name);
    html_cell(h, "%s", report_verdict[w->verdict]);
    if (r->c->names_seed)
        html_cell(h, "%u", (unsigned)w->seed);
    else
        html_cell(h, "%s", "");
    html_cell(h, "%s", o ? o->text : "");
    html_cell(h, "%s", o ? o->found : w->error);
}

/* Whether a case before the i-th, or before its k-th requirement, names this one. */
static bool is_put(const struct report_case *r, int i, const char *id)
{
    for (int k = 0; k < i; k++)
        if (requirements_names(r[k].c, id))
            return true;
    return false;
}

/* Requirement by case, in the order of the cases, and then those without one. */
static void put_matrix(struct html *h, const struct report_case *r, int n, const struct requirements *all,
                       const struct requirements *untraced)
{
    int named = 0;
    for (int i = 0; i < n; i++)
        named += r[i].c->n_requirements;
    if (!named && !untraced->n)
        return;
    html_table(h, "Requirements", "requirement,text,case,verdict,worst seed,expect,found");
    for (int i = 0; i < n; i++)
        for (int k = 0; k < r[i].c->n_requirements; k++) {
            const char *id = r[i].c->requirement[k];
            for (int m = i; m < n && !is_put(r, i, id); m++)
                if (requirements_names(r[m].c, id))
                    put_traced(h, &r[m], id, requirements_text(all, id));
        }
    for (int i = 0; i < untraced->n; i++) {
        html_row(h, true);
        html_cell(h, "%s", untraced->entry[i].id);
        html_cell(h, "%s", untraced->entry[i].text);
        html_cell(h, "%s", "no case names it");
        for (int k = 0; k < 4; k++)
            html_cell(h, "%s", "");
    }
}

/* The peaks of the whole run, which the plant itself knows, and its trouble. */
static void put_run(struct html *h, const struct bench_result *w)
{
    const struct metric_value *force = &w->truth[0], *speed = &w->truth[1];
    char text[TROUBLE_TEXT], a[UNIT_TEXT], b[UNIT_TEXT];
    unit_tell(force->value, 4, "N", a);
    unit_tell(speed->value, 4, "m/s", b);
    if (force->known && force->value > 0.0)
        html_words(h, "Largest force of the run, by the plant itself: %s at %.6g s.", a, force->when_s);
    if (speed->known && speed->value > 0.0)
        html_words(h, "Hardest impact of the run, by the plant itself: %s at %.6g s.", b, speed->when_s);
    if (trouble_list(w->count, w->faults, text))
        html_words(h, "In this run: %s.", text);
}

static void put_expectations(struct html *h, const struct report_case *r)
{
    const struct bench_result *w = r->worst;
    char title[TEST_NAME + 64];
    snprintf(title, sizeof title, "%s: %s", r->c->name, report_verdict[w->verdict]);
    html_table(h, title, "line,expect,verdict,found");
    for (int i = 0; i < w->n; i++) {
        const struct outcome *o = &w->outcome[i];
        html_row(h, o->verdict != VERDICT_OK);
        html_cell(h, "%d", o->line ? o->line : r->c->line);
        html_cell(h, "%s", o->text);
        html_cell(h, "%s", report_verdict[o->verdict]);
        html_cell(h, "%s", o->found);
    }
    put_run(h, w);
    if (*w->error)
        html_words(h, "%s", w->error);
    if (r->c->names_seed)
        html_words(h, "The worst run has seed %u.", w->seed);
    if (w->varied)
        html_words(h, "The worst run has %.9g for what is varied.", w->varied_value);
    if (*w->log)
        html_words(h, "Its log is %s.", w->log);
}

/* The part of a log that is shown. */
struct excerpt {
    struct log_report report;
    double from_s, to_s;
};

static void take_event(void *context, const struct listen_event *e)
{
    struct excerpt *x = context;
    if (x->report.rows.n && e->t_s >= x->from_s && e->t_s <= x->to_s)
        log_report_event(&x->report, e);
}

static void read_excerpt(struct excerpt *x, struct decode_log *d)
{
    struct decode_row row;
    d->rows.events.take = take_event;
    d->rows.events.context = x;
    while (decode_log_next(d, &row) > 0)
        if (row.t_s >= x->from_s && row.t_s <= x->to_s)
            log_report_row(&x->report, &row);
}

/* Charts of the worst run's log around its failure, or of all of it where only its end decided. */
static void put_charts(struct html *h, const struct report_case *r, const struct outcome *o)
{
    static struct bench_plant plant;
    static struct excerpt x;
    static struct decode_log d;
    const struct bench_result *w = r->worst;
    double when_s = o->value.when_s, width_s = when_s < w->plant_s ? around_s : w->plant_s;
    char why[TEST_REASON];
    if (bench_plant_open(&plant, r->test, r->c, w->varied ? &w->varied_value : NULL, why)) {
        log_report_begin_in(&x.report, h, plant.scene.config.model);
        x.report.marker_s = when_s;
        x.from_s = when_s - width_s;
        x.to_s = when_s + width_s;
        const char *refused =
            decode_log_open(&d, w->log, NULL, &plant.scene.app.scene, plant.scene.app.plant.tick_s);
        if (refused) {
            html_words(&x.report.html, "No charts: %s.", refused);
        } else {
            read_excerpt(&x, &d);
            decode_log_close(&d);
            html_words(&x.report.html, "%s, line %d, failed at %.9g s:", r->c->name,
                       o->line ? o->line : r->c->line, when_s);
            log_report_charts(&x.report, &plant.scene, &d.rows.tally);
        }
        log_report_end_in(&x.report, h);
    }
    bench_plant_close(&plant);
}

static void put_case(struct html *h, const struct report_case *r)
{
    const struct outcome *o = failure(r->worst);
    put_expectations(h, r);
    if (!o)
        return;
    if (*r->worst->log)
        put_charts(h, r, o);
    else
        html_words(h, "With --log FOLDER there are charts around %.9g s here.", o->value.when_s);
}

int test_html(const struct options *o, int argc, char **argv, const struct report_case *r, int n,
              const struct requirements *all, const struct requirements *untraced)
{
    struct html h;
    const char *path = options_text(o, "report", 0);
    if (!path)
        return 0;
    const char *why = html_begin(&h, path, "test", NULL, argc, argv);
    if (why)
        return options_failure(o->usage, "--report %s cannot be written: %s", path, why);
    put_headline(&h, r, n);
    put_verdicts(&h, r, n);
    put_matrix(&h, r, n, all, untraced);
    for (int i = 0; i < n; i++)
        put_case(&h, &r[i]);
    why = html_end(&h);
    return why ? options_failure(o->usage, "--report %s is not complete: %s", path, why) : 0;
}
