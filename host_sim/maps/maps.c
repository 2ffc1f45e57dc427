/* maps.c - scene, method, identity and files of the commands that run one scene many times. */
#include "host_sim/maps/maps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/unit.h"
#include "host_sim/report/html_scene.h"
#include "host_sim/scene/scene_print.h"
#include "models/check.h"
#include "models/models.h"

const struct option maps_options[] = {
    {"set", "NAME=VALUE", "a number of the scene, with its unit; repeatable", OPTION_TEXT, .many = true,
     .identity = IDENTITY_IN_SCENE},
    {"method", "NAME", "integration method (the scene's)", OPTION_TEXT, .initial = NULL,
     .identity = IDENTITY_INSIDE},
    {"tol", "E", "its tolerance (the scene's; in a sweep 1e-9 at most)", OPTION_NUMBER, METHOD_TOL_MIN,
     METHOD_TOL_MAX, .initial = NULL, .identity = IDENTITY_INSIDE},
    {.name = NULL},
};

const struct option maps_outputs[] = {
    {"svg", "FILE", "a picture of the rows in --out", OPTION_WRITES, .initial = NULL,
     .identity = IDENTITY_OUTSIDE},
    {"report", "FILE", "a page of the rows in --out, which opens in a browser without a network",
     OPTION_WRITES, .initial = NULL, .identity = IDENTITY_OUTSIDE},
    {.name = NULL},
};

int maps_load(struct maps *m)
{
    char why[SCENE_REASON];
    m->name = m->o.n_words ? m->o.word[0] : model_table[0]->name;
    m->origin = scene_load_cold(m->name, &m->scene, why);
    if (m->origin == SCENE_OF_NOTHING)
        return options_misuse(m->o.usage, "%s", why);
    return scene_range_settings(&m->o, &m->scene);
}

int maps_load_method(struct maps *m, double tol_most)
{
    const char *name = options_given(&m->o, "method") ? options_text(&m->o, "method", 0) : m->scene.method;
    char why[SCENE_REASON];
    m->method = method_find(name);
    m->tol = options_given(&m->o, "tol") ? options_number(&m->o, "tol") : fmin(m->scene.tolerance, tol_most);
    if (!m->method) {
        scene_method_refuse(name, why);
        return options_misuse(m->o.usage, "%s", why);
    }
    scene_load_tell_tolerance(&m->o, m->scene.model, m->method);
    return 0;
}

/* The drive's frequency or amplitude at 1, where it is twice as much at 2; else 0. */
static double proportion(const struct scene *s, const struct scene_range *r, int input, bool frequency)
{
    double si[MODEL_PARAMETERS], at[2];
    struct harmonic drive[MODEL_INPUTS];
    for (int i = 0; i < 2; i++) {
        struct scene other = *s;
        scene_range_set(&other, r, 1.0 + i);
        scenes_resolve(&other, si, drive);
        at[i] = frequency ? drive[input].omega : drive[input].amplitude;
    }
    return fabs(at[1] - 2.0 * at[0]) <= 1e-9 * fabs(at[0]) ? at[0] : 0.0;
}

bool maps_find_drive_number(const struct scene *s, int input, bool frequency, struct scene_range *r,
                            double *factor)
{
    for (int i = 0; scene_range_nth(s, i, r); i++)
        if (r->key.kind == KEY_NUMBER && (*factor = proportion(s, r, input, frequency)) > 0.0)
            return true;
    return false;
}

