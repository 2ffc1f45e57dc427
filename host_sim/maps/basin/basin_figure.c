/* basin_figure.c - see basin_figure.h. */
#include "host_sim/maps/basin/basin_figure.h"
#include "host_sim/maps/basin/basin_rows.h"

#include <math.h>
#include <stdlib.h>

static const enum chart_colour colour[] = {CHART_SKY,    CHART_RED,    CHART_BLUE, CHART_GREEN,
                                           CHART_ORANGE, CHART_PURPLE, CHART_GREY};
enum {
    IN_LEGEND = 4,  /* in one panel */
    POINTS = 18000, /* on the page at most, so that it has less than 1 MB */
    TEXT = 160
};

/* The classes of a figure: the most frequent attractors, then all others, then motions without an attractor.
 */
enum { OWN = 5, OTHERS = 5, NONE = 6, CLASSES = 7 };

void basin_period_text(const struct basin_motion *motion, char *text, size_t size)
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
        snprintf(name, size, "%d others, %.3g %%", c->n - OWN, share);
    else
        snprintf(name, size, "escaped, %.3g %%", share);
}

/* ---- the page's words and table ---- */

static void put_words(struct html *h, const struct basin *b, const struct basin_clusters *c, int every)
{
    html_words(h, "%s by method %s, %d steps a drive period: %d starts lead to %d attractors.",
               b->plant.model->name, b->plant.series ? "batch_taylor" : b->plant.method->name, b->plant.steps,
               c->total, c->n);
    if (c->escaped + c->trouble)
        html_words(h, "%d motions escaped, and %d were given up.", c->escaped, c->trouble);
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
        basin_period_text(&a->motion, text, sizeof text);
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

/* State i of the starts in class k. Returns how many they are. */
static size_t collect(const struct basin_row *row, int n, int k, int i, double *to)
{
    size_t m = 0;
    for (int j = 0; j < n; j++)
        if (class_of(row[j].attractor) == k)
            to[m++] = row[j].x[i];
    return m;
}

/* Degree of freedom i: start velocity over start position. Rare classes have larger dots, and lie on top. */
static void put_plane(struct figure *g, const struct basin *b, const struct basin_clusters *c,
                      const struct basin_row *row, int n, int i, double *x, double *y)
{
    int v = b->plant.model->n_states / 2 + i;
    double common = fmin(2.2 * sqrt(1e4 / n), 4.0); /* px, so that dots stay apart */
    char name[FIGURE_TEXT];
    snprintf(name, sizeof name, "start %s", scenes_state_name(&b->m.scene, i));
    figure_axis(g, &(struct figure_axis){.name = name, .unit = basin_unit(b, i)});
    snprintf(name, sizeof name, "start %s", scenes_state_name(&b->m.scene, v));
    figure_panel(g, name, basin_unit(b, v), 330.0);
    for (int k = 0; k < CLASSES; k++) {
        int count = count_of(c, k);
        if (count == 0)
            continue;
        class_name(c, k, name, sizeof name);
        struct figure_layer dots = {.kind = FIGURE_POINTS,
                                    .name = name,
                                    .legend = k / IN_LEGEND == i ? name : NULL,
                                    .colour = colour[k],
                                    .n = collect(row, n, k, i, x),
                                    .x = x,
                                    .y = y};
        collect(row, n, k, v, y);
        dots.width = fmin(common * (count > n / 10 ? 1.0 : count > n / 100 ? 1.5 : 2.7), 6.0);
        figure_put(g, &dots);
    }
}

const char *basin_draw(const struct basin *b, const struct basin_clusters *c, const struct basin_row *row,
                       int n, struct figure *g)
{
    int planes = b->plant.model->n_states / 2, every = (n * planes + POINTS - 1) / POINTS;
    char text[FIGURE_TEXT];
    double *x = malloc(2 * (size_t)n * sizeof *x);
    if (!x)
        return "no memory";
    snprintf(
        text, sizeof text,
        "%d starts in %d dimensions, each where it began, coloured by the attractor it reached (%d in all)",
        n, 2 * planes, c->n);
    figure_subtitle(g, text);
    if (figure_page(g)) {
        put_words(figure_page(g), b, c, every);
        put_table(figure_page(g), b, c);
    }
    g->every = (size_t)every;
    for (int i = 0; i < planes; i++)
        put_plane(g, b, c, row, n, i, x, x + n);
    free(x);
    return NULL;
}
