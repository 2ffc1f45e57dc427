/* basin_draw.c - the picture of a basin map: a dot for each start, coloured by the attractor that it
 * reached. */
#include "host_sim/maps/basin/basin.h"
#include "host_sim/cli/chart.h"

#include <math.h>
#include <stdlib.h>
#include "host_sim/out/utf8.h"

static const enum chart_colour colour[] = {CHART_SKY,    CHART_RED,    CHART_BLUE, CHART_GREEN,
                                           CHART_ORANGE, CHART_PURPLE, CHART_GREY};
enum { IN_LEGEND = 4 /* in one panel */ };

void basin_period_text(const struct basin_motion *motion, char *text, size_t size)
{
    if (motion->period > 0)
        snprintf(text, size, "%d", motion->period);
    else
        snprintf(text, size, "%s", basin_clusters_kind(motion) == BASIN_CHAOTIC ? "chaos" : "none");
}

int basin_class_of(int attractor)
{
    return attractor < 0 ? BASIN_NONE : attractor < BASIN_OWN ? attractor : BASIN_OTHERS;
}

static int count_of(const struct basin_clusters *c, int k)
{
    int n = 0;
    if (k == BASIN_NONE)
        return c->escaped + c->trouble;
    for (int i = 0; i < c->n; i++)
        n += basin_class_of(i) == k ? c->attractor[i].count : 0;
    return n;
}

void basin_class_name(const struct basin_clusters *c, int k, char *name, size_t size)
{
    double share = 100.0 * count_of(c, k) / c->total;
    if (k < BASIN_OWN && c->attractor[k].motion.period > 0)
        snprintf(name, size, "%d: period %d, %.3g %%", k + 1, c->attractor[k].motion.period, share);
    else if (k < BASIN_OWN)
        snprintf(name, size, "%d: %s, %.3g %%", k + 1,
                 basin_clusters_kind(&c->attractor[k].motion) == BASIN_CHAOTIC ? "chaotic" : "aperiodic",
                 share);
    else if (k == BASIN_OTHERS)
        snprintf(name, size, "%d others, %.3g %%", c->n - BASIN_OWN, share);
    else
        snprintf(name, size, "escaped, %.3g %%", share);
}

/* State i of the starts in class k, in the unit of an axis. Returns how many they are. */
static size_t collect(const struct basin_row *row, int n, int k, int i, double unit, double *to)
{
    size_t m = 0;
    for (int j = 0; j < n; j++)
        if (basin_class_of(row[j].attractor) == k)
            to[m++] = row[j].x[i] / unit;
    return m;
}

struct axis {
    double unit; /* in the state's own unit: 1, or less for small values */
    double low, high;
    char label[96];
};

static void axis_of(const struct basin *b, const struct basin_row *row, int n, int i, struct axis *a)
{
    const char *name = scenes_state_name(&b->m.scene, i), *unit = basin_unit(b, i);
    double low = (double)INFINITY, high = -(double)INFINITY;
    for (int j = 0; j < n; j++)
        chart_range_add(&low, &high, &row[j].x[i], 1);
    chart_range_finish(&low, &high);
    double most = fmax(fabs(low), fabs(high));
    const char *prefix = !*unit || most >= 0.5 ? "" : most >= 5e-4 ? "m" : most >= 5e-7 ? "u" : "n";
    a->unit = *prefix == 'm' ? 1e-3 : *prefix == 'u' ? 1e-6 : *prefix == 'n' ? 1e-9 : 1.0;
    a->low = low / a->unit;
    a->high = high / a->unit;
    snprintf(a->label, sizeof a->label, *unit ? "start %s (%s%s)" : "start %s", name, prefix, unit);
}

/* Degree of freedom i: start velocity over start position. Rare classes have larger dots, and lie on top. */
static void panel(struct chart *c, const struct basin *b, const struct basin_clusters *clusters,
                  const struct basin_row *row, int n, int i, double *x, double *y)
{
    char name[64];
    int v = b->plant.model->n_states / 2 + i;
    double common = fmin(2.2 * sqrt(1e4 / n), 4.0); /* px, so that dots stay apart */
    struct axis across, up;
    axis_of(b, row, n, i, &across);
    axis_of(b, row, n, v, &up);
    chart_x_range(c, across.low, across.high);
    chart_panel(c, up.label, 330.0, up.low, up.high);
    for (int k = 0; k < BASIN_CLASSES; k++) {
        int count = count_of(clusters, k);
        if (count == 0)
            continue;
        size_t m = collect(row, n, k, i, across.unit, x);
        collect(row, n, k, v, up.unit, y);
        basin_class_name(clusters, k, name, sizeof name);
        double width = fmin(common * (count > n / 10 ? 1.0 : count > n / 100 ? 1.5 : 2.7), 6.0);
        chart_points(c, x, y, m, colour[k], width, k / IN_LEGEND == i ? name : NULL);
    }
    chart_x_axis(c, across.label);
}

const char *basin_draw(const struct basin *b, const struct basin_clusters *c, const struct basin_row *row,
                       int n, FILE *out)
{
    char title[200], subtitle[200];
    struct chart chart;
    double *x = malloc((size_t)n * sizeof *x), *y = malloc((size_t)n * sizeof *y);
    const char *why = "no memory for the picture";
    if (x && y) {
        snprintf(title, sizeof title, "Basins of attraction: %.*s", utf8_fits(b->m.name, 100), b->m.name);
        snprintf(subtitle, sizeof subtitle,
                 "%d starts in %d dimensions, each where it began, coloured by the attractor it reached (%d "
                 "in all)",
                 n, b->plant.model->n_states, c->n);
        chart_begin(&chart, title, subtitle);
        for (int i = 0; i < b->plant.model->n_states / 2; i++)
            panel(&chart, b, c, row, n, i, x, y);
        why = chart_end(&chart, out);
    }
    free(x);
    free(y);
    return why;
}
