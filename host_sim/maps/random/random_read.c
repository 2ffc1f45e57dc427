/* random_read.c - see random_read.h. */
#include "host_sim/cli/options_nearest.h"
#include "host_sim/maps/random/random_read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/maps/random/random_realise.h"
#include "host_sim/scene/scene_check.h"

#define misuse(r, ...) options_misuse((r)->m.o.usage, __VA_ARGS__)

/* The default range: so many standard deviations to each side of the mean. Its ends are multiples of a
 * tenth of their decade. */
static const double wide = 6.0;

static const char *unit_of(const struct random_runs *r)
{
    const struct signal *y = &r->m.scene.model->output_signal[(int)r->m.scene.observable];
    return scenes_dimensionless(&r->m.scene) ? "" : y->unit;
}

static int read_observable(struct random_runs *r)
{
    const struct model *m = r->m.scene.model;
    const char *name = options_text(&r->m.o, "observable", 0), *names[MODEL_OUTPUTS];
    for (int i = 0; i < m->n_outputs; i++) {
        names[i] = m->output_signal[i].name;
        if (!name || model_same_name(name, names[i])) {
            r->m.scene.observable = name ? i : r->m.scene.observable;
            return 0;
        }
    }
    return misuse(r, "--observable %s: no such output%s", name,
                  options_advise(name, strlen(name), names, m->n_outputs, NULL));
}

static int check_noise(const struct random_runs *r)
{
    const struct scene *s = &r->m.scene;
    char why[SCENE_CHECK_REASON];
    bool any = false;
    for (int i = 0; i < s->model->n_inputs; i++)
        any |= s->drive[i].noise > 0.0;
    if (!any)
        return misuse(r, "no input of this scene has noise; give it one, --set INPUT.noise=A");
    return scene_check(s, why) ? misuse(r, "this scene with these options: %s", why) : 0;
}

/* Long enough that the damping leaves 1e-2 of the start, and 1e-4 in a mean square; at most ten times as
 * long as the measurement. */
static double settling(const struct random_runs *r)
{
    static const double falls = 4.6;
    struct scene_point q;
    point_of_scene(&r->m.scene, &q);
    double rate = 0.5 * maps_damping(r->m.scene.model, q.p) / q.scale.time_s;
    double enough = rate > 0.0 ? falls / rate : HUGE_VAL;
    return fmin(fmax(enough, 0.1 * r->over), 10.0 * r->over);
}

static int read_times(struct random_runs *r)
{
    r->over = r->m.scene.over;
    int status = maps_read_time(&r->m, "over", &r->over);
    r->m.scene.over = r->over;
    if (!options_given(&r->m.o, "settle") && !status)
        r->settle = settling(r);
    status = status ? status : maps_read_time(&r->m, "settle", &r->settle);
    if (!status && r->over < 3.0 * scene_check_step(&r->m.scene))
        return misuse(r, "--over is shorter than three steps of %g; give more",
                      scene_check_step(&r->m.scene));
    return status;
}

static int read_range(struct random_runs *r)
{
    const char *text = options_text(&r->m.o, "range", 0);
    const struct range_rules rules = {
        .unit = unit_of(r), .bare = true, .min = -HUGE_VAL, .max = HUGE_VAL, .order = RANGE_UPWARDS};
    struct range range;
    char why[RANGE_REASON];
    if (!range_read(text, &rules, &range, why))
        return misuse(r, "--range %s: %s", text, why);
    r->low = range.from;
    r->high = range.to;
    return 0;
}

/* Finds a range from a fifth of the first realisation. */
static int choose_range(struct random_runs *r)
{
    static double row[RANDOM_BIN + 2 * RANDOM_BINS + 2];
    r->low = -1.0;
    r->high = 1.0; /* a middle of 0, for the mean square */
    const char *why = random_realise(r, 0, 0.2 * r->over, row);
    if (why)
        return misuse(r, "%s", why);
    double mean = row[RANDOM_MEAN], deviation = sqrt(row[RANDOM_SQUARE] - mean * mean);
    if (!(row[RANDOM_FINITE] > 0.0 && deviation > 1e-9 * fabs(mean)))
        return misuse(r, "the first realisation escapes, or does not move; give --range LOW:HIGH");
    double grain = pow(10.0, floor(log10(wide * deviation)) - 1.0);
    r->low = floor((mean - wide * deviation) / grain) * grain;
    r->high = ceil((mean + wide * deviation) / grain) * grain;
    return 0;
}

