/* picture.c - see picture.h. */
#include "host_sim/fit/show/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/unit.h"
#include "host_sim/fit/profile.h"
#include "host_sim/fit/progress.h"
#include "host_sim/fit/solve/problem_levers.h"
#include "host_sim/fit/solve/unknown.h"
#include "host_sim/fit/tell.h"
#include "host_sim/report/figure.h"
#include "models/math/elementary.h"

enum { CURVE_PX = 150, RESIDUAL_PX = 70, PHASE_PX = 80, PROFILE_PX = 90 };
enum { DASHES = 95 }; /* points of a parabola, each fourth is a gap */

/* Columns of numbers of one curve or record. */
struct columns {
    int n;
    double *x, *data, *fit, *phase, *phase_fit, *residual, *residual_im;
    double *memory;
};

static bool make_columns(struct columns *c, int n)
{
    enum { COLUMNS = 7 };
    c->n = n;
    c->memory = calloc((size_t)n * COLUMNS, sizeof *c->memory);
    double **column[COLUMNS] = {&c->x,         &c->data,     &c->fit,        &c->phase,
                                &c->phase_fit, &c->residual, &c->residual_im};
    for (int i = 0; i < COLUMNS; i++)
        *column[i] = c->memory + (size_t)i * (size_t)n;
    return c->memory;
}

static void put(struct figure *g, enum figure_kind kind, const char *name, enum chart_colour colour,
                const struct columns *c, const double *y)
{
    figure_put(g, &(struct figure_layer){.kind = kind,
                                         .name = name,
                                         .legend = name,
                                         .colour = colour,
                                         .width = 4.0,
                                         .n = (size_t)c->n,
                                         .x = c->x,
                                         .y = y});
}

/* ---- curves ---- */

static void fill_curve(const struct fit_setup *s, const struct fit_result *r, int i, const double *residual,
                       struct columns *c)
{
    const struct curve *curve = &s->data.curve[i];
    for (int k = 0; k < curve->n; k++) {
        const struct curve_point *p = &curve->point[k];
        const struct fit_point *at = &s->point[i][k];
        double re = at->at.orbit.re, im = at->at.orbit.im;
        unknown_measure(s, r->u, p->frequency_Hz, &re, &im);
        c->x[k] = p->frequency_Hz;
        c->data[k] = sqrt(p->re * p->re + p->im * p->im);
        c->phase[k] = arc_tangent(p->im, p->re);
        c->fit[k] = at->at.found ? sqrt(re * re + im * im) : (double)NAN;
        c->phase_fit[k] = at->at.found ? arc_tangent(im, re) : (double)NAN;
        c->residual[k] = at->flank ? (double)NAN : residual[2 * k];
        c->residual_im[k] = at->flank || !curve->has_phase ? (double)NAN : residual[2 * k + 1];
    }
}

static void draw_curve(struct figure *g, const struct fit_setup *s, int i, const struct columns *c)
{
    const struct curve *curve = &s->data.curve[i];
    const struct model *m = s->scene.model;
    char level[UNIT_TEXT], title[FIGURE_TEXT];
    unit_tell(curve->amplitude, 4, m->input_signal[curve->input].unit, level);
    figure_axis(g, &(struct figure_axis){"frequency", "Hz", c->x[0], c->x[c->n - 1], false});
    snprintf(title, sizeof title, "amplitude of %s at %s, %s", curve_name(curve, m), level,
             curve->down ? "down" : "up");
    figure_panel(g, title, curve_unit(curve, m), CURVE_PX);
    put(g, FIGURE_LINE, "fit", CHART_RED, c, c->fit);
    put(g, FIGURE_POINTS, "data", CHART_BLUE, c, c->data);
    if (curve->has_phase) {
        figure_panel(g, "phase", "rad", PHASE_PX);
        put(g, FIGURE_LINE, "fit", CHART_RED, c, c->phase_fit);
        put(g, FIGURE_POINTS, "data", CHART_BLUE, c, c->phase);
    }
    figure_panel(g, "residuals, standard deviations", "", RESIDUAL_PX);
    put(g, FIGURE_POINTS, curve->has_phase ? "real part" : "amplitude", CHART_BLUE, c, c->residual);
    if (curve->has_phase)
        put(g, FIGURE_POINTS, "imaginary part", CHART_ORANGE, c, c->residual_im);
}

/* ---- records ---- */

