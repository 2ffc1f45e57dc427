/* sweep_report.c - see sweep_report.h. */
#include "host_sim/maps/sweep/sweep_report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/unit.h"
#include "host_sim/maps/sweep/sweep_chain.h"
#include "host_sim/out/plural.h"

enum { COLOURS = 6 /* in words below, too */, JUMPS_TOLD = 12, JUMPS_DRAWN = 6, POINTS_AROUND = 6 };

static const char *const did_not_settle = "did not settle";

/* A row that is the far side of a jump's bracket: the row before it is the near one. */
static bool is_jump(const struct sweep_result *row, int i)
{
    return row[i].kind == SWEEP_TO && i > 0 && row[i - 1].kind == SWEEP_FROM;
}

/* "up"; with a family "amplitude of force 4.54545 N, up". */
static const char *chain_name(const struct sweep *s, int chain, char text[SWEEP_LABEL])
{
    const struct scene_range *f = &s->family;
    const char *way = chain % 2 ? "down" : "up";
    char value[UNIT_TEXT];
    if (!f->values.n)
        return way;
    maps_in_words(range_value(&f->values, chain / 2), f->unit, value);
    snprintf(text, SWEEP_LABEL, "%s %s, %s", f->words, value, way);
    return text;
}

/* "amplitude of penetration, harmonic 1/2", of harmonic i. */
static void name_harmonic(const struct sweep *s, int i, char name[SWEEP_LABEL])
{
    const struct sweep_harmonic *h = &s->harmonic[i];
    snprintf(name, SWEEP_LABEL, h->m > 1 ? "amplitude of %s, harmonic %u/%u" : "amplitude of %s, harmonic %u",
             s->m.scene.model->output_signal[(int)s->m.scene.observable].name, (unsigned)h->n,
             (unsigned)h->m);
}

/* "over 20 periods", "until the damping leaves 1e-4". */
static void say_settled(const struct sweep *s, char text[SWEEP_LABEL])
{
    if (s->settle < 0)
        snprintf(text, SWEEP_LABEL, "until the damping leaves 1e-4");
    else
        snprintf(text, SWEEP_LABEL, "over %d period%s", s->settle, plural(s->settle));
}

/* How many points did not settle. */
static int count_unsettled(const struct rows_table *t, const struct sweep_result *row)
{
    int n = 0;
    for (int i = 0; i < t->n; i++)
        n += row[i].kind == SWEEP_UNSETTLED;
    return n;
}

static void tell_jump(const struct sweep *s, const struct rows_table *t, const struct sweep_result *row,
                      int i, FILE *f)
{
    const char *unit = s->m.scene.model->output_signal[s->m.scene.observable].unit;
    char chain[SWEEP_LABEL], at[UNIT_TEXT], before[UNIT_TEXT], behind[UNIT_TEXT];
    unit = scenes_dimensionless(&s->m.scene) ? "" : unit;
    fprintf(f, "  %s at %s: amplitude from %s to %s\n", chain_name(s, sweep_chain_of(t, row, i), chain),
            maps_in_words(row[i].value, s->range.unit, at),
            maps_in_words(row[i - 1].measured.amplitude[0], unit, before),
            maps_in_words(row[i].measured.amplitude[0], unit, behind));
}

/* The row with the largest amplitude of the first harmonic, or -1. */
static int find_largest(const struct rows_table *t, const struct sweep_result *row)
{
    int largest = -1;
    for (int i = 0; i < t->n; i++) {
        double a = row[i].measured.amplitude[0];
        if (isfinite(a) && (largest < 0 || a > row[largest].measured.amplitude[0]))
            largest = i;
    }
    return largest;
}