bool maps_sounds(const struct harmonic *d)
{
    return d->omega > 0.0 && (d->amplitude < 0.0 || d->amplitude > 0.0);
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

int maps_read_time(const struct maps *m, const char *name, double *value)
{
    const char *text = options_text(&m->o, name, 0), *unit = scenes_dimensionless(&m->scene) ? "" : "s";
    char why[UNIT_REASON];
    double time;
    if (!text)
        return 0;
    if (!unit_read_or_bare(text, strlen(text), unit, &time, why))
        return options_misuse(m->o.usage, "--%s %s: %s", name, text, why);
    if (!(time >= 1e-12 && time <= 1e12))
        return options_misuse(m->o.usage, "--%s %s: give a time above 0", name, text);
    *value = time;
    return 0;
}

int maps_check_files(const struct maps *m, const char *rows)
{
    static const char *const output[] = {"svg", "report"};
    for (int i = 0; i < 2; i++) {
        if (!options_given(&m->o, output[i]))
            continue;
        if (!rows)
            return options_misuse(m->o.usage, "--%s is made from a file of rows; give --out too", output[i]);
        if (options_given(&m->o, "shard"))
            return options_misuse(
                m->o.usage,
                "--%s goes without --shard; put the shards' files together, and give them as --out",
                output[i]);
    }
    return 0;
}

/* The method and its tolerance stand in the scene or on the command line. */
static bool say_method(const struct maps *m, const char *option, FILE *f)
{
    bool is_tol = !strcmp(option, "tol");
    if (!m->method || (!is_tol && strcmp(option, "method") != 0))
        return false;
    return is_tol ? fprintf(f, "%.17g", m->tol) : fprintf(f, "%s", m->method->name);
}

static void say_given(const struct options *o, const struct option *row, FILE *f)
{
    if (row->kind == OPTION_NUMBER || row->kind == OPTION_INTEGER)
        fprintf(f, "%.17g", options_number(o, row->name));
    else
        for (int i = 0; i == 0 || i < options_count(o, row->name); i++)
            fprintf(f, "%s ", options_text(o, row->name, i) ? options_text(o, row->name, i) : "");
}

static void say_row(const struct maps *m, const struct option *row, maps_say *say, const void *context,
                    FILE *f)
{
    ASSERT(row->identity != IDENTITY_UNSAID);
    if (row->identity != IDENTITY_INSIDE)
        return;
    fprintf(f, "%s ", row->name);
    if (!say(context, row->name, f) && !say_method(m, row->name, f))
        say_given(&m->o, row, f);
    fputc('\n', f);
}

int maps_identify(struct maps *m, const char *kind, maps_say *say, const void *context)
{
    FILE *f = open_memstream(&m->identity, &m->identity_size);
    if (!f)
        return options_failure(m->o.usage, "out of memory");
    scene_print(f, kind, &m->scene);
    for (int i = 0; i < OPTIONS_TABLES && m->o.usage->table[i]; i++)
        for (const struct option *row = m->o.usage->table[i]; row->name; row++)
            say_row(m, row, say, context, f);
    fputs(m->rows.header, f);
    return fclose(f) ? options_failure(m->o.usage, "out of memory") : 0;
}

int maps_compute(struct maps *m, struct jobs *j)
{
    struct scene_point q;
    point_of_scene(&m->scene, &q);
    if (scene_load_warns(m->origin, m->scene.model))
        scene_load_warn(m->o.usage->name, m->scene.model, q.si, q.drive);
    j->options = &m->o;
    j->identity = m->identity;
    j->columns = m->rows.header;
    j->copy = m->copy = options_given(&m->o, "out") ? NULL : tmpfile();
    return jobs_run(j);
}

/* All rows are there: of a run that is no share, and in a file or read to their end. */
static bool is_whole(const struct maps *m)
{
    bool share = strcmp(options_text(&m->o, "shard", 0), "1/1") != 0;
    return !share && (options_given(&m->o, "out") || (m->copy && !options_reader_left()));
}

static int load_rows(const struct maps *m, const char *path, struct rows_table *t)
{
    path = path ? path : options_text(&m->o, "out", 0);
    if (path)
        return rows_load(&m->o, &m->rows, path, t);
    rewind(m->copy);
    return rows_load_from(&m->o, &m->rows, "standard output", m->copy, t);
}

void maps_put_axis(struct figure *g, const struct scene_range *r)
{
    figure_axis(
        g, &(struct figure_axis){r->words, r->unit, r->values.from, r->values.to, r->values.logarithmic});
}

/* Each line of the summary is a paragraph. */
static void put_words(struct figure *g, const char *text)
{
    struct html *h = figure_page(g);
    for (size_t n; h && *text; text += n + (text[n] == '\n')) {
        n = strcspn(text, "\n");
        html_words(h, "%.*s", (int)n, text);
    }
}

static int write_figure(const struct maps *m, const struct rows_table *t, const struct maps_finding *what,
                        void *context, const char *summary)
{
    struct figure g;
    struct scene_point q;
    if (!options_given(&m->o, "svg") && !options_given(&m->o, "report"))
        return 0;
    int status = figure_begin(&g, &m->o, m->name);
    if (status)
        return status;
    if (!what->is_table)
        put_words(&g, summary);
    const char *why = what->draw(context, t, &g);
    g.why = g.why ? g.why : why;
    point_of_scene(&m->scene, &q);
    if (figure_page(&g))
        html_scene(figure_page(&g), &m->scene, m->scene.model, q.si);
    return figure_end(&g, &m->o);
}

static int conclude(const struct maps *m, const char *path, const struct rows_table *t,
                    const struct maps_finding *what, void *context)
{
    char *text = NULL;
    size_t size;
    int status = what->read ? what->read(context, t) : 0;
    FILE *f = status ? NULL : open_memstream(&text, &size);
    if (f)
        what->tell(context, t, f);
    if (!status && (!f || fclose(f)))
        status = options_failure(m->o.usage, "out of memory");
    status = status ? status : write_figure(m, t, what, context, text);
    if (!status)
        fputs(text, path ? stdout : options_summary(&m->o));
    free(text);
    return status;
}

int maps_conclude(const struct maps *m, const char *path, const struct maps_finding *what, void *context)
{
    struct rows_table t;
    if (!path && !is_whole(m))
        return 0;
    int status = load_rows(m, path, &t);
    status = status ? status : conclude(m, path, &t, what, context);
    rows_free(&t);
    return status;
}

const char *maps_in_words(double value, const char *unit, char *text)
{
    snprintf(text, UNIT_TEXT, "something not finite");
    if (isfinite(value))
        unit_tell(value, 6, unit, text);
    return text;
}
