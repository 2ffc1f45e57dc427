/* random_read.c - the command line of contactplant random. */
#include "host_sim/maps/random/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/scene/scene_check.h"
#include "host_sim/scene/scene_print.h"
#include "host_sim/scene/scene_range.h"
#include "host_sim/cli/unit.h"

#define misuse(r, ...) options_misuse((r)->o.usage, __VA_ARGS__)

/* Of the default range, in standard deviations to each side of the mean; its ends are multiples of a tenth of their decade. */
static const double wide = 6.0;

static const char *unit_of(const struct random_runs *r)
{
    const struct signal *y = &r->m.scene.model->output_signal[(int)r->m.scene.observable];
    return scenes_dimensionless(&r->m.scene) ? "" : y->unit;
}

static int read_observable(struct random_runs *r)
{
    const struct model *m = r->m.scene.model;
    const char *name = options_text(&r->o, "observable", 0), *names[MODEL_OUTPUTS];
    for (int i = 0; i < m->n_outputs; i++) {
        names[i] = m->output_signal[i].name;
        if (!name || model_same_name(name, names[i])) {
            r->m.scene.observable = name ? i : r->m.scene.observable;
            return 0;
        }
    }
    const char *nearest = options_nearest(name, names, m->n_outputs);
    return misuse(r, "--observable %s: no such output; did you mean %s?", name, nearest ? nearest : names[0]);
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

/* Until the damping leaves 1e-2 of the start, in a mean square 1e-4; of one that is hardly damped ten
 * times as long as it is looked at. */
static double settling(const struct random_runs *r)
{
    static const double falls = 4.6;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    scenes_resolve(&r->m.scene, si, drive);
    r->m.scene.model->prepare(si, p, &scale);
    double rate = 0.5 * maps_damping(r->m.scene.model, p) / scale.time_s;
    double enough = rate > 0.0 ? falls / rate : HUGE_VAL;
    return fmin(fmax(enough, 0.1 * r->over), 10.0 * r->over);
}

static int read_times(struct random_runs *r)
{
    r->over = r->m.scene.over;
    int status = maps_read_time(&r->o, "over", &r->m.scene, &r->over);
    r->m.scene.over = r->over;
    if (!options_given(&r->o, "settle") && !status)
        r->settle = settling(r);
    status = status ? status : maps_read_time(&r->o, "settle", &r->m.scene, &r->settle);
    if (!status && r->over < 3.0 * scene_check_step(&r->m.scene))
        return misuse(r, "--over is shorter than three steps of %g; give more",
                      scene_check_step(&r->m.scene));
    return status;
}

/* LOW:HIGH */
static int read_range(struct random_runs *r)
{
    const char *text = options_text(&r->o, "range", 0), *colon = strchr(text, ':');
    char why[UNIT_REASON], ignored[UNIT_REASON];
    if (!colon)
        return misuse(r, "--range %s: write LOW:HIGH", text);
    for (int i = 0; i < 2; i++) {
        const char *part = i ? colon + 1 : text;
        size_t n = i ? strlen(part) : (size_t)(colon - text);
        double *value = i ? &r->high : &r->low;
        if (!unit_read(part, n, unit_of(r), value, why) && !unit_read(part, n, "", value, ignored))
            return misuse(r, "--range %s: %s", text, why);
    }
    return r->low < r->high ? 0 : misuse(r, "--range %s: the lower end comes first", text);
}

/* The range from a fifth of the first realisation. */
static int choose_range(struct random_runs *r)
{
    static double row[RANDOM_BIN + 2 * RANDOM_BINS + 2];
    r->low = -1.0;
    r->high = 1.0; /* the middle of 0, for the mean square */
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

static int name_run(struct random_runs *r)
{
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size), *c = fmemopen(r->columns, sizeof r->columns, "w");
    if (!f || !c)
        return options_failure(r->o.usage, "no memory");
    fprintf(c, "realisation,finite,mean,mean_square,out_of_contact,touchdown_rate,below");
    for (int i = 0; i < r->n_bins; i++)
        fprintf(c, ",bin_%d", i + 1);
    fprintf(c, ",above");
    for (int i = 0; i <= r->n_bins; i++)
        fprintf(c, ",up_%d", i);
    scene_print(f, "random", &r->m.scene);
    fprintf(f, "%s %.17g %.17g %.17g %d %d %.17g %.17g\n", r->m.method->name, r->m.tol, r->over, r->settle,
            r->n, r->n_bins, r->low, r->high);
    if (fclose(f) | fclose(c))
        return options_failure(r->o.usage, "no memory");
    r->identity = text;
    return 0;
}

int random_read(struct random_runs *r)
{
    r->n = (int)options_number(&r->o, "seeds");
    r->n_bins = (int)options_number(&r->o, "bins");
    int status = maps_load(&r->o, &r->m);
    status = status ? status : read_observable(r);
    status = status ? status : read_times(r);
    status = status ? status : check_noise(r);
    status = status ? status : maps_check_files(&r->o, r->m.origin);
    if (status)
        return status;
    r->work = calloc(r->m.method->n_work(r->m.scene.model) + 1, sizeof *r->work);
    if (!r->work)
        return options_failure(r->o.usage, "no memory");
    status = options_given(&r->o, "range") ? read_range(r) : choose_range(r);
    return status ? status : name_run(r);
}
