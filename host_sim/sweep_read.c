/* sweep_read.c - the command line of contactplant sweep. */
#include "host_sim/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/lockin.h"
#include "host_sim/scene_print.h"
#include "host_sim/unit.h"
#include "models/models.h"

enum { POINTS_DEFAULT = 200, MEASURE_DEFAULT = 12, MULTIPLE_MAX = 4, WORD = 64, PARTS = 4 };
static const double tol_default = 1e-9;

#define misuse(s, ...) options_misuse((s)->o.usage, __VA_ARGS__)

/* ---- names ---- */

static void spell(char *text, size_t size, const char *name, const char *unit)
{
    size_t n = (size_t)snprintf(text, size, "%s%s", name, *unit && strcmp(unit, "1") ? "_" : "");
    for (const char *c = strcmp(unit, "1") ? unit : ""; *c && n + 6 < size; c++)
        n += (size_t)snprintf(text + n, size - n, *c == '/' ? "_per_" : *c == ' ' ? "_" : "%c", *c);
}

static bool is_key(const struct scene_key *k, const char *name, size_t n)
{
    return k->kind == KEY_NUMBER && ((strlen(k->name) == n && !strncmp(k->name, name, n)) ||
                                     (strlen(k->full) == n && !strncmp(k->full, name, n)));
}

/* Key i of all that can be swept: parameters, then each input's. False when there are no more. */
static bool nth_key(const struct scene *sc, int i, struct sweep_range *r)
{
    enum scene_section section = sc->paper ? SECTION_PAPER : SECTION_PLANT;
    struct scene_key *k = &r->key;
    r->input = -1;
    int n = 0;
    for (; scene_keys_get(sc, section, 0, n, k); n++)
        if (n == i)
            return true;
    for (r->input = 0; r->input < sc->model->n_inputs; r->input++)
        for (int index = 0; scene_keys_get(sc, SECTION_DRIVE, r->input, index, k); index++, n++)
            if (n == i)
                return true;
    return false;
}

/* The number of the scene that is called this: "damping", "force.frequency". */
static int find_key(const struct sweep *s, const char *name, size_t n, struct sweep_range *r)
{
    enum { KEYS = 2 * MODEL_PARAMETERS + 8 * MODEL_INPUTS };
    static char text[KEYS][WORD];
    const char *names[KEYS];
    char own[WORD];
    int count = 0;
    for (int i = 0; nth_key(&s->scene, i, r); i++) {
        const char *input = r->input < 0 ? "" : s->scene.model->input_signal[r->input].name;
        size_t skip = r->input < 0 ? 0 : strlen(input) + 1;
        bool here = !skip || (n > skip && !strncmp(name, input, skip - 1) && name[skip - 1] == '.');
        if (r->key.kind != KEY_NUMBER || !strncmp(r->key.name, "noise", 5))
            continue;
        snprintf(text[count], WORD, "%s%s%s", input, skip ? "." : "", r->key.name);
        names[count] = text[count];
        if (here && is_key(&r->key, name + skip, n - skip)) {
            char full[SWEEP_NAME];
            snprintf(full, sizeof full, "%s%s%s", input, skip ? "." : "", skip ? r->key.name : r->key.full);
            spell(r->column, sizeof r->column, full, skip ? r->key.unit : "");
            return 0;
        }
        count++;
    }
    snprintf(own, sizeof own, "%.*s", (int)n, name);
    const char *nearest = options_nearest(own, names, count);
    return misuse(s, "%s: no such number in this scene; did you mean %s?", own, nearest ? nearest : names[0]);
}

/* A number with its unit, or in the unit of the table without one. */
static int read_number(const struct sweep *s, const struct sweep_range *r, const char *text, size_t n,
                       double *value)
{
    char why[UNIT_REASON], ignored[UNIT_REASON];
    const struct scene_key *k = &r->key;
    const char *blank = *k->unit ? " " : "";
    while (n && *text == ' ')
        text++, n--;
    if (!unit_read(text, n, k->unit, value, why) && !unit_read(text, n, "", value, ignored))
        return misuse(s, "%s: %s", r->column, why);
    if (!(*value >= k->min && *value <= k->max))
        return misuse(s, "%s: %.*s is out of range; give %g to %g%s%s", r->column, (int)n, text, k->min,
                      k->max, blank, k->unit);
    return 0;
}

void sweep_set(struct scene *sc, const struct sweep_range *r, double value)
{
    memcpy((char *)sc + r->key.offset, &value, sizeof value);
}

/* ---- options ---- */

