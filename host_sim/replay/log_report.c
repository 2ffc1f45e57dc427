/* log_report.c - see log_report.h. */
#include "host_sim/replay/log_report.h"
#include "host_sim/report/html_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows that a band spans at least: they show every phase of nearly any motion that is fast for the rows. */
static const double band_rows = 40.0;

STATIC_ASSERT((int)DECODE_SIGNALS <= (int)DECIMATE_COLUMNS, signals_fit);

void log_report_begin_in(struct log_report *p, const struct html *h, const struct model *m)
{
    memset(p, 0, sizeof *p);
    p->html = *h;
    p->marker_s = (double)NAN;
    decimate_begin(&p->rows, DECODE_OUTPUTS + m->n_inputs);
    decimate_begin(&p->impacts, 1);
}

void log_report_end_in(struct log_report *p, struct html *h)
{
    *h = p->html;
    free(p->change);
}

/* From t_s on these contacts are closed. */
static void change(struct log_report *p, double t_s, unsigned closed)
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
    p->change[p->n_changes++] = (struct log_switch){t_s, closed};
    p->closed = closed;
}

void log_report_row(struct log_report *p, const struct decode_row *row)
{
    if (!p->rows.rows)
        p->first_s = row->t_s;
    if (!p->rows.rows || (row->closed != p->closed && row->t_s > p->change[p->n_changes - 1].t_s)) {
        p->seen += p->rows.rows > 0;
        change(p, row->t_s, row->closed);
    }
    decimate_add(&p->rows, row->t_s, row->value);
}

void log_report_event(struct log_report *p, const struct decode_event *e)
{
    unsigned long n = p->touchdowns + p->liftoffs;
    if (n < LOG_SWITCHES_TOLD)
        p->told[n] = *e;
    change(p, e->t_s, e->touch ? p->closed | 1u << e->contact : p->closed & ~(1u << e->contact));
    if (e->touch) {
        p->touchdowns++;
        p->hardest_m_per_s = fmax(p->hardest_m_per_s, fabs(e->speed));
        double speed = fabs(e->speed);
        decimate_add(&p->impacts, e->t_s, &speed);
    } else {
        p->liftoffs++;
        p->peak_N = fmax(p->peak_N, e->peak_force_N);
    }
}

static void put_words(struct log_report *p, const struct scene_app *s)
{
    struct html *h = &p->html;
    html_words(h, "%s, %.9g s of plant time in %zu rows.", s->config.model->name, p->rows.last - p->first_s,
               p->rows.rows);
    if (!s->config.model->n_contacts)
        return;
    html_words(
        h,
        "%lu touchdowns and %lu lift-offs were sent. The hardest impact had %.6g m/s, the largest force was "
        "%.6g N.",
        p->touchdowns, p->liftoffs, p->hardest_m_per_s, p->peak_N);
    if (p->seen)
        html_words(
            h, "Changes of contact seen in the rows alone, whose events were not sent or came later: %lu.",
            p->seen);
    html_words(h, "A band reaches from the least to the greatest of %.0f rows or more. No line joins rows.",
               band_rows);
}

/* Output k as a band; a command as the steps that it was, while they are few. */
static void put_signal(struct log_report *p, const struct scene_app *s, int k)
{
    const struct model *m = s->config.model;
    const struct signal *g = k < DECODE_OUTPUTS ? &m->output_signal[k] : &m->input_signal[k - DECODE_OUTPUTS];
    const struct decimate *d = &p->rows;
    char title[96];
    bool any = false;
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
    if (p->marker_s >= p->first_s && p->marker_s <= p->rows.last)
        html_marker(&p->html, p->marker_s, "%.9g s", p->marker_s);
}

static void put_contact(struct log_report *p)
{
    struct decimate_open *open = malloc(sizeof *open);
    p->no_memory |= !open;
    if (!open || !(p->rows.last > p->first_s)) {
        free(open);
        return;
    }
    decimate_open_begin(open, p->first_s, p->rows.last, 0);
    for (size_t i = 0; i < p->n_changes; i++)
        decimate_open_add(open, p->change[i].t_s, !p->change[i].closed);
    decimate_open_add(open, p->rows.last, 0);
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

static void put_switches(struct log_report *p)
{
    unsigned long n = p->touchdowns + p->liftoffs, told = n < LOG_SWITCHES_TOLD ? n : LOG_SWITCHES_TOLD;
    char title[64];
    snprintf(title, sizeof title, told < n ? "Contact switches, the first %lu of %lu" : "Contact switches",
             told, n);
    html_table(&p->html, title, "time (s),kind,contact,speed of the gap (m/s),peak force (N)");
    for (unsigned long i = 0; i < told; i++) {
        html_row(&p->html, false);
        html_cell(&p->html, "%.12g", p->told[i].t_s);
        html_cell(&p->html, p->told[i].touch ? "touchdown" : "liftoff");
        html_cell(&p->html, "%u", p->told[i].contact);
        html_cell(&p->html, "%.9g", p->told[i].speed);
        html_cell(&p->html, "%.9g", p->told[i].peak_force_N);
    }
}

void log_report_charts(struct log_report *p, const struct scene_app *s)
{
    put_words(p, s);
    for (int k = 0; k < p->rows.n_columns && p->rows.rows; k++)
        put_signal(p, s, k);
    if (s->config.model->n_contacts && p->rows.rows)
        put_contact(p);
    if (p->touchdowns + p->liftoffs)
        put_switches(p);
}

static void hear_row(void *context, const struct decode_event *e)
{
    log_report_event(context, e);
}

/* All rows and events of a log. NULL, or what went wrong. */
static const char *read_log(struct log_report *p, const char *log, const struct scene_app *s)
{
    static struct decode d;
    struct decode_row row;
    const char *why = decode_open(&d, log, &s->app.scene, s->app.plant.tick_s);
    int got;
    if (why)
        return why;
    d.heard = hear_row;
    d.context = p;
    while ((got = decode_next(&d, &row)) > 0)
        log_report_row(p, &row);
    decode_close(&d);
    return got < 0 ? d.reader.reason : p->no_memory ? "out of memory" : NULL;
}

int log_report(const struct options *o, const char *log, const struct scene_app *s, int argc, char **argv,
               void (*more)(struct html *h, const void *context), const void *context)
{
    static struct log_report p;
    struct html h;
    char title[128];
    const char *path = options_text(o, "report", 0), *why, *bad;
    if (!path)
        return 0;
    snprintf(title, sizeof title, "%s %.100s", o->usage->name,
             o->n_words ? o->word[0] : s->config.model->name);
    if ((why = html_begin(&h, path, title, argc, argv)))
        return options_failure(o->usage, "--report %s cannot be written: %s", path, why);
    log_report_begin_in(&p, &h, s->config.model);
    bad = read_log(&p, log, s);
    log_report_charts(&p, s);
    log_report_end_in(&p, &h);
    if (more)
        more(&h, context);
    html_scene(&h, s->origin == SCENE_OF_MODEL ? NULL : &s->scene, s->config.model, s->si);
    why = html_end(&h);
    why = bad ? bad : why;
    return why ? options_failure(o->usage, "--report %s is not complete: %s", path, why) : 0;
}
