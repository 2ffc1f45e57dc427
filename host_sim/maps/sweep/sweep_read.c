/* sweep_read.c - the command line of contactplant sweep. */
#include "host_sim/maps/sweep/sweep.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/observe/lockin.h"
#include "host_sim/maps/maps.h"
#include "host_sim/scene/scene_print.h"
#include "host_sim/cli/unit.h"
#include "models/models.h"

enum { POINTS_DEFAULT = 200, MEASURE_DEFAULT = 12, MULTIPLE_MAX = 4, WORD = 64 };
static const double tol_default = 1e-9;

#define misuse(s, ...) options_misuse((s)->o.usage, __VA_ARGS__)

/* ---- options ---- */

/* True when doubling this number of the scene doubles the frequency of the reference. */
static bool is_frequency(const struct scene *sc, const struct scene_range *r)
{
    double si[MODEL_PARAMETERS], value = scene_keys_value(sc, &r->key);
    struct harmonic before[MODEL_INPUTS], after[MODEL_INPUTS];
    struct scene other = *sc;
    int i = sweep_reference(sc);
    scene_range_set(&other, r, 2.0 * value);
    scenes_resolve(sc, si, before);
    scenes_resolve(&other, si, after);
    return value > 0.0 && fabs(after[i].omega - 2.0 * before[i].omega) <= 1e-9 * before[i].omega;
}

/* The frequency of the reference, from half to twice what the scene has. */
static int choose_range(const struct sweep *s, struct scene_range *r)
{
    for (int i = 0; scene_range_nth(&s->scene, i, r); i++) {
        if (r->key.kind != KEY_NUMBER || !is_frequency(&s->scene, r))
            continue;
        r->from = 0.5 * scene_keys_value(&s->scene, &r->key);
        r->to = 2.0 * scene_keys_value(&s->scene, &r->key);
        r->n = POINTS_DEFAULT;
        r->logarithmic = false;
        return 0;
    }
    return misuse(s, "which number is to be swept? give --sweep NAME=FROM:TO:N");
}

static int read_ranges(struct sweep *s)
{
    const char *range = options_text(&s->o, "sweep", 0), *family = options_text(&s->o, "family", 0);
    int status = family ? scene_range_read(s->o.usage, &s->scene, "family", family, &s->family) : 0;
    if (range && !status)
        status = scene_range_read(s->o.usage, &s->scene, "sweep", range, &s->range);
    if (status)
        return status;
    struct scene middle = s->scene; /* with what the ranges make sound */
    if (family)
        scene_range_set(&middle, &s->family, s->family.to);
    if (range)
        scene_range_set(&middle, &s->range, s->range.to);
    s->reference = range && s->range.input >= 0 ? s->range.input : sweep_reference(&middle);
    if (s->reference < 0)
        return misuse(s, "no drive sounds in this scene; give it one, --set INPUT.amplitude=A and --set "
                         "INPUT.frequency=F");
    status = range ? 0 : choose_range(s, &s->range);
    if (!status && family && s->family.key.offset == s->range.key.offset)
        return misuse(s, "--family and --sweep are both %s; take two different numbers", s->range.column);
    for (int i = 0; i < options_count(&s->o, "set") && !status; i++) {
        const char *text = options_text(&s->o, "set", i);
        struct scene_range r;
        status = scene_range_find(s->o.usage, &s->scene, text, strcspn(text, "="), &r);
        if (!status &&
            (r.key.offset == s->range.key.offset || (family && r.key.offset == s->family.key.offset)))
            return misuse(s, "--set %s: contradicts its range; give one of the two", text);
    }
    return status;
}

static uint32_t common_multiple(uint32_t a, uint32_t b)
{
    uint32_t m = a;
    while (m % b)
        m += a;
    return m;
}

/* 1,2,3,1/2 */
static int read_harmonics(struct sweep *s)
{
    const char *text = options_text(&s->o, "harmonics", 0), *at = text;
    s->common = 1;
    for (bool more = true; more; s->n_harmonics++) {
        unsigned n = 0, m = 1;
        int used = 0, more_used = 0;
        if (!isdigit((unsigned char)*at) || sscanf(at, "%2u%n/%2u%n", &n, &used, &m, &more_used) < 1 ||
            n < 1 || m < 1 || m > MULTIPLE_MAX || s->n_harmonics == SWEEP_HARMONICS)
            return misuse(s, "--harmonics %s: up to %d numbers n or n/m above 0, m up to %d, with commas",
                          text, SWEEP_HARMONICS, MULTIPLE_MAX);
        at += more_used > used ? more_used : used;
        more = *at == ',';
        if (*at && !more)
            return misuse(s, "--harmonics %s: write for instance 1,2,1/2", text);
        at += more;
        s->harmonic[s->n_harmonics] = (struct sweep_harmonic){n, m};
        s->common = common_multiple(s->common, m);
    }
    for (int i = 1; i < s->n_harmonics; i++)
        for (int k = 0; k < i; k++)
            if (s->harmonic[i].n * s->harmonic[k].m == s->harmonic[k].n * s->harmonic[i].m)
                return misuse(s, "--harmonics %s: one is there twice; give it once", text);
    for (int i = 0; i < s->n_harmonics; i++)
        if (s->harmonic[i].n * (s->common / s->harmonic[i].m) > LOCKIN_HARMONICS)
            return misuse(s, "--harmonics %s: up to %g times the reference together", text,
                          (double)LOCKIN_HARMONICS / s->common);
    return 0;
}