static int read_settings(struct sweep *s)
{
    for (int i = 0; i < options_count(&s->o, "set"); i++) {
        const char *text = options_text(&s->o, "set", i), *equal = strchr(text, '=');
        struct sweep_range r;
        double value;
        if (!equal)
            return misuse(s, "--set %s: write NAME=VALUE", text);
        int status = find_key(s, text, (size_t)(equal - text), &r);
        status = status ? status : read_number(s, &r, equal + 1, strlen(equal + 1), &value);
        if (status)
            return status;
        sweep_set(&s->scene, &r, value);
    }
    return 0;
}

/* NAME=FROM:TO:N or NAME=FROM:TO:N:log */
static int read_range(const struct sweep *s, const char *option, const char *text, struct sweep_range *r)
{
    const char *equal = strchr(text, '='), *part[PARTS];
    size_t length[PARTS];
    char count[WORD];
    double n;
    int parts = 0, status;
    for (const char *at = equal; at && parts < PARTS;
         at = at[1 + length[parts - 1]] == ':' ? at + 1 + length[parts - 1] : NULL) {
        part[parts] = at + 1;
        length[parts++] = strcspn(at + 1, ":");
    }
    bool logarithmic = parts == 4 && !strcmp(part[3], "log");
    if (parts < 3 || (parts == 4 && !logarithmic))
        return misuse(s, "--%s %s: write NAME=FROM:TO:N, or NAME=FROM:TO:N:log", option, text);
    status = find_key(s, text, (size_t)(equal - text), r);
    status = status ? status : read_number(s, r, part[0], length[0], &r->from);
    status = status ? status : read_number(s, r, part[1], length[1], &r->to);
    if (status)
        return status;
    snprintf(count, sizeof count, "%.*s", (int)length[2], part[2]);
    if (!options_read_number(count, &n) || !(n >= 2.0 && n <= SWEEP_POINTS) || n != floor(n))
        return misuse(s, "--%s %s: N is a whole number of values, 2 to %d", option, text, SWEEP_POINTS);
    if (!(r->from < r->to))
        return misuse(s, "--%s %s: give the smaller end first; both directions are run", option, text);
    if (logarithmic && !(r->from > 0.0))
        return misuse(s, "--%s %s: a logarithmic range begins above 0", option, text);
    r->n = (int)n;
    r->logarithmic = logarithmic;
    return 0;
}

/* True when doubling this number of the scene doubles the frequency of the reference. */
static bool is_frequency(const struct scene *sc, const struct sweep_range *r)
{
    double si[MODEL_PARAMETERS], value = scene_keys_value(sc, &r->key);
    struct harmonic before[MODEL_INPUTS], after[MODEL_INPUTS];
    struct scene other = *sc;
    int i = sweep_reference(sc);
    sweep_set(&other, r, 2.0 * value);
    scenes_resolve(sc, si, before);
    scenes_resolve(&other, si, after);
    return value > 0.0 && fabs(after[i].omega - 2.0 * before[i].omega) <= 1e-9 * before[i].omega;
}

/* The frequency of the reference, from half to twice what the scene has. */
static int choose_range(const struct sweep *s, struct sweep_range *r)
{
    for (int i = 0; nth_key(&s->scene, i, r); i++) {
        if (r->key.kind != KEY_NUMBER || !is_frequency(&s->scene, r))
            continue;
        const char *input = r->input < 0 ? "" : s->scene.model->input_signal[r->input].name;
        char name[SWEEP_NAME];
        int n = snprintf(name, sizeof name, "%s%s%s", input, r->input < 0 ? "" : ".", r->key.name);
        int status = find_key(s, name, (size_t)n, r);
        r->from = 0.5 * scene_keys_value(&s->scene, &r->key);
        r->to = 2.0 * scene_keys_value(&s->scene, &r->key);
        r->n = POINTS_DEFAULT;
        return status;
    }
    return misuse(s, "which number is to be swept? give --sweep NAME=FROM:TO:N");
}

