/* log_report.c - see log_report.h. */
#include "host_sim/replay/log_report.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/cli/unit.h"
#include "host_sim/out/plural.h"
#include "host_sim/replay/decode_log.h"
#include "host_sim/replay/decode_signals.h"
#include "host_sim/report/html_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows that a band spans at least: they show every phase of nearly any motion that is fast for the rows. */
static const double band_rows = 40.0;

void log_report_begin_in(struct log_report *p, const struct html *h, const struct model *m)
{
    memset(p, 0, sizeof *p);
    p->html = *h;
    p->marker_s = (double)NAN;
    log_series_begin(&p->rows, m->n_inputs);
    decimate_begin(&p->impacts, 1);
}

void log_report_end_in(struct log_report *p, struct html *h)
{
    *h = p->html;
    free(p->change);
}

/* From t_s on these contacts are closed. */
static void change(struct log_report *p, double t_s, unsigned closed, bool known)
{
    if (p->n_changes == p->room) {
        size_t room = p->room ? 2 * p->room : 1024;
        struct log_switch *more = realloc(p->change, room * sizeof *more);
        p->no_memory |= !more;
        if (!more)
            return;
        p->change = more;
        p->room = room;
    }
    p->change[p->n_changes++] = (struct log_switch){t_s, closed, known};
    p->closed = closed;
    p->known = known;
}

void log_report_row(struct log_report *p, const struct decode_row *row)
{
    bool first = !p->rows.n, other = row->contact_known && p->known && row->closed != p->closed;
    bool silent = p->known && !row->contact_known && !row->due; /* nothing was to be said */
    if (first)
        p->first_s = row->t_s;
    p->n_anew = row->run;
    if (first || (row->contact_known != p->known && !silent) ||
        (other && row->t_s > p->change[p->n_changes - 1].t_s)) {
        p->seen += other;
        change(p, row->t_s, row->closed, row->contact_known);
    }
    log_series_add(&p->rows, row);
}

static void take_most(struct log_most *m, double value, bool has_data)
{
    m->n++;
    m->n_missing += !has_data;
    m->n_beyond += isnan(value) && has_data;
    m->most = fmax(m->most, fabs(value));
}

void log_report_event(struct log_report *p, const struct listen_event *e)
{
    unsigned long n = p->impact.n + p->peak.n;
    if (n < LOG_SWITCHES_SHOWN)
        p->shown[n] = *e;
    change(p, e->t_s, e->touch ? p->closed | 1u << e->contact : p->closed & ~(1u << e->contact), true);
    if (e->touch) {
        double speed = fabs(e->speed);
        take_most(&p->impact, speed, e->has_data);
        decimate_add(&p->impacts, e->t_s, &speed);
    } else {
        take_most(&p->peak, e->peak_force_N, e->has_data);
    }
}

/* ---- words ---- */

/* The trouble of the run, by the counters of the plant, or else by those that the log tells. */
static void put_trouble(struct html *h, const struct log_tally *t, const uint32_t *count)
{
    char text[TROUBLE_TEXT];
    bool all = count || log_tally_is_complete(t),
         any = trouble_list(count ? count : t->count, t->faults, text);
    if (any)
        html_words(h, "%s%s.", all ? "" : "At least ", text);
    else if (all)
        html_words(h, "No overrun, no missed frame, no time-out, no fault, and nothing was refused.");
    if (!all)
        html_words(h, "The log does not tell every counter of the plant (HEALTH): more may have gone wrong.");
}

static void put_most(struct html *h, const struct log_most *m, const char *what, const char *which,
                     double range, const char *unit)
{
    if (m->n_beyond)
        html_words(h, "%s at least %.4g %s: %lu of %lu %s were beyond the bus's range.", what,
                   fmax(range, m->most), unit, m->n_beyond, m->n, which);
    else if (m->n > m->n_missing)
        html_words(h, "%s %s%.6g %s.", what, m->n_missing ? "at least " : "", m->most, unit);
    if (m->n_missing)
        html_words(h, "%lu of %lu %s are missing in the log.", m->n_missing, m->n, which);
}

/* Rows whose contact never changed, and no event: what is known of it. */
static void put_no_switch(struct log_report *p, bool all_sent)
{
    bool known = p->known && p->n_changes > 0;
    if (!known)
        html_words(&p->html, "The log does not say whether contact was closed.");
    else if (!p->seen && all_sent)
        html_words(&p->html, "Contact did not change: it was %s all the time that is known.",
                   p->closed ? "closed" : "open");
    else
        html_words(&p->html, "No contact switch was sent.");
}