static int read_periods(struct sweep *s)
{
    s->settle = options_given(&s->o, "settle") ? (int)options_number(&s->o, "settle") : -1;
    s->bracket = options_number(&s->o, "bracket");
    int half = 2 * (int)s->common, least = (MEASURE_DEFAULT + half - 1) / half * half;
    s->measure = options_given(&s->o, "measure") ? (int)options_number(&s->o, "measure") : least;
    if (s->measure % half || s->measure < 2 * half)
        return misuse(s, "--measure %d: for these harmonics a multiple of %d, at least %d", s->measure, half,
                      2 * half);
    return 0;
}

static int read_method(struct sweep *s)
{
    const char *name = options_given(&s->o, "method") ? options_text(&s->o, "method", 0) : s->scene.method;
    s->method = method_find(name);
    s->tol =
        options_given(&s->o, "tol") ? options_number(&s->o, "tol") : fmin(s->scene.tolerance, tol_default);
    if (!s->method)
        return misuse(s, "%s: no such method; contactplant list shows them", name);
    s->work = calloc(s->method->n_work(s->scene.model) + 1, sizeof *s->work);
    return s->work ? 0 : options_failure(s->o.usage, "no memory");
}

/* ---- what goes together ---- */

static int check_noise(const struct sweep *s, const struct scene *sc)
{
    for (int i = 0; i < sc->model->n_inputs; i++)
        if (sc->drive[i].noise > 0.0)
            return misuse(s, "this scene has noise on %s and never settles; take the noise out",
                          sc->model->input_signal[i].name);
    return 0;
}

static int check_ends(struct sweep *s)
{
    int input = s->range.input;
    bool silent = input >= 0;
    for (int i = 0; i < 4; i++) {
        struct scene sc = s->scene;
        char text[UNIT_TEXT];
        double value = i % 2 ? s->range.to : s->range.from;
        if (s->family.n)
            scene_range_set(&sc, &s->family, i / 2 ? s->family.to : s->family.from);
        scene_range_set(&sc, &s->range, value);
        silent = silent && sc.drive[input].amplitude == 0.0;
        int status = check_noise(s, &sc);
        if (status)
            return status;
        const char *why = sweep_check(s, &sc);
        unit_write(value, s->range.key.unit, text);
        if (why)
            return misuse(s, "at %s = %s: %s", s->range.column, text, why);
    }
    if (!silent)
        return 0;
    const char *name = s->scene.model->input_signal[input].name;
    return misuse(s, "%s is silent, and its %s changes nothing; give it an amplitude: --set %s.amplitude=..",
                  name, s->range.column, name);
}

/* ---- what the file says ---- */

static void name_columns(struct sweep *s)
{
    const struct signal *y = &s->scene.model->output_signal[(int)s->scene.observable];
    bool plain = scenes_dimensionless(&s->scene);
    char unit[WORD], *c = s->columns;
    scene_range_spell(unit, sizeof unit, "", plain ? "" : y->unit);
    size_t size = sizeof s->columns, n = (size_t)snprintf(c, size, "kind,direction");
    if (s->family.n)
        n += (size_t)snprintf(c + n, size - n, ",%s", s->family.column);
    n += (size_t)snprintf(c + n, size - n, ",%s", s->range.column);
    for (int i = 0; i < s->n_harmonics; i++) {
        char name[WORD];
        const struct sweep_harmonic *h = &s->harmonic[i];
        int length = snprintf(name, sizeof name, "%u", (unsigned)h->n);
        if (h->m > 1)
            snprintf(name + length, sizeof name - (size_t)length, "/%u", (unsigned)h->m);
        n += (size_t)snprintf(c + n, size - n, ",amplitude_%s%s,phase_%s_rad", name, unit, name);
    }
    n += (size_t)snprintf(c + n, size - n,
                          ",mean%s,lowest%s,highest%s,out_of_contact,peak_force%s,settled,unlocated", unit,
                          unit, unit, plain ? "" : "_N");
    for (int i = 0; i < s->scene.model->n_states; i++) {
        char name[WORD];
        const struct signal *x = &s->scene.model->state_signal[i];
        scene_range_spell(name, sizeof name, x->name, plain ? "" : x->unit);
        n += (size_t)snprintf(c + n, size - n, ",end_%s", name);
    }
    snprintf(c + n, size - n, ",end_phases");
}

static int name_run(struct sweep *s)
{
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    if (!f)
        return options_failure(s->o.usage, "no memory");
    scene_print(f, "sweep 3", &s->scene);
    scene_range_print(f, &s->range);
    scene_range_print(f, &s->family);
    fprintf(f, "%s %.17g %d %d %.17g %s\n", s->method->name, s->tol, s->settle, s->measure, s->bracket,
            s->columns);
    if (fclose(f))
        return options_failure(s->o.usage, "no memory");
    s->identity = text;
    return 0;
}

int sweep_read(struct sweep *s)
{
    char why[SCENE_REASON];
    s->origin = scene_load_cold(s->o.n_words ? s->o.word[0] : model_table[0]->name, &s->scene, why);
    if (s->origin == SCENE_OF_NOTHING)
        return misuse(s, "%s", why);
    int status = scene_range_settings(&s->o, &s->scene);
    status = status ? status : check_noise(s, &s->scene);
    status = status ? status : read_ranges(s);
    status = status ? status : read_harmonics(s);
    status = status ? status : read_periods(s);
    status = status ? status : read_method(s);
    status = status ? status : check_ends(s);
    status = status ? status : maps_check_files(&s->o, s->origin);
    if (status)
        return status;
    name_columns(s);
    return name_run(s);
}
