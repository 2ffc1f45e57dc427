/* stability_report.c - see stability_report.h. */
#include "host_sim/maps/stability/stability_report.h"

#include <math.h>
#include <stdlib.h>
#include "host_sim/cli/unit.h"

enum { TONGUES_TOLD = 8, KINDS = 4 };

/* The kinds of a cell. Floquet: 0 unstable in both, 1 in the plant only, 2 in the method only. Energy: 0
 * lost, 1 made, 2 more than doubled, 3 not finite. Switches: 0 missed, 1 made up. */
enum { NO_KIND = -1 };

static int floquet_kind(const double *c)
{
    bool plant = !(c[FLOQUET_PLANT] <= STABILITY_UNIT), method = !(c[FLOQUET_METHOD] <= STABILITY_UNIT);
    return plant ? !method : method ? 2 : NO_KIND;
}

static int energy_kind(const double *c)
{
    double ratio = c[CONTACT_ENERGY];
    if (ratio < 1.0 - STABILITY_ENERGY)
        return 0;
    return !isfinite(ratio) ? 3 : ratio > 2.0 ? 2 : ratio > 1.0 + STABILITY_ENERGY ? 1 : NO_KIND;
}

static int switches_kind(const double *c)
{
    double more = c[CONTACT_OF_METHOD] - c[CONTACT_SWITCHES];
    return more < 0.0 ? 0 : more > 0.0 ? 1 : NO_KIND;
}

static int count(const struct rows_table *t, int (*kind_of)(const double *), int kind)
{
    int n = 0;
    for (int i = 0; i < t->n; i++)
        n += kind_of(rows_row(t, i)) == kind;
    return n;
}

static void tell_count(FILE *f, const char *what, int n, int all)
{
    fprintf(f, "%s: %d of %d cells, %.3g %%\n", what, n, all, 100.0 * n / all);
}

static bool plant_is_unstable(const double *cell)
{
    int kind = floquet_kind(cell);
    return kind == 0 || kind == 1;
}

/* The tongues of the plant where they are widest, in the last row. */
static void tell_tongues(const struct stability *s, const struct rows_table *t, FILE *f)
{
    char a[UNIT_TEXT], b[UNIT_TEXT];
    int told = 0, first = t->n - s->x.values.n;
    for (int i = first; i < t->n; i++) {
        const double *cell = rows_row(t, i), *before = i > first ? rows_row(t, i - 1) : NULL;
        int end = i;
        if (!plant_is_unstable(cell) || (before && plant_is_unstable(before)))
            continue;
        while (end + 1 < t->n && plant_is_unstable(rows_row(t, end + 1)))
            end++;
        if (told++ < TONGUES_TOLD)
            fprintf(f, "  tongue at the upper edge: %s from %s to %s\n", s->x.words,
                    maps_in_words(cell[1], s->x.unit, a),
                    maps_in_words(((const double *)rows_row(t, end))[1], s->x.unit, b));
    }
    if (told > TONGUES_TOLD)
        fprintf(f, "  and %d more\n", told - TONGUES_TOLD);
}

static void tell(void *context, const struct rows_table *t, FILE *f)
{
    const struct stability *s = context;
    char a[UNIT_TEXT], b[UNIT_TEXT];
    fprintf(f, "%s by %s\n", s->m.name, s->m.method->name);
    fprintf(f, "across: %s from %s to %s\n", s->x.words, maps_in_words(s->x.values.from, s->x.unit, a),
            maps_in_words(s->x.values.to, s->x.unit, b));
    fprintf(f, "upwards: %s from %s to %s\n", s->y.words, maps_in_words(s->y.values.from, s->y.unit, a),
            maps_in_words(s->y.values.to, s->y.unit, b));
    if (s->map == STABILITY_CONTACT) {
        tell_count(f, "energy lost, 5 % and more", count(t, energy_kind, 0), t->n);
        tell_count(f, "energy made, 5 % and more", count(t, energy_kind, 1) + count(t, energy_kind, 2), t->n);
        tell_count(f, "motion not finite", count(t, energy_kind, 3), t->n);
        tell_count(f, "contact switches missed", count(t, switches_kind, 0), t->n);
        tell_count(f, "contact switches that are none", count(t, switches_kind, 1), t->n);
        return;
    }
    tell_count(f, "unstable in plant and method", count(t, floquet_kind, 0), t->n);
    tell_count(f, "unstable in the plant only", count(t, floquet_kind, 1), t->n);
    tell_count(f, "unstable in the method only", count(t, floquet_kind, 2), t->n);
    tell_tongues(s, t, f);
}

/* ---- picture and page: the cells of a kind have its colour ---- */

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
                                           floquet_kind,
                                           {{CHART_GREY, "unstable in plant and method"},
                                            {CHART_BLUE, "unstable in the plant only"},
                                            {CHART_RED, "unstable in the method only"}}};
static const struct panel energy_panel = {"energy",
                                          "white: energy within 5 %, no switch more or less",
                                          240.0,
                                          energy_kind,
                                          {{CHART_BLUE, "energy lost, 5 % and more"},
                                           {CHART_ORANGE, "made, 5 % and more"},
                                           {CHART_RED, "more than doubled"},
                                           {CHART_GREY, "not finite"}}};
static const struct panel switches_panel = {
    "switches",
    NULL,
    240.0,
    switches_kind,
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

static const char *draw(void *context, const struct rows_table *t, struct figure *g)
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

const struct maps_finding stability_finding = {.tell = tell, .draw = draw};
