/* stability_chart.c - the picture of a stability map: cells of one kind in one colour. */
#include "host_sim/maps/stability/stability.h"

#include <math.h>
#include <stdlib.h>

enum { LABEL = 160, KINDS = 4 };

struct kind {
    enum chart_colour colour;
    const char *name;
    bool (*is)(const double *cell);
};

struct picture {
    const struct stability *s;
    struct rows_table t;
    struct chart c;
    double *from, *to, *y; /* [t.n] of the cells under way */
};

static bool unstable(double multiplier)
{
    return !(multiplier <= STABILITY_UNIT);
}

static bool both(const double *c)
{
    return unstable(c[FLOQUET_PLANT]) && unstable(c[FLOQUET_METHOD]);
}

static bool only_plant(const double *c)
{
    return unstable(c[FLOQUET_PLANT]) && !unstable(c[FLOQUET_METHOD]);
}

static bool only_method(const double *c)
{
    return !unstable(c[FLOQUET_PLANT]) && unstable(c[FLOQUET_METHOD]);
}

static const struct kind floquet[KINDS] = {{CHART_GREY, "in both", both},
                                           {CHART_BLUE, "in the plant only", only_plant},
                                           {CHART_RED, "in the method only", only_method}};

static bool lost(const double *c)
{
    return c[CONTACT_ENERGY] < 1.0 - STABILITY_ENERGY;
}

static bool made(const double *c)
{
    return c[CONTACT_ENERGY] > 1.0 + STABILITY_ENERGY && c[CONTACT_ENERGY] <= 2.0;
}

static bool blown_up(const double *c)
{
    return c[CONTACT_ENERGY] > 2.0 && isfinite(c[CONTACT_ENERGY]);
}

static bool escaped(const double *c)
{
    return !isfinite(c[CONTACT_ENERGY]);
}

static const struct kind energy[KINDS] = {{CHART_BLUE, "energy lost, 5 % and more", lost},
                                          {CHART_ORANGE, "made, 5 % and more", made},
                                          {CHART_RED, "more than doubled", blown_up},
                                          {CHART_GREY, "not finite", escaped}};

static bool missed(const double *c)
{
    return c[CONTACT_OF_METHOD] < c[CONTACT_SWITCHES];
}

static bool added(const double *c)
{
    return c[CONTACT_OF_METHOD] > c[CONTACT_SWITCHES];
}

static const struct kind switches[KINDS] = {{CHART_BLUE, "contact switches missed", missed},
                                            {CHART_RED, "switches that are none", added}};

/* ---- cells ---- */

static double place(const struct scene_range *r, double value)
{
    return r->logarithmic ? log10(value) : value;
}

static double half_cell(const struct scene_range *r)
{
    return 0.5 * (place(r, r->to) - place(r, r->from)) / (r->n - 1);
}

static const double *cell_of(const struct picture *p, int i)
{
    return (const double *)(const void *)&p->t.row[(size_t)i * p->s->m.rows.size];
}

/* Cells of this kind, those side by side in one. */
static void draw_kind(struct picture *p, const struct kind *k)
{
    const struct stability *s = p->s;
    double dx = half_cell(&s->x);
    size_t n = 0;
    for (int i = 0; i < p->t.n; i++) {
        const double *cell = cell_of(p, i);
        double x = place(&s->x, cell[1]), y = place(&s->y, cell[0]);
        bool goes_on = n && i % s->x.n && k->is(cell_of(p, i - 1));
        if (!k->is(cell))
            continue;
        n += !goes_on;
        if (!goes_on)
            p->from[n - 1] = x - dx;
        p->to[n - 1] = x + dx;
        p->y[n - 1] = y;
    }
    chart_cells(&p->c, p->from, p->to, p->y, n, half_cell(&s->y), k->colour, k->name);
}

static void draw_panel(struct picture *p, const struct kind *kind, const char *what, double height)
{
    const struct stability *s = p->s;
    double dy = half_cell(&s->y);
    char label[LABEL];
    snprintf(label, sizeof label, "%s: %s%s", what, s->y.logarithmic ? "log10 of " : "", s->y.column);
    chart_panel(&p->c, label, height, place(&s->y, s->y.from) - dy, place(&s->y, s->y.to) + dy);
    for (int k = 0; k < KINDS && kind[k].name; k++)
        draw_kind(p, &kind[k]);
}

static void draw(struct picture *p)
{
    const struct stability *s = p->s;
    char title[LABEL], text[LABEL];
    double dx = half_cell(&s->x);
    snprintf(title, sizeof title, "contactplant stability %.100s", s->m.name);
    snprintf(text, sizeof text, "%s, %d x %d cells", s->m.method->name, s->x.n, s->y.n);
    chart_begin(&p->c, title, text);
    chart_x_range(&p->c, place(&s->x, s->x.from) - dx, place(&s->x, s->x.to) + dx);
    if (s->map == STABILITY_FLOQUET) {
        draw_panel(p, floquet, "unstable", 320.0);
    } else {
        draw_panel(p, energy, "energy", 240.0);
        draw_panel(p, switches, "switches", 240.0);
    }
    snprintf(text, sizeof text, "%s%s", s->x.logarithmic ? "log10 of " : "", s->x.column);
    chart_x_axis(&p->c, text);
}

int stability_chart(const struct stability *s)
{
    struct picture p = {.s = s};
    int status = rows_load(&s->m.o, &s->m.rows, options_text(&s->m.o, "out", 0), &p.t);
    p.from = calloc((size_t)p.t.n + 1, 3 * sizeof *p.from);
    if (!status && !p.from)
        status = options_failure(s->m.o.usage, "no memory");
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
