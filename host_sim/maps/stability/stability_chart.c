/* stability_chart.c - the picture of a stability map: the cells of a kind have its colour. */
#include "host_sim/maps/stability/stability.h"

#include <math.h>
#include <stdlib.h>
#include "host_sim/out/utf8.h"

enum { LABEL = 160, KINDS = 4 };

/* One panel: kinds of cells, and which of them a cell is. */
struct panel {
    const char *what;
    double height; /* px */
    int (*kind)(const double *cell);
    struct {
        enum chart_colour colour;
        const char *name; /* NULL behind the last */
    } legend[KINDS];
};

struct picture {
    const struct stability *s;
    struct rows_table t;
    struct chart c;
    double *from, *to, *y; /* [t.n] cells of one kind */
};

static const struct panel floquet_panel = {
    "unstable",
    320.0,
    stability_floquet_kind,
    {{CHART_GREY, "in both"}, {CHART_BLUE, "in the plant only"}, {CHART_RED, "in the method only"}}};
static const struct panel energy_panel = {"energy",
                                          240.0,
                                          stability_energy_kind,
                                          {{CHART_BLUE, "energy lost, 5 % and more"},
                                           {CHART_ORANGE, "made, 5 % and more"},
                                           {CHART_RED, "more than doubled"},
                                           {CHART_GREY, "not finite"}}};
static const struct panel switches_panel = {
    "switches",
    240.0,
    stability_switches_kind,
    {{CHART_BLUE, "contact switches missed"}, {CHART_RED, "switches that are none"}}};

static double on_axis(const struct scene_range *r, double value)
{
    return r->values.logarithmic ? log10(value) : value;
}

static double half_cell(const struct scene_range *r)
{
    return 0.5 * (on_axis(r, r->values.to) - on_axis(r, r->values.from)) / (r->values.n - 1);
}

/* Cells of kind k; neighbours side by side become one rectangle. */
static void draw_kind(struct picture *p, const struct panel *panel, int k)
{
    const struct stability *s = p->s;
    double dx = half_cell(&s->x);
    size_t n = 0;
    for (int i = 0; i < p->t.n; i++) {
        const double *cell = rows_row(&p->t, i);
        double x = on_axis(&s->x, cell[1]), y = on_axis(&s->y, cell[0]);
        bool goes_on = n && i % s->x.values.n && panel->kind(rows_row(&p->t, i - 1)) == k;
        if (panel->kind(cell) != k)
            continue;
        n += !goes_on;
        if (!goes_on)
            p->from[n - 1] = x - dx;
        p->to[n - 1] = x + dx;
        p->y[n - 1] = y;
    }
    if (n) /* the legend names the colours that are there */
        chart_cells(&p->c, p->from, p->to, p->y, n, half_cell(&s->y), panel->legend[k].colour,
                    panel->legend[k].name);
}

static void draw_panel(struct picture *p, const struct panel *panel)
{
    const struct stability *s = p->s;
    double dy = half_cell(&s->y);
    char label[LABEL], words[LABEL];
    scene_range_label(&s->y, words, sizeof words);
    snprintf(label, sizeof label, "%.40s: %.100s, upwards", panel->what, words);
    chart_panel(&p->c, label, panel->height, on_axis(&s->y, s->y.values.from) - dy,
                on_axis(&s->y, s->y.values.to) + dy);
    for (int k = 0; k < KINDS && panel->legend[k].name; k++)
        draw_kind(p, panel, k);
}

static void draw(struct picture *p)
{
    const struct stability *s = p->s;
    char title[LABEL], text[LABEL];
    double dx = half_cell(&s->x);
    snprintf(title, sizeof title, "contactplant stability %.*s", utf8_fits(s->m.name, 100), s->m.name);
    snprintf(text, sizeof text, "%s, %d x %d cells", s->m.method->name, s->x.values.n, s->y.values.n);
    chart_begin(&p->c, title, text);
    chart_x_range(&p->c, on_axis(&s->x, s->x.values.from) - dx, on_axis(&s->x, s->x.values.to) + dx);
    if (s->map == STABILITY_FLOQUET) {
        draw_panel(p, &floquet_panel);
    } else {
        draw_panel(p, &energy_panel);
        draw_panel(p, &switches_panel);
    }
    scene_range_label(&s->x, text, sizeof text);
    chart_x_axis(&p->c, text);
}

int stability_chart(const struct stability *s)
{
    struct picture p = {.s = s};
    int status = rows_load(&s->m.o, &s->m.rows, options_text(&s->m.o, "out", 0), &p.t);
    p.from = calloc((size_t)p.t.n + 1, 3 * sizeof *p.from);
    if (!status && !p.from)
        status = options_failure(s->m.o.usage, "out of memory");
    if (!status) {
        p.to = p.from + p.t.n;
        p.y = p.to + p.t.n;
        draw(&p);
        status = maps_finish_chart(&s->m, &p.c);
    }
    free(p.from);
    rows_free(&p.t);
    return status;
}