static void put_contacts(struct log_report *p, const struct wire_scene *w, const struct log_tally *t)
{
    struct html *h = &p->html;
    if (p->impact.n + p->peak.n == 0)
        put_no_switch(p, !(t->not_sent > 0.0));
    else
        html_words(h, "%lu touchdowns and %lu lift-offs were sent.", p->impact.n, p->peak.n);
    put_most(h, &p->impact, "The hardest impact had", "speeds", log_series_range(w, 1), "m/s");
    put_most(h, &p->peak, "The largest force was", "peaks", log_series_range(w, 3), "N");
    if (t->not_sent > 0.0)
        html_words(h, "%.0f contact events of the run were not sent: there may have been harder ones.",
                   t->not_sent);
    if (p->seen)
        html_words(
            h, "Changes of contact seen in the rows alone, whose events were not sent or came later: %lu.",
            p->seen);
}

/* Outputs that the bus could not say. */
static void put_beyond(struct log_report *p, const struct scene_app *s, const struct log_tally *t)
{
    for (int k = 0; k < DECODE_OUTPUTS; k++) {
        const struct signal *g = &s->config.model->output_signal[k];
        char range[UNIT_TEXT];
        if (!p->rows.n_beyond[k])
            continue;
        unit_tell(log_series_range(&s->app.scene, k), 3, g->unit, range);
        html_words(&p->html, "%zu of %zu row%s %s no %s: it was beyond the bus's range of %s%s.",
                   p->rows.n_beyond[k], p->rows.n, plural((double)p->rows.n),
                   p->rows.n_beyond[k] == 1 ? "has" : "have", g->name, range,
                   t->sensor_faults ? ", or a fault of its sensor withheld it" : "");
    }
}

static void put_words(struct log_report *p, const struct scene_app *s, const struct log_tally *t)
{
    struct html *h = &p->html;
    if (!p->rows.n) {
        html_words(h, "No row of the plant is in the log.");
        return;
    }
    if (p->n_anew)
        html_words(h,
                   "%s, %zu row%s. Plant time begins anew %u time%s in them: the plant was started again, or "
                   "this is more than one log. The charts lay all of them over each other.",
                   s->config.model->name, p->rows.n, plural((double)p->rows.n), p->n_anew, plural(p->n_anew));
    else
        html_words(h, "%s, %.9g s of plant time in %zu row%s.", s->config.model->name,
                   p->rows.bins.last - p->first_s, p->rows.n, plural((double)p->rows.n));
    if (s->config.model->n_contacts)
        put_contacts(p, &s->app.scene, t);
    put_beyond(p, s, t);
    html_words(h, "A band reaches from the least to the greatest of %.0f rows or more. No line joins rows.",
               band_rows);
}

/* ---- charts ---- */

static void put_marks(struct log_report *p, int k)
{
    double from, to;
    for (size_t i = 0; k < DECODE_OUTPUTS && log_series_next(&p->rows, k, &i, &from, &to);)
        html_span(&p->html, "beyond the bus's range", from, to);
    if (p->marker_s >= p->first_s && p->marker_s <= p->rows.bins.last)
        html_marker(&p->html, p->marker_s, "%.9g s", p->marker_s);
}

/* Output k as a band; a command as the steps that it was, while they are few. */
static void put_signal(struct log_report *p, const struct scene_app *s, int k)
{
    const struct model *m = s->config.model;
    const struct signal *g = decode_signal(m, k);
    const struct decimate *d = &p->rows.bins;
    char title[96];
    bool any = k < DECODE_OUTPUTS && p->rows.n_beyond[k];
    for (size_t i = 0; i < d->n; i++)
        any |= !isnan(d->low[k][i]);
    if (!any)
        return;
    snprintf(title, sizeof title, "%s%s", k < DECODE_OUTPUTS ? "" : "samples to ", g->name);
    html_chart(&p->html, title, g->unit, "plant time", "s");
    if (k >= DECODE_OUTPUTS && d->per == 1)
        html_line(&p->html, HTML_STEPS, g->name, d->n, d->x, d->low[k]);
    else
        html_band(&p->html, g->name, d->n, d->x, d->last,
                  k < DECODE_OUTPUTS ? band_rows * s->config.frame_s : 0.0, d->low[k], d->high[k]);
    put_marks(p, k);
}

