/* basin_html.c - the report of a basin map: its attractors as a table, and where the starts of each lie. */
#include "host_sim/maps/basin/basin.h"
#include "host_sim/report/html.h"
#include "host_sim/report/html_scene.h"

#include <errno.h>
#include <stdlib.h>

enum { POINTS = 18000 /* in all charts at most, so that a page has less than 1 MB */, TEXT = 160 };

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

/* Start velocity over start position of degree of freedom i. The rare ones come last, on top. */
static void put_plane(struct html *h, const struct basin *b, const struct basin_clusters *c,
                      const struct basin_row *row, int n, int every, int i, double *x, double *y)
{
    int v = b->plant.model->n_states / 2 + i;
    char name[TEXT], x_name[TEXT];
    snprintf(name, sizeof name, "start %s", scenes_state_name(&b->m.scene, v));
    snprintf(x_name, sizeof x_name, "start %s", scenes_state_name(&b->m.scene, i));
    html_chart(h, name, basin_unit(b, v), x_name, basin_unit(b, i));
    for (int k = 0; k < BASIN_CLASSES; k++) {
        size_t m = 0;
        for (int j = 0; j < n; j += every) {
            if (basin_class_of(row[j].attractor) != k)
                continue;
            x[m] = row[j].x[i];
            y[m++] = row[j].x[v];
        }
        basin_class_name(c, k, name, sizeof name);
        if (m)
            html_line(h, HTML_POINTS, name, m, x, y);
    }
}

static const char *put_all(struct html *h, const struct basin *b, const struct basin_clusters *c,
                           const struct basin_row *row, int n, double *x, double *y)
{
    int every = (n * (b->plant.model->n_states / 2) + POINTS - 1) / POINTS;
    put_words(h, b, c, every);
    put_table(h, b, c);
    for (int i = 0; i < b->plant.model->n_states / 2; i++)
        put_plane(h, b, c, row, n, every, i, x, y);
    html_scene(h, &b->m.scene, b->plant.model, b->plant.si);
    return html_end(h);
}

const char *basin_html(const struct basin *b, const struct basin_clusters *c, const struct basin_row *row,
                       int n, const char *path)
{
    struct html h;
    double *x = malloc(2 * POINTS * sizeof *x);
    if (!x)
        return "no memory";
    const char *why = html_begin(&h, path, "basin", b->m.name, b->argc, b->argv);
    if (!why)
        why = put_all(&h, b, c, row, n, x, x + POINTS);
    free(x);
    return why;
}
