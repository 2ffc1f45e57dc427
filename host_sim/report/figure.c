/* figure.c - see figure.h. The layers of a panel wait until all are known: they decide its axes. */
#include "host_sim/report/figure.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/files.h"
#include "host_sim/out/utf8.h"

enum { NAME_SHOWN = 100 };

static const char *const ink_of[] = {"blue", "red", "green", "orange", "purple", "sky", "grey", "none"};

static const char *text_or(const char *text, const char *other)
{
    return text ? text : other;
}

/* ---- the page ---- */

static void write_layer(const struct figure *g, struct html *h, const struct figure_layer *l)
{
    size_t every = g->every ? g->every : 1, n = (l->n + every - 1) / every;
    const char *name = text_or(l->name, "");
    h->ink = ink_of[l->colour];
    if (l->kind == FIGURE_LINE)
        html_line(h, HTML_LINE, name, l->n, l->x, l->y);
    if (l->kind == FIGURE_LINE && l->dots)
        html_line(h, HTML_POINTS, name, l->n, l->x, l->y);
    if (l->kind == FIGURE_POINTS)
        html_points(h, name, n, every, l->x, l->y);
    if (l->kind == FIGURE_BAND)
        html_area(h, name, l->n, l->x, l->y, l->z);
    if (l->kind == FIGURE_CELLS)
        html_cells(h, name, l->n, l->x, l->z, l->y, l->half);
    if (l->kind == FIGURE_MARKER)
        html_marker(h, l->x[0], "%s", name);
    if (l->kind == FIGURE_SPAN)
        html_span(h, name, l->x[0], l->z[0]);
    h->ink = NULL;
}

static void write_panel(struct figure *g)
{
    (g->axis.logarithmic ? html_chart_log_x : html_chart)(&g->page, g->title, g->unit, g->axis_name,
                                                          g->axis.unit);
    const double x[2] = {g->axis.from, g->axis.to}, y[2] = {g->from, g->to};
    if (y[0] < y[1])
        html_bounds(&g->page, x, y);
    for (size_t i = 0; i < g->n; i++)
        write_layer(g, &g->page, &g->kept[i].layer);
}

/* ---- the picture ---- */

static void add_range(const struct figure_layer *l, double *min, double *max)
{
    const double edges[2] = {-l->half, l->half};
    if (l->kind == FIGURE_MARKER || l->kind == FIGURE_SPAN)
        return;
    chart_range_add(min, max, l->y, l->n);
    if (l->kind == FIGURE_BAND)
        chart_range_add(min, max, l->z, l->n);
    for (int i = 0; l->kind == FIGURE_CELLS && i < 2; i++)
        for (size_t k = 0; k < l->n; k++)
            chart_range_add(min, max, &(double){l->y[k] + edges[i]}, 1);
}

static void add_reach(const struct figure_layer *l, double *min, double *max)
{
    chart_range_add(min, max, l->x, l->n);
    if (l->kind == FIGURE_CELLS || l->kind == FIGURE_SPAN)
        chart_range_add(min, max, l->z, l->n);
}

/* From the numbers of the figure to those on an axis. */
static void scale(double *value, size_t n, double factor, bool logarithmic)
{
    for (size_t i = 0; value && i < n; i++)
        value[i] = logarithmic ? log10(value[i]) : factor * value[i];
}

static void place_axis(struct figure *g)
{
    const struct figure_axis *a = &g->axis;
    double min = a->from, max = a->to;
    if (!(min < max)) {
        min = (double)INFINITY, max = -(double)INFINITY;
        for (size_t i = 0; i < g->n; i++)
            add_reach(&g->kept[i].layer, &min, &max);
        chart_range_finish(&min, &max);
    }
    char name[FIGURE_TEXT + 16];
    snprintf(name, sizeof name, a->logarithmic ? "log10 of %s" : "%s", g->axis_name);
    double factor = chart_label(g->axis_label, sizeof g->axis_label, name, a->unit,
                                a->logarithmic ? 1.0 : fmax(fabs(min), fabs(max)));
    double ends[2] = {min, max};
    scale(ends, 2, factor, a->logarithmic);
    chart_x_range(&g->chart, ends[0], ends[1]);
    for (size_t i = 0; i < g->n; i++) {
        struct figure_kept *k = &g->kept[i];
        scale(k->data, k->layer.n, factor, a->logarithmic);
        if (k->layer.kind == FIGURE_CELLS || k->layer.kind == FIGURE_SPAN)
            scale(k->data + 2 * k->layer.n, k->layer.n, factor, a->logarithmic);
    }
}

static void place_panel(struct figure *g)
{
    char label[FIGURE_TEXT];
    double min = g->from, max = g->to;
    bool given = min < max;
    if (!given)
        min = (double)INFINITY, max = -(double)INFINITY;
    for (size_t i = 0; i < g->n && !given; i++)
        add_range(&g->kept[i].layer, &min, &max);
    double factor = chart_label(label, sizeof label, g->title, g->unit, fmax(fabs(min), fabs(max)));
    min *= factor, max *= factor;
    if (!given)
        chart_range_finish(&min, &max);
    for (size_t i = 0; i < g->n; i++) {
        struct figure_kept *k = &g->kept[i];
        scale(k->data + k->layer.n, k->layer.n, factor, false);
        if (k->layer.kind == FIGURE_BAND)
            scale(k->data + 2 * k->layer.n, k->layer.n, factor, false);
        k->layer.half *= factor;
    }
    chart_panel(&g->chart, label, g->height, min, max);
}

