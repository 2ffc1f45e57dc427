/* basin_report.c - see basin_report.h. */
#include "host_sim/maps/basin/basin_report.h"

#include <math.h>
#include <stdlib.h>
#include "host_sim/maps/basin/basin_cells.h"
#include "host_sim/maps/basin/basin_rows.h"
#include "host_sim/out/plural.h"

static const enum chart_colour colour[] = {CHART_SKY,    CHART_RED,    CHART_BLUE, CHART_GREEN,
                                           CHART_ORANGE, CHART_PURPLE, CHART_GREY};
enum {
    IN_LEGEND = 4,  /* in one panel */
    POINTS = 12000, /* on the page at most, so that it has less than 1 MB */
    TEXT = 160
};

/* The classes of a figure: the most frequent attractors, then all others, then motions without an attractor.
 */
enum { OWN = 5, OTHERS = 5, NONE = 6, CLASSES = 7 };

struct report {
    const struct basin *b;
    const char *path; /* the rows are there */
    struct basin_clusters clusters;
    struct basin_row *row;
    int n;
};

/* "3", "chaos" or "none". */
static void period_text(const struct basin_motion *motion, char *text, size_t size)
{
    if (motion->period > 0)
        snprintf(text, size, "%d", motion->period);
    else
        snprintf(text, size, "%s", basin_clusters_kind(motion) == BASIN_CHAOTIC ? "chaos" : "none");
}

static int class_of(int attractor)
{
    return attractor < 0 ? NONE : attractor < OWN ? attractor : OTHERS;
}

static int count_of(const struct basin_clusters *c, int k)
{
    int n = 0;
    if (k == NONE)
        return c->escaped + c->trouble;
    for (int i = 0; i < c->n; i++)
        n += class_of(i) == k ? c->attractor[i].count : 0;
    return n;
}

static void class_name(const struct basin_clusters *c, int k, char *name, size_t size)
{
    double share = 100.0 * count_of(c, k) / c->total;
    if (k < OWN && c->attractor[k].motion.period > 0)
        snprintf(name, size, "%d: period %d, %.3g %%", k + 1, c->attractor[k].motion.period, share);
    else if (k < OWN)
        snprintf(name, size, "%d: %s, %.3g %%", k + 1,
                 basin_clusters_kind(&c->attractor[k].motion) == BASIN_CHAOTIC ? "chaotic" : "aperiodic",
                 share);
    else if (k == OTHERS)
        snprintf(name, size, "%d other%s, %.3g %%", c->n - OWN, plural(c->n - OWN), share);
    else
        snprintf(name, size, "escaped, %.3g %%", share);
}

/* ---- the page's words and table ---- */

static void put_words(struct html *h, const struct basin *b, const struct basin_clusters *c, int every)
{
    html_words(h, "%s by method %s, %d step%s a drive period: %d start%s lead%s to %d attractor%s.",
               b->plant.model->name, b->plant.series ? "batch_taylor" : b->plant.method->name, b->plant.steps,
               plural(b->plant.steps), c->total, plural(c->total), singular(c->total), c->n, plural(c->n));
    if (c->escaped + c->trouble)
        html_words(h, "%d motion%s escaped, and %d %s given up.", c->escaped, plural(c->escaped), c->trouble,
                   c->trouble == 1 ? "was" : "were");
    html_words(h, "The rows have the number %08x, which all that decides them gives.",
               (unsigned)jobs_run_number(b->m.identity));
    if (every > 1)
        html_words(h, "The charts show every %d. start; the table counts all.", every);
}

static void put_share(struct html *h, const char *name, int count, int total)
{
    double low, high;
    basin_clusters_wilson(count, total, &low, &high);
    html_row(h, false);
    html_cell(h, "%s", name);
    html_cell(h, "%d", count);
    html_cell(h, "%.3f", 100.0 * count / total);
    html_cell(h, "%.3f to %.3f", 100.0 * low, 100.0 * high);
}

static void put_table(struct html *h, const struct basin *b, const struct basin_clusters *c)
{
    const struct signal *s = &b->plant.model->output_signal[b->plant.observable];
    char text[TEXT];
    snprintf(text, sizeof text,
             "attractor,starts,share (%%),95 %% interval (%%),period (drive periods),growth a period,"
             "time without contact (%%),peak of %s (%s)",
             s->name, scenes_dimensionless(&b->m.scene) ? "1" : s->unit);
    html_table(h, "Attractors", text);
    for (int i = 0; i < c->n; i++) {
        const struct basin_attractor *a = &c->attractor[i];
        snprintf(text, sizeof text, "%d", i + 1);
        put_share(h, text, a->count, c->total);
        period_text(&a->motion, text, sizeof text);
        html_cell(h, "%s", text);
        html_cell(h, "%.4f", a->growth);
        html_cell(h, "%.4f", 100.0 * a->motion.open);
        html_cell(h, "%.9g", a->motion.peak * basin_peak_unit(b));
    }
    if (c->escaped)
        put_share(h, "escaped", c->escaped, c->total);
    if (c->trouble)
        put_share(h, "given up", c->trouble, c->total);
}

