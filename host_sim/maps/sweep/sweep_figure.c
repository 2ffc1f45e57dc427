/* sweep_figure.c - see sweep_figure.h. */
#include "host_sim/maps/sweep/sweep_figure.h"
#include "host_sim/cli/unit.h"
#include "host_sim/maps/sweep/sweep_chain.h"
#include "host_sim/maps/sweep/sweep_tell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLOURS = 6 /* in words below, too */, JUMPS_DRAWN = 6, POINTS_AROUND = 6 };

static const char *const unsettled = "did not settle";

#define AT(member) offsetof(struct sweep_result, member)

struct drawing {
    const struct sweep *s;
    const struct sweep_result *row;
    const struct rows_table *t;
    struct figure *g;
    double *x, *y; /* [t->n] points of a line */
};

static double value_at(const struct drawing *d, int i, size_t offset)
{
    double value;
    memcpy(&value, (const char *)&d->row[i] + offset, sizeof value);
    return value;
}

/* The name of a chain in the picture's legend, or NULL. The first one of a family tells which number has
 * these values. Where values share a colour, the first and the last one have a name. */
static const char *legend_of(const struct sweep *s, int chain, char text[SWEEP_LABEL])
{
    const struct scene_range *f = &s->family;
    if (!f->values.n)
        return chain == 0 ? "up" : "down";
    char value[UNIT_TEXT];
    snprintf(value, sizeof value, "%.4g", range_value(&f->values, chain / 2));
    maps_in_words(strtod(value, NULL), f->unit, value);
    snprintf(text, SWEEP_LABEL, "%s%s%s", chain ? "" : f->words, chain ? "" : " ", value);
    bool shown = f->values.n <= COLOURS || chain == 0 || chain == 2 * f->values.n - 2;
    return chain % 2 == 0 && shown ? text : NULL;
}

static enum chart_colour colour_of(const struct sweep *s, int chain)
{
    if (!s->family.values.n)
        return chain == 0 ? CHART_BLUE : CHART_RED;
    return (enum chart_colour)(chain / 2 % COLOURS);
}

/* The rows of a chain from index `from` to before `to`. The line has a gap where points did not settle. */
static void put_chain(const struct drawing *d, int chain, size_t offset, int from, int to, bool named)
{
    char name[SWEEP_LABEL], legend[SWEEP_LABEL];
    bool any = false;
    struct figure_layer line = {.kind = FIGURE_LINE,
                                .name = sweep_chain_name(d->s, chain, name),
                                .legend = named ? legend_of(d->s, chain, legend) : NULL,
                                .colour = colour_of(d->s, chain),
                                .dots = true,
                                .x = d->x,
                                .y = d->y};
    for (int i = from; i < to; i++) {
        if (sweep_chain_of(d->t, d->row, i) != chain)
            continue;
        d->x[line.n] = d->row[i].value;
        bool settled = d->row[i].kind != SWEEP_UNSETTLED;
        d->y[line.n++] = settled ? value_at(d, i, offset) : (double)NAN;
        any = any || settled;
    }
    if (any)
        figure_put(d->g, &line);
}

/* Those that did not settle, of a chain (-1: of all), which no line joins. */
static void put_unsettled(const struct drawing *d, int chain, size_t offset, int from, int to, bool named)
{
    struct figure_layer dots = {.kind = FIGURE_POINTS,
                                .name = unsettled,
                                .legend = named ? unsettled : NULL,
                                .colour = CHART_GREY,
                                .width = 3.0,
                                .x = d->x,
                                .y = d->y};
    for (int i = from; i < to; i++) {
        if (d->row[i].kind != SWEEP_UNSETTLED || (chain >= 0 && sweep_chain_of(d->t, d->row, i) != chain))
            continue;
        d->x[dots.n] = d->row[i].value;
        d->y[dots.n++] = value_at(d, i, offset);
    }
    if (dots.n)
        figure_put(d->g, &dots);
}

/* A dashed line at the jump in row i. */
static void put_jump(const struct drawing *d, int i, bool named)
{
    char label[SWEEP_LABEL], legend[SWEEP_LABEL];
    snprintf(label, sizeof label, "%.6g", d->row[i].value);
    snprintf(legend, sizeof legend, "%.4g", d->row[i].value);
    figure_put(d->g, &(struct figure_layer){.kind = FIGURE_MARKER,
                                            .name = label,
                                            .legend = named ? legend : NULL,
                                            .colour = colour_of(d->s, sweep_chain_of(d->t, d->row, i)),
                                            .n = 1,
                                            .x = &d->row[i].value});
}

/* A panel of the values at this offset of the rows. name: NULL for the column's meaning. The first one names
 * the curves. A family's curves show their own jumps. */