static void tell(void *context, const struct rows_table *t, FILE *f)
{
    const struct sweep *s = context;
    const struct sweep_result *row = rows_row(t, 0);
    const struct signal *y = &s->m.scene.model->output_signal[s->m.scene.observable];
    const char *unit = scenes_dimensionless(&s->m.scene) ? "" : y->unit;
    int jumps = 0, unsettled = count_unsettled(t, row), escaped = 0, largest = find_largest(t, row);
    char a[UNIT_TEXT], b[UNIT_TEXT], name[SWEEP_LABEL];
    name_harmonic(s, 0, name);
    for (int i = 0; i < t->n; i++) {
        jumps += is_jump(row, i);
        escaped += row[i].kind == SWEEP_ESCAPED;
    }
    fprintf(f, "%s, %s from %s to %s in %d point%s, up and down\n", s->m.name, s->range.words,
            maps_in_words(s->range.values.from, s->range.unit, a),
            maps_in_words(s->range.values.to, s->range.unit, b), s->range.values.n,
            plural(s->range.values.n));
    if (largest >= 0)
        fprintf(f, "largest %s: %s at %s%s\n", name,
                maps_in_words(row[largest].measured.amplitude[0], unit, a),
                maps_in_words(row[largest].value, s->range.unit, b),
                row[largest].kind == SWEEP_UNSETTLED ? ", which did not settle" : "");
    if (jumps)
        fprintf(f, "%d jump%s located by bisection:\n", jumps, plural(jumps));
    else
        fputs(unsettled ? "no jump was found where points settled\n" : "no jump was found\n", f);
    for (int i = 0, n = 0; i < t->n && n < JUMPS_TOLD; i++)
        if (is_jump(row, i)) {
            tell_jump(s, t, row, i, f);
            n++;
        }
    if (jumps > JUMPS_TOLD)
        fprintf(f, "  and %d more, in the rows jump_from and jump_to\n", jumps - JUMPS_TOLD);
    if (unsettled)
        fprintf(f,
                "%d point%s did not settle: give more --settle, or the motion is chaotic or beats; see "
                "contactplant basin and random\n",
                unsettled, plural(unsettled));
    if (escaped)
        fprintf(f, "the motion escaped at %d point%s\n", escaped, plural(escaped));
}

/* ---- picture and page ----
 *
 * Up and down have a colour each, or each value of the family has one. Jumps are dashed. */

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
                                .name = chain_name(d->s, chain, name),
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
                                .name = did_not_settle,
                                .legend = named ? did_not_settle : NULL,
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
        name_harmonic(d->s, i, name);
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
        if (!is_jump(d->row, i))
            continue;
        html_row(h, false);
        html_cell(h, "%s", chain_name(d->s, sweep_chain_of(d->t, d->row, i), text));
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
             chain_name(d->s, chain, text));
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
        jumps += is_jump(d->row, i);
    if (!h || !jumps)
        return;
    list_jumps(d, h);
    for (int i = 0; i < d->t->n && drawn < JUMPS_DRAWN; i++)
        if (is_jump(d->row, i)) {
            put_around(d, i);
            drawn++;
        }
}

/* How many points, how they were settled, how many did not, and what colours mean. */
static void put_subtitle(const struct drawing *d)
{
    const struct sweep *s = d->s;
    char text[2 * SWEEP_LABEL], settled[SWEEP_LABEL], left[SWEEP_LABEL] = "";
    int n = count_unsettled(d->t, d->row), families = s->family.values.n;
    const char *colours = !families             ? "dashed: jumps%s"
                          : families <= COLOURS ? "a colour for each %s"
                                                : "6 colours in turn for the values of %s";
    say_settled(s, settled);
    if (n)
        snprintf(left, sizeof left, "%d %s; ", n, did_not_settle);
    n = snprintf(text, sizeof text, "%d points up and down, %s %s; %s", s->range.values.n,
                 n ? "to settle" : "each settled", settled, left);
    snprintf(text + n, sizeof text - (size_t)n, colours, families ? s->family.words : "");
    figure_subtitle(d->g, text);
}

static const char *draw(void *context, const struct rows_table *t, struct figure *g)
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

const struct maps_finding sweep_finding = {.tell = tell, .draw = draw};
