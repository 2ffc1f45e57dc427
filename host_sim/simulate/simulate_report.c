/* simulate_report.c - see simulate_report.h. */
#include "firmware/plant/plant_report.h"
#include "host_sim/commands.h"
#include "host_sim/out/plural.h"
#include "host_sim/report/decimate.h"
#include "host_sim/report/html.h"
#include "host_sim/report/html_scene.h"
#include "host_sim/simulate/simulate_report.h"

#include <math.h>
#include <stdlib.h>

enum { SWITCHES_TOLD = 20 };

struct simulate_report {
    struct html html;
    struct decimate rows;
    struct decimate_open open;
    struct {
        double t, speed;
        int contact;
        bool touch;
    } told[SWITCHES_TOLD];
    unsigned touchdowns, liftoffs;
    unsigned regime; /* bit i: contact i closed */
    double hardest;
};

STATIC_ASSERT(MODEL_STATES + 1 <= (int)DECIMATE_COLUMNS, a_row_fits);

static int columns(const struct simulation *r)
{
    return r->model->n_states + (r->observable >= 0);
}

static const struct signal *signal_at(const struct simulation *r, int i)
{
    return i < r->model->n_states ? &r->model->state_signal[i] : &r->model->output_signal[r->observable];
}

int simulate_report_begin(struct simulation *r, int argc, char **argv)
{
    const char *path = options_text(r->o, "report", 0);
    if (!path)
        return 0;
    r->report = calloc(1, sizeof *r->report);
    if (!r->report)
        return options_failure(r->o->usage, "out of memory");
    const char *name = r->o->n_words ? r->o->word[0] : r->model->name;
    const char *why = html_begin(&r->report->html, path, "simulate", name, argc, argv);
    if (why) {
        free(r->report);
        r->report = NULL;
        return options_failure(r->o->usage, "cannot write %s: %s; choose another --report", path, why);
    }
    decimate_begin(&r->report->rows, columns(r));
    r->report->regime = r->plant.model ? r->plant.regime : 0; /* no plant: the run is of one instant */
    double last = r->at ? r->at[r->n_rows - 1] : (double)(r->n_rows - 1) * r->every;
    decimate_open_begin(&r->report->open, 0.0, last, !r->report->regime);
    return 0;
}

void simulate_report_row(struct simulation *r, double t, const double *value)
{
    if (r->report)
        decimate_add(&r->report->rows, t, value);
}

void simulate_report_event(struct simulation *r, double t, const struct event *e)
{
    struct simulate_report *p = r->report;
    if (!p)
        return;
    unsigned n = p->touchdowns + p->liftoffs;
    double speed = e->speed * r->dilation; /* seconds of the real plant, as those of the rows */
    if (n < SWITCHES_TOLD) {
        p->told[n].t = t;
        p->told[n].speed = speed;
        p->told[n].contact = e->contact;
        p->told[n].touch = e->touch;
    }
    if (e->touch) {
        p->touchdowns++;
        p->hardest = fmax(p->hardest, speed);
    } else
        p->liftoffs++;
    p->regime = e->touch ? p->regime | 1u << e->contact : p->regime & ~(1u << e->contact);
    decimate_open_add(&p->open, t, !p->regime);
}

/* Hz of the fastest input that sounds, in the time that is shown; 0 for none. */
static double fastest(const struct simulation *r)
{
    double omega = 0.0;
    for (int i = 0; i < r->model->n_inputs; i++)
        if (r->drive[i].amplitude < 0.0 || r->drive[i].amplitude > 0.0)
            omega = fmax(omega, r->drive[i].omega);
    return omega / (2.0 * acos(-1.0));
}

static void put_words(struct simulation *r, int status)
{
    struct simulate_report *p = r->report;
    struct html *h = &p->html;
    const char *s = r->paper ? "" : " s";
    html_words(h, "%s by method %s, from 0 to %.9g%s in %zu row%s.", r->model->name, r->method->name,
               p->rows.last, s, p->rows.rows, plural((double)p->rows.rows));
    if (status == STATUS_ESCAPED)
        html_words(h, "The motion escaped: the rows end before it.");
    else if (status)
        html_words(h, "The run did not come to its end; the rows end before it.");
    const struct plant *pl = &r->plant;
    if (pl->model && pl->counts.budget)
        html_words(h, "In %u segment%s there were too many switches: the rest was run through to the end.",
                   pl->counts.budget, plural(pl->counts.budget));
    if (pl->model && pl->counts.residual)
        html_words(h, "%u switch%s located with a residual above the bound.", pl->counts.residual,
                   pl->counts.residual == 1 ? " was" : "es were");
    if (r->model->n_contacts && p->touchdowns + p->liftoffs == 0)
        html_words(h, "Contact did not change: it was %s all the time.", p->regime ? "closed" : "open");
    else if (r->model->n_contacts)
        html_words(h, "Contact was made %u time%s and lost %u time%s.", p->touchdowns, plural(p->touchdowns),
                   p->liftoffs, plural(p->liftoffs));
    if (p->touchdowns)
        html_words(h, "The hardest impact had a speed of %.6g%s.", p->hardest, r->paper ? " in SI" : " m/s");
}