static void draw_record(struct figure *g, const struct fit_setup *s, int i, const double *residual,
                        struct columns *c)
{
    const struct record *r = &s->records.record[i];
    const struct signal *y = &s->scene.model->output_signal[r->output];
    for (int k = 0; k < r->n; k++) {
        c->x[k] = k * r->step_s;
        c->data[k] = r->y[k];
        c->fit[k] = r->y[k] + residual[k] * r->noise;
        c->residual[k] = residual[k];
    }
    figure_axis(g,
                &(struct figure_axis){"time from the begin of the record", "s", 0.0, c->x[c->n - 1], false});
    figure_panel(g, y->name, y->unit, CURVE_PX);
    put(g, FIGURE_LINE, "data", CHART_BLUE, c, c->data);
    put(g, FIGURE_LINE, "fit", CHART_RED, c, c->fit);
    figure_panel(g, "residuals, standard deviations", "", RESIDUAL_PX);
    put(g, FIGURE_POINTS, "residual", CHART_BLUE, c, c->residual);
}

/* ---- levers ---- */

static void draw_lever(struct figure *g, struct fit_setup *s, const double *u, struct lever_data *d,
                       const double *residual, struct columns *c)
{
    bool heat = d->kind == LEVER_SPECTRUM;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int k = 0; k < d->n; k++) {
        double fit = problem_levers_value(s, d, u, k, false);
        c->x[k] = d->x[k];
        c->data[k] = heat ? log10(d->y[k]) : d->y[k];
        c->fit[k] = heat ? log10(fit) : fit;
        c->residual[k] = d->side[k] == LEVER_SKIPPED ? (double)NAN : residual[k];
        low = fmin(low, d->x[k]);
        high = fmax(high, d->x[k]);
    }
    figure_axis(g, &(struct figure_axis){heat ? "frequency" : "base", heat ? "Hz" : "m", low, high, false});
    figure_panel(g, heat ? "log10 of the density, m^2/Hz" : "deflection", heat ? "" : "m", CURVE_PX);
    put(g, FIGURE_POINTS, "data", CHART_BLUE, c, c->data);
    put(g, FIGURE_LINE, "fit", CHART_RED, c, c->fit);
    figure_panel(g, "residuals, standard deviations", "", RESIDUAL_PX);
    put(g, FIGURE_POINTS, "residual", CHART_BLUE, c, c->residual);
}

static bool draw_data(struct figure *g, struct fit_setup *s, const struct fit_result *r,
                      const double *residual)
{
    bool good = true;
    for (int i = 0; i < s->data.n && good; i++) {
        struct columns c;
        good = make_columns(&c, s->data.curve[i].n);
        if (good) {
            fill_curve(s, r, i, residual, &c);
            draw_curve(g, s, i, &c);
        }
        residual += 2 * s->data.curve[i].n;
        free(c.memory);
    }
    for (int i = 0; i < s->records.n && good; i++) {
        struct columns c;
        good = make_columns(&c, s->records.record[i].n);
        if (good)
            draw_record(g, s, i, residual, &c);
        residual += s->records.record[i].n;
        free(c.memory);
    }
    for (int i = 0; i < s->levers.n && good; i++) {
        struct columns c;
        struct lever_data *d = &s->levers.data[i];
        good = make_columns(&c, d->n);
        if (good)
            draw_lever(g, s, r->u, d, residual, &c);
        residual += d->n;
        free(c.memory);
    }
    return good;
}

/* ---- profiles ---- */

static void draw_profile(struct figure *g, const struct fit_setup *s, const struct fit_result *r,
                         const struct profile *p)
{
    const struct fit_unknown *k = &s->unknown[p->unknown];
    double x[PROFILE_POINTS], at[DASHES], parabola[DASHES];
    char title[FIGURE_TEXT];
    for (int i = 0; i < PROFILE_POINTS; i++)
        x[i] = isfinite(p->u[i]) ? unknown_value(k, p->u[i]) : (double)NAN;
    for (int i = 0; i < DASHES; i++) {
        double off = PROFILE_REACH * (2.0 * i / (DASHES - 1) - 1.0);
        at[i] = unknown_value(k, r->u[p->unknown] + off * r->sd[p->unknown]);
        parabola[i] = i % 4 == 3 ? (double)NAN : off * off;
    }
    struct columns c = {.n = PROFILE_POINTS, .x = x}, slopes = {.n = DASHES, .x = at};
    snprintf(title, sizeof title, "chi^2 above its least, over %s", k->name);
    figure_axis(g, &(struct figure_axis){k->name, k->unit, 0.0, 0.0, false});
    figure_panel(g, title, "", PROFILE_PX);
    put(g, FIGURE_LINE, "profile", CHART_BLUE, &c, p->rise);
    put(g, FIGURE_LINE, "by the interval, dashed", CHART_GREY, &slopes, parabola);
}

