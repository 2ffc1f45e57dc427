/* random_report.c - see random_report.h. */
#include "host_sim/maps/random/random_report.h"
#include "host_sim/cli/files.h"
#include "host_sim/out/cell.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "host_sim/maps/random/random_law.h"

/* The band of the picture, in standard errors to each side. */
static const double errors = 2.0;

struct estimate {
    double value, error; /* standard */
};

struct report {
    const struct random_runs *r;
    struct rows_table t;
    struct random_law *law; /* NULL: there is none */
    int n;                  /* realisations that stayed finite */
};

/* A number of one realisation, from its row. */
typedef double number(const struct random_runs *r, const double *row, int i);

static double cell(const struct random_runs *r, const double *row, int i)
{
    (void)r;
    return row[i];
}

static double row_density(const struct random_runs *r, const double *row, int bin)
{
    return row[RANDOM_BIN + bin] / (random_edge(r, 1) - random_edge(r, 0));
}

static double row_above(const struct random_runs *r, const double *row, int edge)
{
    double sum = 0.0;
    for (int i = edge; i <= r->n_bins; i++)
        sum += row[RANDOM_BIN + i];
    return sum;
}

static double row_crossing(const struct random_runs *r, const double *row, int edge)
{
    return row[RANDOM_BIN + r->n_bins + 1 + edge];
}

static const double *row_of(const struct report *p, int i)
{
    return rows_row(&p->t, i);
}

static bool stayed(const struct report *p, int i)
{
    return row_of(p, i)[RANDOM_FINITE] > 0.0;
}

static struct estimate estimate(const struct report *p, number *f, int k)
{
    double mean = 0.0, square = 0.0;
    for (int i = 0; i < p->t.n; i++)
        mean += stayed(p, i) ? f(p->r, row_of(p, i), k) / p->n : 0.0;
    for (int i = 0; i < p->t.n; i++)
        square += stayed(p, i) ? pow(f(p->r, row_of(p, i), k) - mean, 2.0) : 0.0;
    return (struct estimate){mean, sqrt(square / (p->n - 1.0) / p->n)};
}

/* NaN where nothing crosses. */
static double mean_stay(double above_edge, double up)
{
    return up > 0.0 ? above_edge / up : (double)NAN;
}

/* Mean length of a stay above an edge: time above it over its up-crossings. The error of this ratio is of
 * first order. */
static struct estimate exceedance(const struct report *p, int edge)
{
    double up = estimate(p, row_crossing, edge).value,
           ratio = mean_stay(estimate(p, row_above, edge).value, up);
    double square = 0.0;
    for (int i = 0; i < p->t.n; i++)
        square +=
            stayed(p, i)
                ? pow(row_above(p->r, row_of(p, i), edge) - ratio * row_crossing(p->r, row_of(p, i), edge),
                      2.0)
                : 0.0;
    return (struct estimate){ratio, mean_stay(sqrt(square / (p->n - 1.0) / p->n), up)};
}

/* From the mean square about the middle of the range. */
static struct estimate variance(const struct report *p, double mean)
{
    struct estimate e = estimate(p, cell, RANDOM_SQUARE);
    double off = mean - 0.5 * (p->r->low + p->r->high);
    e.value -= off * off;
    return e;
}

/* ---- the closed form; NaN where there is none ---- */

static double law_density(const struct report *p, int bin)
{
    double a = random_edge(p->r, bin), b = random_edge(p->r, bin + 1);
    return p->law ? (random_law_above(p->law, a) - random_law_above(p->law, b)) / (b - a) : (double)NAN;
}

static double law_above(const struct report *p, int edge)
{
    return p->law ? random_law_above(p->law, random_edge(p->r, edge)) : (double)NAN;
}

static double law_crossing(const struct report *p, int edge)
{
    return p->law ? random_law_crossing(p->law, random_edge(p->r, edge)) : (double)NAN;
}

/* ---- the CSV ---- */

static void print_row(FILE *f, const char *kind, double at, struct estimate e, double closed)
{
    const double value[] = {at, e.value, e.error, closed};
    fputs(kind, f);
    for (int i = 0; i < 4; i++) {
        fputc(',', f);
        cell_put(f, value[i], i == 2 ? 3 : 6);
    }
    fputc('\n', f);
}

