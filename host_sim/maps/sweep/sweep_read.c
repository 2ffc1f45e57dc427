/* sweep_read.c - see sweep_read.h. */
#include "host_sim/maps/sweep/sweep_read.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/observe/lockin.h"
#include "host_sim/cli/unit.h"
#include "host_sim/maps/sweep/sweep_point.h"

enum { POINTS_DEFAULT = 200, MEASURE_DEFAULT = 12, MULTIPLE_MAX = 4, WORD = 64 };
static const double tol_default = 1e-9;

#define misuse(s, ...) options_misuse((s)->m.o.usage, __VA_ARGS__)

/* ---- options ---- */

/* The frequency of the reference, from half to twice what the scene has. */
static int choose_range(const struct sweep *s, struct scene_range *r)
{
    double factor;
    if (!maps_find_drive_number(&s->m.scene, sweep_reference(&s->m.scene), true, r, &factor))
        return misuse(s, "which number is to be swept? give --sweep NAME=FROM:TO:N");
    double value = scene_keys_value(&s->m.scene, &r->key);
    r->values = (struct range){0.5 * value, 2.0 * value, POINTS_DEFAULT, false};
    return 0;
}

static int read_ranges(struct sweep *s)
{
    const char *range = options_text(&s->m.o, "sweep", 0), *family = options_text(&s->m.o, "family", 0);
    int status = family ? scene_range_read(s->m.o.usage, &s->m.scene, "family", family, &s->family) : 0;
    if (range && !status)
        status = scene_range_read(s->m.o.usage, &s->m.scene, "sweep", range, &s->range);
    if (status)
        return status;
    struct scene middle = s->m.scene; /* with the drives that the ranges make sound */
    if (family)
        scene_range_set(&middle, &s->family, s->family.values.to);
    if (range)
        scene_range_set(&middle, &s->range, s->range.values.to);
    s->reference = range && s->range.input >= 0 ? s->range.input : sweep_reference(&middle);
    if (s->reference < 0)
        return misuse(s, "no drive sounds in this scene; give it one, --set INPUT.amplitude=A and --set "
                         "INPUT.frequency=F");
    status = range ? 0 : choose_range(s, &s->range);
    if (!status && family && s->family.key.offset == s->range.key.offset)
        return misuse(s, "--family and --sweep are both %s; take two different numbers", s->range.column);
    for (int i = 0; i < options_count(&s->m.o, "set") && !status; i++) {
        const char *text = options_text(&s->m.o, "set", i);
        struct scene_range r;
        status = scene_range_find(s->m.o.usage, &s->m.scene, text, strcspn(text, "="), NULL, &r);
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
    const char *text = options_text(&s->m.o, "harmonics", 0), *at = text;
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
    s->settle = options_given(&s->m.o, "settle") ? (int)options_number(&s->m.o, "settle") : -1;
    s->bracket = options_number(&s->m.o, "bracket");
    int half = 2 * (int)s->common, least = (MEASURE_DEFAULT + half - 1) / half * half;
    s->measure = options_given(&s->m.o, "measure") ? (int)options_number(&s->m.o, "measure") : least;
    if (s->measure % half || s->measure < 2 * half)
        return misuse(s, "--measure %d: for these harmonics a multiple of %d, at least %d", s->measure, half,
                      2 * half);
    return 0;
}

/* ---- conditions ---- */

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
        struct scene sc = s->m.scene;
        char text[UNIT_TEXT];
        double value = i % 2 ? s->range.values.to : s->range.values.from;
        if (s->family.values.n)
            scene_range_set(&sc, &s->family, i / 2 ? s->family.values.to : s->family.values.from);
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
    const char *name = s->m.scene.model->input_signal[input].name;
    return misuse(s, "%s is silent, and its %s changes nothing; give it an amplitude: --set %s.amplitude=..",
                  name, s->range.column, name);
}

/* ---- rows ---- */

#define AT(member) offsetof(struct sweep_result, member)

static const char *const kinds[] = {"point",   "unsettled",      "escaped",     "jump_from",
                                    "jump_to", "jump_unsettled", "jump_chance", NULL};
static const char *const directions[] = {"up", "down", NULL};