/* A line may join the rows where they are ten or more to a period of the fastest input. */
static void put_column(struct simulation *r, int k, bool joined, double period)
{
    struct simulate_report *p = r->report;
    const struct signal *g = signal_at(r, k);
    const char *name = k < r->model->n_states ? scenes_state_name(&r->scene, k) : g->name;
    html_chart(&p->html, name, r->paper ? "" : g->unit, "time", r->paper ? "" : "s");
    if (p->rows.per > 1)
        html_band(&p->html, name, p->rows.n, p->rows.x, p->rows.last, period, p->rows.low[k],
                  p->rows.high[k]);
    else
        html_line(&p->html, joined ? HTML_LINE : HTML_POINTS, name, p->rows.n, p->rows.x, p->rows.low[k]);
}

static void put_charts(struct simulation *r)
{
    struct simulate_report *p = r->report;
    double apart = p->rows.rows > 1 ? p->rows.last / (double)(p->rows.rows - 1) : 0.0;
    double f0 = 1.0 / r->scale.time_s / (2.0 * acos(-1.0)), drive = fastest(r);
    double period =
        1.0 / (drive > 0.5 * f0 ? drive : f0); /* a slower drive leaves the free motion as the fastest */
    bool joined = apart * fmax(drive, f0) <= 0.1;
    if (p->rows.per > 1)
        html_words(
            &p->html,
            "Bands reach from the least to the greatest row within %.6g: %zu row%s, or a period of the "
            "fastest motion.",
            fmax(apart * (double)p->rows.per, period), p->rows.per, plural((double)p->rows.per));
    else if (!joined)
        html_words(
            &p->html,
            "Rows are %.6g apart, fewer than ten to a period of the fastest motion: no line joins them.",
            apart);
    for (int k = 0; k < columns(r); k++)
        put_column(r, k, joined, period);
    if (r->model->n_contacts && p->open.to > p->open.from) {
        decimate_open_add(&p->open, p->rows.last, 0);
        html_chart(&p->html, "contact", "", "time", r->paper ? "" : "s");
        html_open(&p->html, DECIMATE_BINS, p->open.from, p->open.to, p->open.share);
    }
}

static void put_switches(struct simulation *r)
{
    struct simulate_report *p = r->report;
    unsigned n = p->touchdowns + p->liftoffs, told = n < SWITCHES_TOLD ? n : SWITCHES_TOLD;
    char title[64];
    snprintf(title, sizeof title, told < n ? "Contact switches, the first %u of %u" : "Contact switches",
             told, n);
    if (!n)
        return;
    html_table(&p->html, title,
               r->paper ? "time,kind,contact,speed of the gap (SI)"
                        : "time (s),kind,contact,speed of the gap (m/s)");
    for (unsigned i = 0; i < told; i++) {
        html_row(&p->html, false);
        html_cell(&p->html, "%.12g", p->told[i].t);
        html_cell(&p->html, p->told[i].touch ? "touchdown" : "liftoff");
        html_cell(&p->html, "%d", p->told[i].contact);
        html_cell(&p->html, "%.6g", p->told[i].speed);
    }
}

static void put_counters(struct simulation *r)
{
    const struct plant *pl = &r->plant;
    struct html *h = &r->report->html;
    if (!pl->model)
        return;
    html_table(h, "Counters and hash", "name,value");
    const struct {
        const char *name;
        double value;
    } count[] = {{"ticks", (double)pl->now.tick},
                 {"switches located", pl->counts.switches},
                 {"segments with too many switches", pl->counts.budget},
                 {"switches with a residual above the bound", pl->counts.residual},
                 {"energy that does not balance, J", plant_residual(pl)}};
    for (size_t i = 0; i < sizeof count / sizeof *count; i++) {
        html_row(h, false);
        html_cell(h, "%s", count[i].name);
        html_cell(h, "%.9g", count[i].value);
    }
    html_row(h, false);
    html_cell(h, "hash of the state");
    html_cell(h, "%016llx", (unsigned long long)plant_hash(pl));
}

int simulate_report_end(struct simulation *r, int status)
{
    struct simulate_report *p = r->report;
    if (!p)
        return status;
    put_words(r, status);
    if (p->rows.rows)
        put_charts(r);
    put_switches(r);
    put_counters(r);
    html_scene(&p->html, r->origin == SCENE_OF_MODEL ? NULL : &r->scene, r->model, r->si);
    const char *why = html_end(&p->html);
    free(p);
    r->report = NULL;
    if (why && !status)
        return options_failure(r->o->usage, "--report is not complete: %s", why);
    return status;
}