static void print(const struct report *p, FILE *f)
{
    const struct random_runs *r = p->r;
    struct estimate mean = estimate(p, cell, RANDOM_MEAN);
    double none = (double)NAN, moment[2] = {none, none};
    if (p->law)
        random_law_moments(p->law, &moment[0], &moment[1]);
    fprintf(f, "kind,at,value,standard_error,closed_form\n");
    print_row(f, "mean", none, mean, moment[0]);
    print_row(f, "variance", none, variance(p, mean.value), moment[1]);
    if (r->m.scene.model->n_contacts) {
        print_row(f, "out_of_contact", none, estimate(p, cell, RANDOM_OPEN),
                  p->law ? random_law_open(p->law) : none);
        print_row(f, "touchdown_rate", none, estimate(p, cell, RANDOM_TOUCHES),
                  p->law ? random_law_touches(p->law) : none);
    }
    for (int i = 0; i < r->n_bins; i++)
        print_row(f, "density", 0.5 * (random_edge(r, i) + random_edge(r, i + 1)),
                  estimate(p, row_density, i), law_density(p, i));
    for (int i = 0; i <= r->n_bins; i++)
        print_row(f, "above", random_edge(r, i), estimate(p, row_above, i), law_above(p, i));
    for (int i = 0; i <= r->n_bins; i++)
        print_row(f, "crossing_rate", random_edge(r, i), estimate(p, row_crossing, i), law_crossing(p, i));
    for (int i = 0; i <= r->n_bins; i++)
        print_row(f, "exceedance", random_edge(r, i), exceedance(p, i),
                  mean_stay(law_above(p, i), law_crossing(p, i)));
}

/* 0, or the exit status after a line. */
static int write_statistics(const struct report *p)
{
    const struct options *o = &p->r->m.o;
    const char *path = options_text(o, "statistics", 0);
    FILE *f = path ? files_compose(path) : NULL;
    if (!path)
        return 0;
    if (f)
        print(p, f);
    return !f || !files_finish(f, true)
               ? options_failure(o->usage,
                                 "--statistics %s: %s; the rows are complete, give the same command", path,
                                 strerror(errno))
               : 0;
}

/* ---- the summary ---- */

static void tell_estimate(FILE *f, const char *name, struct estimate e, const char *unit, double closed)
{
    fprintf(f, "%s: %.5g +- %.2g%s%s", name, e.value, e.error, *unit ? " " : "", unit);
    if (isfinite(closed))
        fprintf(f, "; closed form %.5g", closed);
    fputc('\n', f);
}

static void tell(void *context, const struct rows_table *t, FILE *f)
{
    const struct report *p = context;
    const struct random_runs *r = p->r;
    const struct signal *y = &r->m.scene.model->output_signal[(int)r->m.scene.observable];
    bool plain = scenes_dimensionless(&r->m.scene), bare = plain || !strcmp(y->unit, "1");
    struct estimate mean = estimate(p, cell, RANDOM_MEAN), v = variance(p, mean.value);
    double none = (double)NAN, moment[2] = {none, none};
    (void)t;
    v.value = sqrt(fmax(v.value, 0.0));
    v.error = v.value > 0.0 ? 0.5 * v.error / v.value : 0.0;
    if (p->law)
        random_law_moments(p->law, &moment[0], &moment[1]);
    fprintf(f, "%s, %s: %d realisations over %g%s each\n", r->m.name, y->name, p->n, r->over,
            plain ? "" : " s");
    tell_estimate(f, "mean", mean, bare ? "" : y->unit, moment[0]);
    tell_estimate(f, "standard deviation", v, bare ? "" : y->unit, sqrt(moment[1]));
    if (!r->m.scene.model->n_contacts)
        return;
    tell_estimate(f, "share of time out of contact", estimate(p, cell, RANDOM_OPEN), "",
                  p->law ? random_law_open(p->law) : none);
    tell_estimate(f, plain ? "touchdowns per time" : "touchdowns per second",
                  estimate(p, cell, RANDOM_TOUCHES), "", p->law ? random_law_touches(p->law) : none);
}

