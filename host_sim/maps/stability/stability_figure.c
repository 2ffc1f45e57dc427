/* stability_figure.c - see stability_figure.h. */
#include "host_sim/maps/stability/stability_figure.h"

#include <math.h>
#include <stdlib.h>

enum { KINDS = 4 };

/* One panel: kinds of cells, and which of them a cell is. */
struct panel {
    const char *what, *white; /* white: the meaning of cells without a kind */
    double height;            /* px */
    int (*kind)(const double *cell);
    struct {
        enum chart_colour colour;
        const char *name; /* NULL behind the last */
    } legend[KINDS];
};

struct drawing {
    const struct stability *s;
    const struct rows_table *t;
    struct figure *g;
    double *from, *to, *y; /* [t->n] cells of one kind */
};

static const struct panel floquet_panel = {"Floquet",
                                           "white: stable in plant and method",
                                           320.0,
                                           stability_floquet_kind,
                                           {{CHART_GREY, "unstable in plant and method"},
                                            {CHART_BLUE, "unstable in the plant only"},
                                            {CHART_RED, "unstable in the method only"}}};
static const struct panel energy_panel = {"energy",
                                          "white: energy within 5 %, no switch more or less",
                                          240.0,
                                          stability_energy_kind,
                                          {{CHART_BLUE, "energy lost, 5 % and more"},
                                           {CHART_ORANGE, "made, 5 % and more"},
                                           {CHART_RED, "more than doubled"},
                                           {CHART_GREY, "not finite"}}};
static const struct panel switches_panel = {
    "switches",
    NULL,
    240.0,
    stability_switches_kind,
    {{CHART_BLUE, "contact switches missed"}, {CHART_RED, "contact switches that are none"}}};

static double on_axis(const struct scene_range *r, double value)
{
    return r->values.logarithmic ? log10(value) : value;
}

static double half_cell(const struct scene_range *r)
{
    return 0.5 * (on_axis(r, r->values.to) - on_axis(r, r->values.from)) / (r->values.n - 1);
}

/* The value half a cell to this side of one. */
static double edge(const struct scene_range *r, double value, double side)
{
    double at = on_axis(r, value) + side * half_cell(r);
    return r->values.logarithmic ? pow(10.0, at) : at;
}

/* Cells of kind k; neighbours side by side become one rectangle. */
static void put_kind(const struct drawing *d, const struct panel *panel, int k)
{
    const struct stability *s = d->s;
    size_t n = 0;
    for (int i = 0; i < d->t->n; i++) {
        const double *cell = rows_row(d->t, i);
        bool goes_on = n && i % s->x.values.n && panel->kind(rows_row(d->t, i - 1)) == k;
        if (panel->kind(cell) != k)
            continue;
        n += !goes_on;
        if (!goes_on)
            d->from[n - 1] = edge(&s->x, cell[1], -1.0);
        d->to[n - 1] = edge(&s->x, cell[1], 1.0);
        d->y[n - 1] = on_axis(&s->y, cell[0]);
    }
    if (n) /* the legend names the colours that are there */
        figure_put(d->g, &(struct figure_layer){.kind = FIGURE_CELLS,
                                                .name = panel->legend[k].name,
                                                .legend = panel->legend[k].name,
                                                .colour = panel->legend[k].colour,
                                                .half = half_cell(&s->y),
                                                .n = n,
                                                .x = d->from,
                                                .y = d->y,
                                                .z = d->to});
}

static void put_panel(const struct drawing *d, const struct panel *panel)
{
    const struct scene_range *y = &d->s->y;
    double dy = half_cell(y);
    char title[FIGURE_TEXT], words[FIGURE_TEXT];
    scene_range_label(y, words, sizeof words);
    snprintf(title, sizeof title, "%.40s: %.100s", panel->what, words);
    figure_panel(d->g, title, "", panel->height);
    figure_range(d->g, on_axis(y, y->values.from) - dy, on_axis(y, y->values.to) + dy);
    for (int k = 0; k < KINDS && panel->legend[k].name; k++)
        put_kind(d, panel, k);
}

const char *stability_draw(void *context, const struct rows_table *t, struct figure *g)
{
    const struct stability *s = context;
    const struct scene_range *x = &s->x;
    struct drawing d = {.s = s, .t = t, .g = g};
    char text[FIGURE_TEXT];
    d.from = calloc((size_t)t->n + 1, 3 * sizeof *d.from);
    if (!d.from)
        return "no memory";
    d.to = d.from + t->n;
    d.y = d.to + t->n;
    snprintf(text, sizeof text, "%s, %d x %d cells; %s", s->m.method->name, x->values.n, s->y.values.n,
             s->map == STABILITY_FLOQUET ? floquet_panel.white : energy_panel.white);
    figure_subtitle(g, text);
    figure_axis(g, &(struct figure_axis){x->words, x->unit, edge(x, x->values.from, -1.0),
                                         edge(x, x->values.to, 1.0), x->values.logarithmic});
    if (s->map == STABILITY_FLOQUET) {
        put_panel(&d, &floquet_panel);
    } else {
        put_panel(&d, &energy_panel);
        put_panel(&d, &switches_panel);
    }
    free(d.from);
    return NULL;
}