static void put_contact(struct log_report *p)
{
    struct decimate_open *open = malloc(sizeof *open);
    p->no_memory |= !open;
    if (!open || !(p->rows.bins.last > p->first_s)) {
        free(open);
        return;
    }
    decimate_open_begin(open, p->first_s, p->rows.bins.last, DECIMATE_UNKNOWN);
    for (size_t i = 0; i < p->n_changes; i++)
        decimate_open_add(open, p->change[i].t_s,
                          p->change[i].known ? !p->change[i].closed : DECIMATE_UNKNOWN);
    decimate_open_add(open, p->rows.bins.last, 0);
    html_chart(&p->html, "contact", "", "plant time", "s");
    html_open(&p->html, DECIMATE_BINS, open->from, open->to, open->share);
    free(open);
    if (!p->impacts.n)
        return;
    html_chart(&p->html, "impact speed", "m/s", "plant time", "s");
    if (p->impacts.per == 1)
        html_line(&p->html, HTML_POINTS, "touchdown", p->impacts.n, p->impacts.x, p->impacts.low[0]);
    else
        html_band(&p->html, "touchdown", p->impacts.n, p->impacts.x, p->impacts.last, 0.0, p->impacts.low[0],
                  p->impacts.high[0]);
}

static void put_value(struct html *h, double value, bool has_data)
{
    if (!has_data)
        html_cell(h, "%s", "");
    else if (isnan(value))
        html_cell(h, "beyond the range");
    else
        html_cell(h, "%.9g", value);
}

static void put_switches(struct log_report *p)
{
    unsigned long n = p->impact.n + p->peak.n, shown = n < LOG_SWITCHES_SHOWN ? n : LOG_SWITCHES_SHOWN;
    char title[64];
    snprintf(title, sizeof title, shown < n ? "Contact switches, the first %lu of %lu" : "Contact switches",
             shown, n);
    html_table(&p->html, title, "time (s),kind,contact,speed of the gap (m/s),peak force (N)");
    for (unsigned long i = 0; i < shown; i++) {
        html_row(&p->html, false);
        html_cell(&p->html, "%.12g", p->shown[i].t_s);
        html_cell(&p->html, p->shown[i].touch ? "touchdown" : "liftoff");
        html_cell(&p->html, "%u", p->shown[i].contact);
        put_value(&p->html, p->shown[i].speed, p->shown[i].has_data);
        if (!p->shown[i].touch)
            put_value(&p->html, p->shown[i].peak_force_N, p->shown[i].has_data);
    }
}

void log_report_charts(struct log_report *p, const struct scene_app *s, const struct log_tally *tally)
{
    put_words(p, s, tally);
    for (int k = 0; k < p->rows.n_signals && p->rows.n; k++)
        put_signal(p, s, k);
    if (s->config.model->n_contacts && p->rows.n)
        put_contact(p);
    if (p->impact.n + p->peak.n)
        put_switches(p);
}

static void take_event(void *context, const struct listen_event *e)
{
    log_report_event(context, e);
}

/* All rows and events of a log. NULL, or what went wrong. */
static const char *read_log(struct log_report *p, struct decode_log *d, const char *log,
                            const char *interface, const struct scene_app *s)
{
    struct decode_row row;
    const char *why = decode_log_open(d, log, interface, &s->app.scene, s->app.plant.tick_s);
    int got;
    if (why)
        return why;
    d->rows.events.take = take_event;
    d->rows.events.context = p;
    while ((got = decode_log_next(d, &row)) > 0)
        log_report_row(p, &row);
    decode_log_close(d);
    return got < 0 ? d->log.reader.reason : p->no_memory ? "out of memory" : NULL;
}

int log_report(const struct options *o, const char *log, const char *interface, const struct scene_app *s,
               int argc, char **argv, const uint32_t *count,
               void (*more)(struct html *h, const void *context), const void *context)
{
    static struct log_report p;
    static struct decode_log d;
    struct html h;
    const char *path = options_text(o, "report", 0), *name = o->n_words ? o->word[0] : s->config.model->name;
    const char *why, *bad;
    if (!path)
        return 0;
    if ((why = html_begin(&h, path, o->usage->name, name, argc, argv)))
        return options_failure(o->usage, "--report %s cannot be written: %s", path, why);
    log_report_begin_in(&p, &h, s->config.model);
    bad = read_log(&p, &d, log, interface, s);
    put_trouble(&p.html, &d.rows.tally, count);
    log_report_charts(&p, s, &d.rows.tally);
    log_report_end_in(&p, &h);
    if (more)
        more(&h, context);
    html_scene(&h, s->origin == SCENE_OF_MODEL ? NULL : &s->scene, s->config.model, s->si);
    why = html_end(&h);
    why = bad ? bad : why;
    return why ? options_failure(o->usage, "--report %s is not complete: %s", path, why) : 0;
}
