/* maps.c - see maps.h. */
#include "host_sim/maps/maps.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/scene/scene_range.h"
#include "host_sim/cli/unit.h"
#include "models/models.h"

int maps_load(const struct options *o, struct maps_scene *m)
{
    char why[SCENE_REASON];
    m->origin = scene_load_cold(o->n_words ? o->word[0] : model_table[0]->name, &m->scene, why);
    if (m->origin == SCENE_OF_NOTHING)
        return options_misuse(o->usage, "%s", why);
    const char *name = options_given(o, "method") ? options_text(o, "method", 0) : m->scene.method;
    m->method = method_find(name);
    m->tol = options_given(o, "tol") ? options_number(o, "tol") : m->scene.tolerance;
    if (!m->method)
        return options_misuse(o->usage, "%s: no such method; contactplant list shows them", name);
    m->scene.method = m->method->name;
    m->scene.tolerance = m->tol;
    return scene_range_settings(o, &m->scene);
}

static void no_flow(const double *p, const struct input *u, const double *x, struct flow *flow)
{
    (void)p, (void)u, (void)x, (void)flow;
}

static double no_piece(struct ledger *l, const double *p, const struct segment *e, const double *x0,
                       const double *x1)
{
    (void)l, (void)p, (void)e, (void)x0, (void)x1;
    return 0.0;
}

void maps_drop_books(struct plant *pl)
{
    static const struct model silent = {.flow = no_flow}; /* asked after each change of the inputs */
    pl->books = NULL;
    pl->ledger.model = &silent;
    pl->ledger.piece = no_piece;
}

double maps_damping(const struct model *m, const double *p)
{
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    double least = HUGE_VAL;
    for (int n = m->n_states / 2, i = 0; i < n; i++) {
        double x[MODEL_STATES], a[MODEL_STATES];
        m->rest(p, x);
        x[n + i] = 1.0;
        m->rhs(p, u, x, a);
        least = fmin(least, -a[n + i]);
    }
    return least;
}

int maps_read_time(const struct options *o, const char *name, const struct scene *s, double *value)
{
    const char *text = options_text(o, name, 0), *unit = scenes_dimensionless(s) ? "" : "s";
    char why[UNIT_REASON], ignored[UNIT_REASON];
    double time;
    if (!text)
        return 0;
    if (!unit_read(text, strlen(text), unit, &time, why) &&
        !unit_read(text, strlen(text), "", &time, ignored))
        return options_misuse(o->usage, "--%s %s: %s", name, text, why);
    if (!(time >= 1e-12 && time <= 1e12))
        return options_misuse(o->usage, "--%s %s: give a time above 0", name, text);
    *value = time;
    return 0;
}

int maps_check_files(const struct options *o, enum scene_origin origin)
{
    const char *out = options_text(o, "out", 0), *svg = options_text(o, "svg", 0);
    if (svg && !out)
        return options_misuse(o->usage, "--svg is drawn from a file of rows; give --out too");
    if (svg && options_given(o, "shard"))
        return options_misuse(
            o->usage, "--svg goes without --shard; put the shards' files together, and give them as --out");
    for (int i = 0; i < 2; i++) {
        const char *path = i ? svg : out;
        if (path && o->n_words && scene_load_is(origin, o->word[0], path))
            return options_misuse(o->usage, "%s is the scene itself; choose another file", path);
    }
    return svg && scene_load_same(svg, out)
               ? options_misuse(o->usage, "--svg and --out are both %s; choose two files", svg)
               : 0;
}

void maps_warn(const struct options *o, const struct maps_scene *m)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(&m->scene, si, drive);
    if (scene_load_warns(m->origin, m->scene.model))
        scene_load_warn(o->usage->name, m->scene.model, si, drive);
}

int maps_finish_chart(const struct options *o, struct chart *c)
{
    const char *svg = options_text(o, "svg", 0), *out = options_text(o, "out", 0);
    bool rows = scene_load_same(svg, out); /* which was not there yet before */
    FILE *f = rows ? NULL : fopen(svg, "w");
    const char *why = f ? chart_end(c, f) : rows ? "this is --out; choose another" : strerror(errno);
    if (f && fclose(f) && !why)
        why = strerror(errno);
    return why ? options_failure(o->usage, "--svg %s: %s; the rows are complete, give the same command", svg,
                                 why)
               : 0;
}

static void read_row(struct maps_table *t, char *line)
{
    double *cell = &t->cell[(size_t)t->n++ * (size_t)t->columns];
    (void)strsep(&line, ",");
    (void)strsep(&line, ",");
    for (int i = 0; i < t->columns; i++) {
        char *text = strsep(&line, ","), *end = text;
        double value = text ? strtod(text, &end) : 0.0;
        cell[i] = end == text ? (double)NAN : value;
    }
}

bool maps_read(struct maps_table *t, int columns, const char *path)
{
    enum { LINE = 4096 };
    char line[LINE];
    int lines = 0;
    FILE *f = fopen(path, "r");
    if (!f)
        return false;
    while (fgets(line, sizeof line, f))
        lines++;
    rewind(f);
    *t = (struct maps_table){.columns = columns};
    t->cell = calloc((size_t)lines * (size_t)columns + 1, sizeof *t->cell);
    for (int i = 0; t->cell && i < lines && fgets(line, sizeof line, f); i++)
        if (i)
            read_row(t, line);
    bool good = t->cell && !ferror(f);
    fclose(f);
    return good;
}