#define AT(i) ((i) * sizeof(double))

static const struct rows_column fixed[] = {
    {"realisation", "", "its number", ROWS_NUMBER, 9, .offset = AT(RANDOM_SEED)},
    {"finite", "", "1, or 0 where the motion escaped and the rest are zeros", ROWS_NUMBER, 9,
     .offset = AT(RANDOM_FINITE)},
    {"mean", "", "of the observable", ROWS_NUMBER, 9, .offset = AT(RANDOM_MEAN)},
    {"mean_square", "", "about the middle of the range", ROWS_NUMBER, 9, .offset = AT(RANDOM_SQUARE)},
    {"out_of_contact", "", "share of time with every contact open", ROWS_NUMBER, 9,
     .offset = AT(RANDOM_OPEN)},
    {"touchdown_rate", "", "touchdowns per time", ROWS_NUMBER, 9, .offset = AT(RANDOM_TOUCHES)},
    {"below", "", "share of time below the range", ROWS_NUMBER, 9, .offset = AT(RANDOM_BELOW)},
};
static const struct rows_column bin_column = {"bin_",      "", "share of time",
                                              ROWS_NUMBER, 9,  .offset = AT(RANDOM_BIN)};

static void describe_rows(struct random_runs *r)
{
    struct rows *t = &r->m.rows;
    const struct rows_column above = {"above",     "", "share of time",
                                      ROWS_NUMBER, 9,  .offset = AT(RANDOM_BIN + r->n_bins)};
    const struct rows_column up = {"up_",       "", "up-crossings per time",
                                   ROWS_NUMBER, 9,  .offset = AT(RANDOM_BIN + r->n_bins + 1)};
    char item[16];
    rows_begin(t, AT(random_columns(r)));
    for (size_t i = 0; i < sizeof fixed / sizeof fixed[0]; i++)
        rows_add(t, &fixed[i]);
    for (int i = 0; i < r->n_bins; i++) {
        snprintf(item, sizeof item, "%d", i + 1);
        rows_add_item(t, &bin_column, i, item);
    }
    rows_add(t, &above);
    for (int i = 0; i <= r->n_bins; i++) {
        snprintf(item, sizeof item, "%d", i);
        rows_add_item(t, &up, i, item);
    }
}

static bool say(const void *context, const char *option, FILE *f)
{
    const struct random_runs *r = context;
    if (!strcmp(option, "over"))
        fprintf(f, "%.17g", r->over);
    else if (!strcmp(option, "settle"))
        fprintf(f, "%.17g", r->settle);
    else if (!strcmp(option, "range"))
        fprintf(f, "%.17g %.17g", r->low, r->high);
    else if (!strcmp(option, "observable"))
        fputs(r->m.scene.model->output_signal[(int)r->m.scene.observable].name, f);
    else
        return false;
    return true;
}

int random_read(struct random_runs *r)
{
    r->n = (int)options_number(&r->m.o, "seeds");
    r->n_bins = (int)options_number(&r->m.o, "bins");
    int status = maps_load(&r->m);
    status = status ? status : maps_load_method(&r->m, METHOD_TOL_MAX);
    if (status)
        return status;
    r->m.scene.method = r->m.method->name;
    r->m.scene.tolerance = r->m.tol;
    status = read_observable(r);
    status = status ? status : read_times(r);
    status = status ? status : check_noise(r);
    status = status ? status : maps_check_files(&r->m, options_text(&r->m.o, "out", 0));
    if (status)
        return status;
    r->scratch = calloc(r->m.method->n_scratch(r->m.scene.model) + 1, sizeof *r->scratch);
    if (!r->scratch)
        return options_failure(r->m.o.usage, "out of memory");
    status = options_given(&r->m.o, "range") ? read_range(r) : choose_range(r);
    describe_rows(r);
    return status ? status : maps_identify(&r->m, "random", say, r);
}