/* A bound of the interval by the profile, or a blank. */
static void put_bound(struct html *h, const struct fit_setup *s, const struct fit_result *r,
                      const struct profile *p, bool high)
{
    char text[UNIT_TEXT];
    const struct fit_unknown *k = &s->unknown[p->unknown];
    if (p->crossed[high])
        html_cell(h, "%s", tell_value(k, unknown_value(k, high ? p->high : p->low), r->sd[p->unknown], text));
    else
        html_cell(h, "unknown");
}

static void put_row(struct html *h, const struct fit_setup *s, const struct fit_result *r,
                    const struct profile *p)
{
    const struct fit_unknown *k = &s->unknown[p->unknown];
    double reach = judge_quantile(s, r, true) * r->sd[p->unknown];
    char text[UNIT_TEXT];
    html_row(h, false);
    html_cell(h, "%s", k->name);
    html_cell(h, "%s", tell_value(k, unknown_value(k, r->u[p->unknown]), r->sd[p->unknown], text));
    html_cell(h, "+- %s", tell_width(k, reach, text));
    put_bound(h, s, r, p, false);
    put_bound(h, s, r, p, true);
}

/* 0, or the exit status of an interruption, which is told. */
static int draw_profiles(struct figure *g, struct fit_setup *s, const struct fit_result *r)
{
    static struct profile p[FIT_UNKNOWNS];
    struct html *h = figure_page(g);
    int n = 0, whole = 0;
    s->task.to_the_end = false;
    for (int k = 0; k < s->n; k++)
        if (!fit_is_hidden(&s->unknown[k])) {
            whole += profile_find(s, r, k, &p[n++]);
            progress_tell(s, "profiles", k + 1, s->n);
        }
    s->task.to_the_end = true;
    progress_clear(s);
    if (h && whole < n)
        html_words(h, "Interrupted: %d of %d profiles are not whole.", n - whole, n);
    for (int i = 0; i < n; i++)
        draw_profile(g, s, r, &p[i]);
    if (h)
        html_table(h, "Unknowns", "name,value,95 %,95 % by the profile: from,to");
    for (int i = 0; i < n && h; i++)
        put_row(h, s, r, &p[i]);
    return whole == n || r->interrupted
               ? 0
               : options_failure(s->o.usage, "interrupted: %d of %d profiles are not whole", n - whole, n);
}

/* ---- all of it ---- */

static void put_words(struct html *h, const struct judged *j)
{
    html_words(h,
               "chi^2 per number is %.3g; runs %+.1f standard deviations from chance; worst point %s: %.1f.",
               j->chi2_each, j->runs, j->worst_at, j->worst);
    for (int i = 0; i < j->n; i++)
        html_words(h, "Refused: %s.", j->reason[i]);
    for (int i = 0; i < j->n_notes; i++)
        html_words(h, "Note: %s.", j->note[i]);
}

int picture_write(struct fit_setup *s, const struct fit_result *r, const struct judged *j)
{
    static struct figure g;
    struct problem p = {s, PROBLEM_PLAIN};
    if (!options_given(&s->o, "svg") && !options_given(&s->o, "report"))
        return 0;
    double *residual = calloc((size_t)s->n_residuals + 1, sizeof *residual);
    int status = residual ? figure_begin(&g, &s->o, s->name) : options_failure(s->o.usage, "out of memory");
    if (!status) {
        memset(s->smooth, 0, sizeof s->smooth);
        (void)problem_residuals(&p, r->u, residual);
        figure_subtitle(&g, j->n ? "refused: not to be believed" : "data, fit, residuals and profiles");
        if (figure_page(&g))
            put_words(figure_page(&g), j);
        if (!draw_data(&g, s, r, residual))
            status = options_failure(s->o.usage, "out of memory");
        int profiles = draw_profiles(&g, s, r), ended = figure_end(&g, &s->o);
        status = status ? status : ended ? ended : profiles;
    }
    free(residual);
    return status;
}