/* ---- the figure ---- */

struct curve {
    double x[RANDOM_BINS + 1], low[RANDOM_BINS + 1], high[RANDOM_BINS + 1], closed[RANDOM_BINS + 1];
    size_t n;
};

static double logarithm_of(double value)
{
    return value > 0.0 ? log10(value) : (double)NAN;
}

static void put_curve(struct figure *g, const struct curve *k, const char *title, bool closed)
{
    static const char realisations[] = "realisations, two standard errors", form[] = "closed form";
    figure_panel(g, title, "", 220.0);
    figure_put(g, &(struct figure_layer){.kind = FIGURE_BAND,
                                         .name = realisations,
                                         .legend = realisations,
                                         .colour = CHART_BLUE,
                                         .n = k->n,
                                         .x = k->x,
                                         .y = k->low,
                                         .z = k->high});
    if (closed)
        figure_put(g, &(struct figure_layer){.kind = FIGURE_LINE,
                                             .name = form,
                                             .legend = form,
                                             .colour = CHART_RED,
                                             .n = k->n,
                                             .x = k->x,
                                             .y = k->closed});
}

static void fill(struct curve *k, double x, struct estimate e, double closed)
{
    size_t i = k->n++;
    k->x[i] = x;
    k->low[i] = logarithm_of(e.value - errors * e.error);
    k->high[i] = logarithm_of(e.value + errors * e.error);
    k->closed[i] = logarithm_of(closed);
    if (isnan(k->low[i]))
        k->high[i] = (double)NAN;
}

static const char *draw(void *context, const struct rows_table *t, struct figure *g)
{
    static struct curve k;
    const struct report *p = context;
    const struct random_runs *r = p->r;
    const struct signal *y = &r->m.scene.model->output_signal[(int)r->m.scene.observable];
    bool plain = scenes_dimensionless(&r->m.scene);
    char text[FIGURE_TEXT];
    (void)t;
    snprintf(text, sizeof text, "%d realisations over %g%s each", p->n, r->over, plain ? "" : " s");
    figure_subtitle(g, text);
    figure_axis(g, &(struct figure_axis){y->name, plain ? "" : y->unit, r->low, r->high, false});
    k.n = 0;
    for (int i = 0; i < r->n_bins; i++)
        fill(&k, 0.5 * (random_edge(r, i) + random_edge(r, i + 1)), estimate(p, row_density, i),
             law_density(p, i));
    snprintf(text, sizeof text,
             plain || !strcmp(y->unit, "1") ? "log10 of density"
             : strpbrk(y->unit, "/ ")       ? "log10 of density (1/(%s))"
                                            : "log10 of density (1/%s)",
             y->unit);
    put_curve(g, &k, text, p->law != NULL);
    k.n = 0;
    for (int i = 0; i <= r->n_bins; i++)
        fill(&k, random_edge(r, i), estimate(p, row_crossing, i), law_crossing(p, i));
    put_curve(g, &k, plain ? "log10 of up-crossings per time" : "log10 of up-crossings per second",
              p->law != NULL);
    return NULL;
}

/* Without a whole run's rows there is nothing to sum up. */
static int sum_up(void *context, const struct rows_table *t)
{
    struct report *p = context;
    const struct random_runs *r = p->r;
    p->t = *t;
    for (int i = 0; i < t->n; i++)
        p->n += stayed(p, i);
    if (p->n < r->n)
        fprintf(stderr, "contactplant random: %d of %d realisations escaped and are left out\n", r->n - p->n,
                r->n);
    if (p->n < 2)
        return options_failure(
            r->m.o.usage, "fewer than two realisations stayed finite; give weaker noise or a shorter --over");
    return write_statistics(p);
}

int random_report(const struct random_runs *r)
{
    static const struct maps_finding found = {.read = sum_up, .tell = tell, .draw = draw};
    static struct random_law law;
    struct report p = {.r = r};
    const char *why = random_law_of(&r->m.scene, &law);
    p.law = why ? NULL : &law;
    if (why)
        fprintf(stderr, "contactplant random: no closed form: %s\n", why);
    return maps_conclude(&r->m, NULL, &found, &p);
}