static void put_panel(const struct drawing *d, size_t offset, const char *name, double height, bool first)
{
    const struct rows_column *c = rows_find(&d->s->m.rows, offset);
    int families = d->s->family.values.n;
    figure_panel(d->g, name ? name : c->meaning, c->unit, height);
    for (int chain = 0; chain < (families ? 2 * families : 2); chain++)
        put_chain(d, chain, offset, 0, d->t->n, first);
    put_unsettled(d, -1, offset, 0, d->t->n, first);
    for (int i = 0; i < d->t->n && !families; i++)
        if (d->row[i].kind == SWEEP_TO)
            put_jump(d, i, first);
}

static void put_panels(const struct drawing *d)
{
    char name[SWEEP_LABEL];
    for (int i = 0; i < d->s->n_harmonics; i++) {
        sweep_name_harmonic(d->s, i, name);
        put_panel(d, AT(measured.amplitude) + (size_t)i * sizeof(double), name, i ? 80.0 : 170.0, i == 0);
        if (i == 0)
            put_panel(d, AT(measured.phase), "its phase to the drive", 80.0, false);
    }
    if (d->s->m.scene.model->n_contacts > 0) {
        put_panel(d, AT(measured.out_of_contact), NULL, 80.0, false);
        put_panel(d, AT(measured.peak_force), NULL, 80.0, false);
    }
}

/* ---- jumps, on the page alone ---- */

static void list_jumps(const struct drawing *d, struct html *h)
{
    const size_t first = AT(measured.amplitude);
    const char *unit = rows_find(&d->s->m.rows, first)->unit;
    char columns[SWEEP_LABEL], text[SWEEP_LABEL];
    snprintf(columns, sizeof columns, "chain,%s from,to,amplitude before (%s),behind (%s)",
             d->s->range.column, unit, unit);
    html_table(h, "Jumps", columns);
    for (int i = 0; i < d->t->n; i++) {
        if (!sweep_is_jump(d->row, i))
            continue;
        html_row(h, false);
        html_cell(h, "%s", sweep_chain_name(d->s, sweep_chain_of(d->t, d->row, i), text));
        for (size_t k = 0; k < 4; k++)
            html_cell(h, "%.9g", value_at(d, i - 1 + (int)k % 2, k < 2 ? AT(value) : first));
    }
}

static void put_around(const struct drawing *d, int i)
{
    const size_t first = AT(measured.amplitude);
    const struct rows_column *c = rows_find(&d->s->m.rows, first);
    int chain = sweep_chain_of(d->t, d->row, i), n = d->t->n;
    char title[SWEEP_LABEL], text[SWEEP_LABEL];
    snprintf(title, sizeof title, "around the jump at %.6g, %s", d->row[i].value,
             sweep_chain_name(d->s, chain, text));
    figure_panel(d->g, title, c->unit, 0.0);
    int from = i > POINTS_AROUND ? i - POINTS_AROUND : 0, to = i + POINTS_AROUND < n ? i + POINTS_AROUND : n;
    put_chain(d, chain, first, from, to, false);
    put_unsettled(d, chain, first, from, to, false);
    put_jump(d, i, false);
}

static void put_jumps(const struct drawing *d)
{
    struct html *h = figure_page(d->g);
    int drawn = 0, jumps = 0;
    for (int i = 0; i < d->t->n; i++)
        jumps += sweep_is_jump(d->row, i);
    if (!h || !jumps)
        return;
    list_jumps(d, h);
    for (int i = 0; i < d->t->n && drawn < JUMPS_DRAWN; i++)
        if (sweep_is_jump(d->row, i)) {
            put_around(d, i);
            drawn++;
        }
}

/* How many points, how they were settled, how many did not, and what colours mean. */
static void put_subtitle(const struct drawing *d)
{
    const struct sweep *s = d->s;
    char text[2 * SWEEP_LABEL], settled[SWEEP_LABEL], left[SWEEP_LABEL] = "";
    int n = sweep_unsettled(d->t, d->row), families = s->family.values.n;
    const char *colours = !families             ? "dashed: jumps%s"
                          : families <= COLOURS ? "a colour for each %s"
                                                : "6 colours in turn for the values of %s";
    sweep_say_settled(s, settled);
    if (n)
        snprintf(left, sizeof left, "%d %s; ", n, unsettled);
    n = snprintf(text, sizeof text, "%d points up and down, %s %s; %s", s->range.values.n,
                 n ? "to settle" : "each settled", settled, left);
    snprintf(text + n, sizeof text - (size_t)n, colours, families ? s->family.words : "");
    figure_subtitle(d->g, text);
}

const char *sweep_draw(void *context, const struct rows_table *t, struct figure *g)
{
    const struct sweep *s = context;
    struct drawing d = {.s = s, .row = rows_row(t, 0), .t = t, .g = g};
    d.x = calloc((size_t)t->n + 1, 2 * sizeof *d.x);
    if (!d.x)
        return "no memory";
    d.y = d.x + t->n;
    put_subtitle(&d);
    maps_put_axis(g, &s->range);
    put_panels(&d);
    put_jumps(&d);
    free(d.x);
    return NULL;
}