static void draw_layer(struct chart *c, const struct figure_layer *l)
{
    if (l->kind == FIGURE_LINE)
        chart_line(c, l->x, l->y, l->n, l->colour, l->legend);
    if (l->kind == FIGURE_POINTS)
        chart_points(c, l->x, l->y, l->n, l->colour, l->width, l->legend);
    if (l->kind == FIGURE_BAND)
        chart_band(c, l->x, l->y, l->z, l->n, l->colour, l->legend);
    if (l->kind == FIGURE_CELLS)
        chart_cells(c, l->x, l->z, l->y, l->n, l->half, l->colour, l->legend);
    if (l->kind == FIGURE_MARKER)
        chart_marker(c, l->x[0], l->legend, l->colour);
    if (l->kind == FIGURE_SPAN)
        chart_span(c, l->x[0], l->z[0], NULL, l->colour);
    if (l->kind == FIGURE_SPAN && l->legend)
        chart_legend(c, l->colour, l->legend);
}

static void draw_panel(struct figure *g)
{
    place_axis(g);
    place_panel(g);
    for (size_t i = 0; i < g->n; i++)
        draw_layer(&g->chart, &g->kept[i].layer);
}

/* ---- panels and layers ---- */

/* The texts of a layer are its own after a move, too. */
static void name_layers(struct figure *g)
{
    for (size_t i = 0; i < g->n; i++) {
        struct figure_kept *k = &g->kept[i];
        k->layer.name = k->layer.name ? k->name : NULL;
        k->layer.legend = k->layer.legend ? k->legend : NULL;
    }
}

static void end_panel(struct figure *g)
{
    name_layers(g);
    if (g->open && g->writes)
        write_panel(g);
    if (g->open && g->draws && g->height > 0.0)
        draw_panel(g); /* changes the numbers */
    for (size_t i = 0; i < g->n; i++)
        free(g->kept[i].data);
    g->n = 0;
    g->open = false;
}

static void end_axis(struct figure *g)
{
    end_panel(g);
    if (g->draws && *g->axis_label)
        chart_x_axis(&g->chart, g->axis_label);
    *g->axis_label = '\0';
}

void figure_axis(struct figure *g, const struct figure_axis *axis)
{
    end_axis(g);
    g->axis = *axis;
    snprintf(g->axis_name, sizeof g->axis_name, "%s", axis->name);
    g->axis.name = g->axis_name;
}

void figure_panel(struct figure *g, const char *title, const char *unit, double height)
{
    end_panel(g);
    g->open = true;
    snprintf(g->title, sizeof g->title, "%s", title);
    snprintf(g->unit, sizeof g->unit, "%s", unit);
    g->height = height;
    g->from = g->to = 0.0;
}

void figure_range(struct figure *g, double from, double to)
{
    g->from = from;
    g->to = to;
}

static struct figure_kept *make_room(struct figure *g)
{
    if (g->n == g->room) {
        size_t room = g->room ? 2 * g->room : 16;
        struct figure_kept *kept = realloc(g->kept, room * sizeof *kept);
        if (!kept)
            return NULL;
        g->kept = kept;
        g->room = room;
    }
    return &g->kept[g->n];
}

void figure_put(struct figure *g, const struct figure_layer *layer)
{
    struct figure_kept *k = make_room(g);
    size_t bytes = layer->n * sizeof *layer->x;
    double *data = k ? calloc(3 * layer->n + 1, sizeof *data) : NULL;
    if (!data) {
        g->why = "no memory";
        return;
    }
    *k = (struct figure_kept){.layer = *layer, .data = data};
    snprintf(k->name, sizeof k->name, "%s", text_or(layer->name, ""));
    snprintf(k->legend, sizeof k->legend, "%s", text_or(layer->legend, ""));
    memcpy(data, layer->x, bytes);
    if (layer->y)
        memcpy(data + layer->n, layer->y, bytes);
    if (layer->z)
        memcpy(data + 2 * layer->n, layer->z, bytes);
    k->layer.x = data;
    k->layer.y = data + layer->n;
    k->layer.z = data + 2 * layer->n;
    g->n++;
}

struct html *figure_page(struct figure *g)
{
    end_panel(g);
    return g->writes ? &g->page : NULL;
}

/* ---- files ---- */

static int fail(const struct options *o, const char *option, const char *why)
{
    return options_failure(o->usage, "--%s %s: %s; the rows are complete, give the same command", option,
                           options_text(o, option, 0), why);
}

void figure_begin_picture(struct figure *g, const struct options *o, const char *name)
{
    *g = (struct figure){.draws = options_given(o, "svg")};
    snprintf(g->name, sizeof g->name, "contactplant %s %.*s", o->usage->name, utf8_fits(name, NAME_SHOWN),
             name);
}

int figure_begin(struct figure *g, const struct options *o, const char *name)
{
    figure_begin_picture(g, o, name);
    g->writes = options_given(o, "report");
    const char *why =
        g->writes ? html_begin(&g->page, options_text(o, "report", 0), o->usage->name, name, o->argc, o->argv)
                  : NULL;
    return why ? fail(o, "report", why) : 0;
}

void figure_subtitle(struct figure *g, const char *text)
{
    if (g->draws)
        chart_begin(&g->chart, g->name, text);
}

static int end_picture(struct figure *g, const struct options *o)
{
    const char *why = NULL;
    FILE *f = files_compose(options_text(o, "svg", 0));
    if (f)
        why = chart_end(&g->chart, f);
    if (!f || (!files_finish(f, !why && !g->why) && !why))
        why = files_unwritten(errno);
    return why || g->why ? fail(o, "svg", g->why ? g->why : why) : 0;
}

int figure_end(struct figure *g, const struct options *o)
{
    end_axis(g);
    free(g->kept);
    int status = g->draws ? end_picture(g, o) : 0;
    const char *why = g->writes ? html_end(&g->page) : NULL;
    return status || !(why || (g->writes && g->why)) ? status : fail(o, "report", why ? why : g->why);
}