static void add_harmonics(struct sweep *s, const char *unit)
{
    const struct rows_column amplitude = {"amplitude_", unit, "of a harmonic",
                                          ROWS_NUMBER,  12,   .offset = AT(measured.amplitude)};
    const struct rows_column phase = {"phase_",    "rad", "of a harmonic",
                                      ROWS_NUMBER, 12,    .offset = AT(measured.phase)};
    for (int i = 0; i < s->n_harmonics; i++) {
        char name[WORD];
        const struct sweep_harmonic *h = &s->harmonic[i];
        snprintf(name, sizeof name, h->m > 1 ? "%u/%u" : "%u", (unsigned)h->n, (unsigned)h->m);
        rows_add_item(&s->m.rows, &amplitude, i, name);
        rows_add_item(&s->m.rows, &phase, i, name);
    }
}

static void describe_rows(struct sweep *s)
{
    const struct model *m = s->m.scene.model;
    struct rows *t = &s->m.rows;
    bool plain = scenes_dimensionless(&s->m.scene);
    const char *unit = plain ? "" : m->output_signal[(int)s->m.scene.observable].unit;
    const struct rows_column row[] = {
        {"kind", "", "what the row is of", ROWS_WORD, .offset = AT(kind), .words = kinds},
        {"direction", "", "of the sweep", ROWS_WORD, .offset = AT(down), .words = directions},
        {s->family.column, "", "a curve each", ROWS_NUMBER, 12, .offset = AT(family)},
        {s->range.column, "", "swept", ROWS_NUMBER, 0, .offset = AT(value)},
    };
    const struct rows_column result[] = {
        {"mean", unit, "of the observable", ROWS_NUMBER, 12, .offset = AT(measured.mean)},
        {"lowest", unit, "of the observable", ROWS_NUMBER, 12, .offset = AT(measured.lowest)},
        {"highest", unit, "of the observable", ROWS_NUMBER, 12, .offset = AT(measured.highest)},
        {"out_of_contact", "", "fraction of time out of contact", ROWS_NUMBER, 12,
         .offset = AT(measured.out_of_contact)},
        {"peak_force", plain ? "" : "N", "peak contact force", ROWS_NUMBER, 12,
         .offset = AT(measured.peak_force)},
        {"settled", "", "what is left to come", ROWS_NUMBER, 3, .offset = AT(settled)},
        {"unlocated", "", "switches that were run through", ROWS_NUMBER, 10, .offset = AT(unlocated)},
        {"motions", "", "that the sweep could be on by chance", ROWS_NUMBER, 3, .offset = AT(motions)},
    };
    const struct rows_column phases = {
        "end_phases", "", "of the drives", ROWS_TURNS, .offset = AT(end.phase), .count = m->n_inputs};
    rows_begin(t, sizeof(struct sweep_result));
    for (int i = 0; i < 4; i++)
        if (i != 2 || s->family.values.n)
            rows_add(t, &row[i]);
    t->n_given = t->n;
    add_harmonics(s, unit);
    for (size_t i = 0; i < sizeof result / sizeof result[0]; i++)
        rows_add(t, &result[i]);
    for (int i = 0; i < m->n_states; i++) {
        const struct rows_column end = {"end_",    plain ? "" : m->state_signal[i].unit,
                                        "a state", ROWS_NUMBER,
                                        17,        .offset = AT(end.shown)};
        rows_add_item(t, &end, i, scenes_state_name(&s->m.scene, i));
    }
    rows_add(t, &phases);
}

static bool say(const void *context, const char *option, FILE *f)
{
    const struct sweep *s = context;
    if (!strcmp(option, "sweep"))
        scene_range_print(f, &s->range);
    else if (!strcmp(option, "family"))
        scene_range_print(f, &s->family);
    else if (!strcmp(option, "settle"))
        fprintf(f, "%d", s->settle);
    else if (!strcmp(option, "measure"))
        fprintf(f, "%d", s->measure);
    else
        return false;
    return true;
}

int sweep_read(struct sweep *s)
{
    int status = maps_load(&s->m);
    status = status ? status : check_noise(s, &s->m.scene);
    status = status ? status : read_ranges(s);
    status = status ? status : read_harmonics(s);
    status = status ? status : read_periods(s);
    status = status ? status : maps_load_method(&s->m, tol_default);
    if (status)
        return status;
    s->scratch = calloc(s->m.method->n_scratch(s->m.scene.model) + 1, sizeof *s->scratch);
    status = s->scratch ? check_ends(s) : options_failure(s->m.o.usage, "out of memory");
    status = status ? status : maps_check_files(&s->m, options_text(&s->m.o, "out", 0));
    describe_rows(s);
    return status ? status : maps_identify(&s->m, "sweep 5", say, s);
}