static int read_ranges(struct sweep *s)
{
    const char *range = options_text(&s->o, "sweep", 0), *family = options_text(&s->o, "family", 0);
    int status = family ? read_range(s, "family", family, &s->family) : 0;
    if (range && !status)
        status = read_range(s, "sweep", range, &s->range);
    if (status)
        return status;
    struct scene middle = s->scene; /* with what the ranges make sound */
    if (family)
        sweep_set(&middle, &s->family, s->family.to);
    if (range)
        sweep_set(&middle, &s->range, s->range.to);
    s->reference = range && s->range.input >= 0 ? s->range.input : sweep_reference(&middle);
    if (s->reference < 0)
        return misuse(s, "no drive sounds in this scene; give it one, --set INPUT.amplitude=A and --set "
                         "INPUT.frequency=F");
    status = range ? 0 : choose_range(s, &s->range);
    if (!status && family && s->family.key.offset == s->range.key.offset)
        return misuse(s, "--family and --sweep are both %s; take two different numbers", s->range.column);
    for (int i = 0; i < options_count(&s->o, "set") && !status; i++) {
        const char *text = options_text(&s->o, "set", i);
        struct sweep_range r;
        status = find_key(s, text, strcspn(text, "="), &r);
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
        if (sscanf(at, "%2u%n/%2u%n", &n, &used, &m, &more_used) < 1 || n < 1 || m < 1 || m > MULTIPLE_MAX ||
            s->n_harmonics == SWEEP_HARMONICS)
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
    for (int i = 0; i < s->n_harmonics; i++)
        if (s->harmonic[i].n * (s->common / s->harmonic[i].m) > LOCKIN_HARMONICS)
            return misuse(s, "--harmonics %s: up to %g times the reference together", text,
                          (double)LOCKIN_HARMONICS / s->common);
    return 0;
}

static int read_periods(struct sweep *s)
{
    s->settle = (int)options_number(&s->o, "settle");
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

static int check_ends(struct sweep *s)
{
    for (int i = 0; i < 4; i++) {
        struct scene sc = s->scene;
        char text[UNIT_TEXT];
        double value = i % 2 ? s->range.to : s->range.from;
        if (s->family.n)
            sweep_set(&sc, &s->family, i / 2 ? s->family.to : s->family.from);
        sweep_set(&sc, &s->range, value);
        const char *why = sweep_check(s, &sc);
        unit_write(value, s->range.key.unit, text);
        if (why)
            return misuse(s, "at %s = %s: %s", s->range.column, text, why);
    }
    return 0;
}

static int check_files(const struct sweep *s)
{
    const char *out = options_text(&s->o, "out", 0), *svg = options_text(&s->o, "svg", 0);
    if (svg && !out)
        return misuse(s, "--svg is drawn from a file of rows; give --out too");
    if (svg && options_given(&s->o, "shard"))
        return misuse(s,
                      "--svg goes without --shard; put the shards' files together, and give them as --out");
    for (int i = 0; i < 2; i++) {
        const char *path = i ? svg : out;
        if (path && s->o.n_words && scene_load_is(s->origin, s->o.word[0], path))
            return misuse(s, "%s is the scene itself; choose another file", path);
    }
    return svg && !strcmp(svg, out) ? misuse(s, "--svg and --out are both %s; choose two files", svg) : 0;
}

static int check_scene(struct sweep *s)
{
    for (int i = 0; i < s->scene.model->n_inputs; i++)
        if (s->scene.drive[i].noise > 0.0)
            return misuse(s, "this scene has noise on %s and never settles; take the noise out",
                          s->scene.model->input_signal[i].name);
    return 0;
}

/* ---- what the file says ---- */

static void name_columns(struct sweep *s)
{
    const struct signal *y = &s->scene.model->output_signal[(int)s->scene.observable];
    bool plain = scenes_dimensionless(&s->scene);
    char unit[WORD], *c = s->columns;
    spell(unit, sizeof unit, "", plain ? "" : y->unit);
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
        spell(name, sizeof name, x->name, plain ? "" : x->unit);
        n += (size_t)snprintf(c + n, size - n, ",end_%s", name);
    }
    snprintf(c + n, size - n, ",end_phases");
}

static void print_range(FILE *f, const struct sweep_range *r)
{
    if (r->n)
        fprintf(f, "%s %.17g %.17g %d %d\n", r->column, r->from, r->to, r->n, r->logarithmic);
}

static int name_run(struct sweep *s)
{
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    if (!f)
        return options_failure(s->o.usage, "no memory");
    scene_print(f, "sweep", &s->scene);
    print_range(f, &s->range);
    print_range(f, &s->family);
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
    s->origin = scene_load(s->o.n_words ? s->o.word[0] : model_table[0]->name, &s->scene, why);
    if (s->origin == SCENE_OF_NOTHING)
        return misuse(s, "%s", why);
    int status = read_settings(s);
    status = status ? status : check_scene(s);
    status = status ? status : read_ranges(s);
    status = status ? status : read_harmonics(s);
    status = status ? status : read_periods(s);
    status = status ? status : read_method(s);
    status = status ? status : check_ends(s);
    status = status ? status : check_files(s);
    if (status)
        return status;
    name_columns(s);
    return name_run(s);
}