/* ---- planes ---- */

struct plane {
    struct figure *g;
    const struct basin *b;
    const struct basin_clusters *c;
    const struct basin_row *row;
    int n;
    struct basin_cells cells;
    double x[BASIN_LINES * BASIN_COLUMNS], y[BASIN_LINES * BASIN_COLUMNS], to[BASIN_LINES * BASIN_COLUMNS];
};

/* State i of the starts in class k. Returns how many they are. */
static size_t collect(const struct plane *p, int k, int i, double *to)
{
    size_t m = 0;
    for (int j = 0; j < p->n; j++)
        if (class_of(p->row[j].attractor) == k)
            to[m++] = p->row[j].x[i];
    return m;
}

static int class_at(const struct plane *p, int line, int column)
{
    int start = p->cells.start[line][column];
    return start < 0 ? CLASSES : class_of(p->row[start].attractor);
}

/* The cells of class k; neighbours side by side become one rectangle. They have the name of the class. */
static void put_cells(struct plane *p, int k, bool in_legend)
{
    const struct basin_cells *c = &p->cells;
    char name[FIGURE_TEXT];
    size_t n = 0;
    for (int i = 0; i < BASIN_LINES * BASIN_COLUMNS; i++) {
        int line = i / BASIN_COLUMNS, column = i % BASIN_COLUMNS;
        bool goes_on = n && column && class_at(p, line, column - 1) == k;
        if (class_at(p, line, column) != k)
            continue;
        n += !goes_on;
        if (!goes_on)
            p->x[n - 1] = c->x + column * c->width;
        p->to[n - 1] = c->x + (column + 1) * c->width;
        p->y[n - 1] = c->y + (line + 0.5) * c->height;
    }
    class_name(p->c, k, name, sizeof name);
    figure_put(p->g, &(struct figure_layer){.kind = FIGURE_CELLS,
                                            .name = name,
                                            .legend = in_legend ? name : NULL,
                                            .colour = colour[k],
                                            .half = 0.5 * c->height,
                                            .n = n,
                                            .x = p->x,
                                            .y = p->y,
                                            .z = p->to});
}

/* The starts of class k. Rare classes have larger dots, and lie on top. */
static void put_starts(const struct plane *p, int k, int i, double *x, double *y)
{
    int count = count_of(p->c, k);
    double common = fmin(2.2 * sqrt(1e4 / p->n), 4.0); /* px, so that dots stay apart */
    struct figure_layer dots = {.kind = FIGURE_POINTS, .colour = colour[k], .x = x, .y = y};
    dots.n = collect(p, k, i, x);
    collect(p, k, p->b->plant.model->n_states / 2 + i, y);
    dots.width = fmin(common * (count > p->n / 10 ? 1.0 : count > p->n / 100 ? 1.5 : 2.7), 6.0);
    figure_put(p->g, &dots);
}

/* Degree of freedom i: start velocity over start position. */
static void put_plane(struct plane *p, int i, double *x, double *y)
{
    int v = p->b->plant.model->n_states / 2 + i;
    char name[FIGURE_TEXT];
    snprintf(name, sizeof name, "start %s", scenes_state_name(&p->b->m.scene, i));
    figure_axis(p->g, &(struct figure_axis){.name = name, .unit = basin_unit(p->b, i)});
    snprintf(name, sizeof name, "start %s", scenes_state_name(&p->b->m.scene, v));
    figure_panel(p->g, name, basin_unit(p->b, v), 330.0);
    for (int j = 0; j < p->n; j++)
        x[j] = p->row[j].x[i], y[j] = p->row[j].x[v];
    basin_cells_make(&p->cells, x, y, p->n);
    for (int k = 0; k < CLASSES; k++)
        if (count_of(p->c, k))
            put_cells(p, k, k / IN_LEGEND == i);
    for (int k = 0; k < CLASSES; k++)
        if (count_of(p->c, k))
            put_starts(p, k, i, x, y);
}

/* Start positions and velocities, coloured by attractor, and the attractors as a table. NULL, or a reason. */
static const char *draw(void *context, const struct rows_table *t, struct figure *g)
{
    const struct report *r = context;
    int n = t->n, planes = r->b->plant.model->n_states / 2, every = (n * planes + POINTS - 1) / POINTS;
    char text[FIGURE_TEXT];
    double *x = malloc(2 * (size_t)n * sizeof *x);
    struct plane *p = malloc(sizeof *p);
    if (!x || !p) {
        free(x);
        free(p);
        return "no memory";
    }
    *p = (struct plane){.g = g, .b = r->b, .c = &r->clusters, .row = r->row, .n = n};
    snprintf(text, sizeof text,
             "%d starts in %d dimensions, coloured by the attractor they reach (%d in all); "
             "cells have the colour of the nearest start",
             n, 2 * planes, r->clusters.n);
    figure_subtitle(g, text);
    if (figure_page(g)) {
        put_words(figure_page(g), r->b, &r->clusters, every);
        put_table(figure_page(g), r->b, &r->clusters);
    }
    g->every = (size_t)every;
    for (int i = 0; i < planes; i++)
        put_plane(p, i, x, x + n);
    free(x);
    free(p);
    return NULL;
}

