/* sweep_chart.c - the picture of a sweep from its rows: amplitudes, phase, time out of contact and peak
 * force.
 *
 * Up and down have a colour each, or each value of the family has one. Jumps are dashed. */
#include "host_sim/maps/sweep/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/out/utf8.h"

enum { COLOURS = 6, LEGENDS = 9 };

#define AT(member) offsetof(struct sweep_result, member)

struct picture {
    const struct sweep *s;
    const struct sweep_result *row;
    struct rows_table t;
    struct chart c;
    int n_chains;
    double *y;     /* [t.n] values of a panel */
    double *x, *z; /* [t.n] points of a line */
};

static double on_axis(const struct picture *p, double value)
{
    return p->s->range.values.logarithmic ? log10(value) : value;
}

/* The name of a chain in the legend of the first panel, or NULL. */
static const char *legend_of(const struct picture *p, int chain, char text[SWEEP_LABEL])
{
    const struct scene_range *f = &p->s->family;
    if (p->c.n_panels > 1)
        return NULL;
    if (!f->values.n)
        return chain == 0 ? "up" : "down";
    snprintf(text, SWEEP_LABEL, "%.4g", range_value(&f->values, chain / 2));
    bool shown = f->values.n <= LEGENDS || chain == 0 || chain == 2 * f->values.n - 2;
    return chain % 2 == 0 && shown ? text : NULL;
}

static enum chart_colour colour_of(const struct picture *p, int chain)
{
    if (!p->s->family.values.n)
        return chain == 0 ? CHART_BLUE : CHART_RED;
    return (enum chart_colour)(chain / 2 % COLOURS);
}

/* A dashed line at each jump; not for a family, whose curves show their own. */
static void mark_jumps(struct picture *p)
{
    for (int i = 0; i < p->t.n && !p->s->family.values.n; i++) {
        char label[SWEEP_LABEL];
        snprintf(label, sizeof label, "%.4g", p->row[i].value);
        if (p->row[i].kind == SWEEP_TO)
            chart_marker(&p->c, on_axis(p, p->row[i].value), p->c.n_panels > 1 ? NULL : label,
                         colour_of(p, sweep_chain_of(&p->t, p->row, i)));
    }
}

/* A panel of the values at this offset of the rows. name: NULL for the column's meaning. */
static void draw_panel(struct picture *p, size_t offset, const char *name, double height)
{
    const struct rows_column *column = rows_find(&p->s->m.rows, offset);
    double min = (double)INFINITY, max = -(double)INFINITY;
    char label[SWEEP_LABEL], legend[SWEEP_LABEL];
    for (int i = 0; i < p->t.n; i++)
        memcpy(&p->y[i], (const char *)&p->row[i] + offset, sizeof p->y[i]);
    chart_range_add(&min, &max, p->y, (size_t)p->t.n);
    double factor = chart_label(label, sizeof label, name ? name : column->meaning, column->unit,
                                fmax(fabs(min), fabs(max)));
    min *= factor, max *= factor;
    chart_range_finish(&min, &max);
    chart_panel(&p->c, label, height, min, max);
    for (int chain = 0; chain < p->n_chains; chain++) {
        size_t n = 0;
        for (int i = 0; i < p->t.n; i++) {
            if (sweep_chain_of(&p->t, p->row, i) != chain)
                continue;
            p->x[n] = on_axis(p, p->row[i].value);
            p->z[n++] = factor * p->y[i];
        }
        chart_line(&p->c, p->x, p->z, n, colour_of(p, chain), legend_of(p, chain, legend));
    }
    mark_jumps(p);
}

static void draw_harmonics(struct picture *p)
{
    for (int i = 0; i < p->s->n_harmonics; i++) {
        char name[SWEEP_LABEL];
        sweep_name_harmonic(p->s, i, name);
        draw_panel(p, AT(measured.amplitude) + (size_t)i * sizeof(double), name, i ? 80.0 : 170.0);
        if (i == 0)
            draw_panel(p, AT(measured.phase), "its phase to the drive", 80.0);
    }
}

static void draw(struct picture *p)
{
    const struct sweep *s = p->s;
    const struct model *m = s->m.scene.model;
    char title[SWEEP_LABEL], text[SWEEP_LABEL];
    snprintf(title, sizeof title, "contactplant sweep %.*s", utf8_fits(s->m.name, 100), s->m.name);
    char settled[SWEEP_LABEL];
    sweep_say_settled(s, settled);
    int n =
        snprintf(text, sizeof text, "%d points up and down, each settled %s; ", s->range.values.n, settled);
    snprintf(text + n, sizeof text - (size_t)n, s->family.values.n ? "a colour for each %s" : "dashed: jumps",
             s->family.words);
    chart_begin(&p->c, title, text);
    chart_x_range(&p->c, on_axis(p, s->range.values.from), on_axis(p, s->range.values.to));
    draw_harmonics(p);
    if (m->n_contacts > 0) {
        draw_panel(p, AT(measured.out_of_contact), NULL, 80.0);
        draw_panel(p, AT(measured.peak_force), NULL, 80.0);
    }
    scene_range_label(&s->range, text, sizeof text);
    chart_x_axis(&p->c, text);
}

int sweep_chart(const struct sweep *s)
{
    struct picture p = {.s = s, .n_chains = s->family.values.n ? 2 * s->family.values.n : 2};
    int status = rows_load(&s->m.o, &s->m.rows, options_text(&s->m.o, "out", 0), &p.t);
    p.row = (const void *)p.t.row;
    p.x = calloc((size_t)p.t.n + 1, 3 * sizeof *p.x);
    if (!status && !p.x)
        status = options_failure(s->m.o.usage, "out of memory");
    if (!status) {
        p.y = p.x + p.t.n;
        p.z = p.y + p.t.n;
        draw(&p);
        status = maps_finish_chart(&s->m, &p.c);
    }
    free(p.x);
    rows_free(&p.t);
    return status;
}