/* ---- rows, and the summary ---- */

/* Sorts each start to its attractor; every start must be there once, and in order. */
static int sort_rows(struct report *r)
{
    const struct usage *u = r->b->m.o.usage;
    for (int i = 0; i < r->n; i++) {
        if (r->row[i].start != i)
            return options_misuse(u, "%s:%d: not the next start; join all shares by contactplant merge",
                                  r->path, i + 2);
        r->row[i].attractor = basin_clusters_add(&r->clusters, &r->row[i].motion);
        if (r->row[i].attractor == -2)
            return options_misuse(
                u, "%s:%d: more than 1024 attractors: these motions have not settled; give more --periods",
                r->path, i + 2);
    }
    return 0;
}

static void print_images(FILE *f, const struct model *m, const struct basin_attractor *a, int i)
{
    static const char *const name[IMAGES] = {"", "mirrored", "ends exchanged", "both"};
    const char *between = "  ";
    for (int k = IMAGE_MIRROR; k < (m->n_states > 2 ? IMAGES : IMAGE_ENDS); k++) {
        if (a->image[k] == i)
            continue;
        if (a->image[k] < 0)
            fprintf(f, "%s%s: not seen", between, name[k]);
        else
            fprintf(f, "%s%s: %d", between, name[k], a->image[k] + 1);
        between = ", ";
    }
    fputs(between[0] == ',' ? "\n" : "  symmetric\n", f);
}

static void print_share(FILE *f, const char *name, int count, int total)
{
    double low, high;
    basin_clusters_wilson(count, total, &low, &high);
    fprintf(f, "%-9s %7d %8.3f %% %8.3f .. %-7.3f", name, count, 100.0 * count / total, 100.0 * low,
            100.0 * high);
}

static void print_attractor(FILE *f, const struct report *r, int i)
{
    const struct basin_attractor *a = &r->clusters.attractor[i];
    char name[16], period[16];
    snprintf(name, sizeof name, "%d", i + 1);
    period_text(&a->motion, period, sizeof period);
    print_share(f, name, a->count, r->clusters.total);
    fprintf(f, " %6s %8.4f %8.4f  %-12.6g", period, a->growth, a->motion.open,
            a->motion.peak * basin_peak_unit(r->b));
    if (r->b->plant.model->n_contacts > 1) /* one contact has one side */
        print_images(f, r->b->plant.model, a, i);
    else
        fputc('\n', f);
}

static void tell(void *context, const struct rows_table *t, FILE *f)
{
    const struct report *r = context;
    const struct basin_clusters *c = &r->clusters;
    const struct signal *s = &r->b->plant.model->output_signal[r->b->plant.observable];
    (void)t;
    fprintf(f,
            "%d start%s, %d attractor%s; period: in forcing periods; growth: of a small distance in one, "
            "logarithm;\n"
            "open: share of time without contact; peak: of %s, %s\n"
            "attractor  starts    share    95 %% interval     period   growth     open  peak\n",
            c->total, plural(c->total), c->n, plural(c->n), s->name,
            scenes_dimensionless(&r->b->m.scene) ? "1" : s->unit);
    for (int i = 0; i < c->n; i++)
        print_attractor(f, r, i);
    if (c->escaped > 0) {
        print_share(f, "escaped", c->escaped, c->total);
        fputc('\n', f);
    }
    if (c->trouble > 0) {
        print_share(f, "trouble", c->trouble, c->total);
        fputc('\n', f);
    }
}

/* The attractors in the order of their frequency. */
static int sum_up(void *context, const struct rows_table *t)
{
    static int order[BASIN_ATTRACTORS];
    struct report *r = context;
    r->row = (struct basin_row *)(void *)t->row;
    r->n = t->n;
    int status = sort_rows(r);
    if (status)
        return status;
    basin_clusters_finish(&r->clusters, order);
    for (int i = 0; i < r->n; i++)
        r->row[i].attractor = r->row[i].attractor < 0 ? -1 : order[r->row[i].attractor];
    return 0;
}

int basin_report(const struct basin *b, const char *path)
{
    static const struct maps_finding found = {.read = sum_up, .tell = tell, .draw = draw, .is_table = true};
    static struct report r;
    const char *out = options_text(&b->m.o, "out", 0);
    r = (struct report){.b = b, .path = path ? path : out ? out : "standard output"};
    basin_clusters_start(&r.clusters, b->plant.model);
    return maps_conclude(&b->m, path, &found, &r);
}
