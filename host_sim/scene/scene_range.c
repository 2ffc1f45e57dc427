/* scene_range.c - see scene_range.h. */
#include "host_sim/scene/scene_range.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/unit.h"

enum { WORD = 64, PARTS = 4, ADVICE = 2048 };

/* ---- names ---- */

void scene_range_spell(char *text, size_t size, const char *name, const char *unit)
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

/* Key i of all, and the input that it belongs to or -1. */
static bool nth_key(const struct scene *s, int i, struct scene_range *r)
{
    enum scene_section section = s->paper ? SECTION_PAPER : SECTION_PLANT;
    int n = 0;
    r->input = -1;
    for (; scene_keys_get(s, section, 0, n, &r->key); n++)
        if (n == i)
            return true;
    for (r->input = 0; r->input < s->model->n_inputs; r->input++)
        for (int index = 0; scene_keys_get(s, SECTION_DRIVE, r->input, index, &r->key); index++, n++)
            if (n == i)
                return true;
    return false;
}

static const char *input_of(const struct scene *s, const struct scene_range *r)
{
    return r->input < 0 ? "" : s->model->input_signal[r->input].name;
}

void scene_range_label(const struct scene_range *r, char *text, size_t size)
{
    bool bare = !*r->unit || !strcmp(r->unit, "1");
    snprintf(text, size, bare ? "%s%s" : "%s%s (%s)", r->logarithmic ? "log10 of " : "", r->words, r->unit);
}

bool scene_range_nth(const struct scene *s, int i, struct scene_range *r)
{
    char full[SCENE_RANGE_NAME];
    if (!nth_key(s, i, r))
        return false;
    bool own = r->input >= 0;
    snprintf(full, sizeof full, "%s%s%s", input_of(s, r), own ? "." : "", own ? r->key.name : r->key.full);
    scene_range_spell(r->column, sizeof r->column, full, own ? r->key.unit : "");
    snprintf(r->words, sizeof r->words, "%s%s%s", r->key.name, own ? " of " : "", input_of(s, r));
    for (char *c = strchr(r->words, '_'); c; c = strchr(c, '_'))
        *c = ' ';
    r->unit = r->key.unit;
    return true;
}

int scene_range_find(const struct usage *u, const struct scene *s, const char *name, size_t n,
                     const struct scene_range_names *also, struct scene_range *r)
{
    enum { KEYS = 2 * MODEL_PARAMETERS + 8 * MODEL_INPUTS };
    static char text[KEYS][WORD];
    const char *names[KEYS + SCENE_RANGE_ALSO];
    char advice[ADVICE];
    int count = 0;
    for (int i = 0; scene_range_nth(s, i, r); i++) {
        const char *input = input_of(s, r);
        size_t skip = *input ? strlen(input) + 1 : 0;
        bool here = !skip || (n > skip && !strncmp(name, input, skip - 1) && name[skip - 1] == '.');
        if (r->key.kind != KEY_NUMBER)
            continue;
        if (here && is_key(&r->key, name + skip, n - skip))
            return 0;
        snprintf(text[count], WORD, "%s%s%s", input, skip ? "." : "", r->key.name);
        names[count] = text[count];
        count++;
    }
    for (int i = 0; also && i < also->n; i++)
        names[count++] = also->name[i];
    return options_misuse(u, "%.*s: no such number in this scene%s", (int)n, name,
                          options_advise(name, n, names, count, NULL, advice, sizeof advice));
}

/* A number with its unit, or in the unit of the table without one. */
static int read_number(const struct usage *u, const struct scene_range *r, const char *text, size_t n,
                       double *value)
{
    char why[UNIT_REASON];
    const struct scene_key *k = &r->key;
    const char *blank = *k->unit ? " " : "";
    while (n && *text == ' ')
        text++, n--;
    if (!unit_read_or_bare(text, n, k->unit, value, why))
        return options_misuse(u, "%s: %s", r->column, why);
    if (!(*value >= k->min && *value <= k->max))
        return options_misuse(u, "%s: %.*s is out of range; give %g to %g%s%s", r->column, (int)n, text,
                              k->min, k->max, blank, k->unit);
    return 0;
}

void scene_range_set(struct scene *sc, const struct scene_range *r, double value)
{
    scene_keys_set(sc, &r->key, value);
}

int scene_range_setting(const struct usage *u, struct scene *s, const char *text,
                        const struct scene_range_names *also)
{
    const char *equal = strchr(text, '=');
    struct scene_range r;
    double value;
    if (!equal)
        return options_misuse(u, "--set %s: write NAME=VALUE", text);
    int status = scene_range_find(u, s, text, (size_t)(equal - text), also, &r);
    status = status ? status : read_number(u, &r, equal + 1, strlen(equal + 1), &value);
    if (!status)
        scene_range_set(s, &r, value);
    return status;
}

int scene_range_settings(const struct options *o, struct scene *s)
{
    int status = 0;
    for (int i = 0; i < options_count(o, "set") && !status; i++)
        status = scene_range_setting(o->usage, s, options_text(o, "set", i), NULL);
    return status;
}

int scene_range_parameter(const struct usage *u, const struct parameter *p, const char *equal, double *value)
{
    struct scene_range r;
    scene_keys_parameter(p, 0, &r.key);
    snprintf(r.column, sizeof r.column, "%s", p->name);
    return read_number(u, &r, equal + 1, strlen(equal + 1), value);
}

/* The parts FROM, TO, N and :log behind the equal sign; how many there are. */
static int split(const char *equal, const char *part[PARTS], size_t length[PARTS])
{
    int n = 0;
    for (const char *at = equal; at && n < PARTS;
         at = at[1 + length[n - 1]] == ':' ? at + 1 + length[n - 1] : NULL) {
        part[n] = at + 1;
        length[n++] = strcspn(at + 1, ":");
    }
    return n;
}

int scene_range_limits(const struct usage *u, const char *option, const char *text, struct scene_range *r)
{
    const char *part[PARTS];
    size_t length[PARTS];
    char count[WORD];
    double n;
    int parts = split(strchr(text, '='), part, length);
    bool logarithmic = parts == 4 && !strcmp(part[3], "log");
    if (parts < 3 || (parts == 4 && !logarithmic))
        return options_misuse(u, "--%s %s: write NAME=FROM:TO:N, or NAME=FROM:TO:N:log", option, text);
    int status = read_number(u, r, part[0], length[0], &r->from);
    status = status ? status : read_number(u, r, part[1], length[1], &r->to);
    if (status)
        return status;
    snprintf(count, sizeof count, "%.*s", (int)length[2], part[2]);
    if (!options_read_number(count, &n) || !(n >= 2.0 && n <= SCENE_RANGE_POINTS) || n != floor(n))
        return options_misuse(u, "--%s %s: N is a whole number of values, 2 to %d", option, text,
                              SCENE_RANGE_POINTS);
    if (!(r->from < r->to))
        return options_misuse(u, "--%s %s: give the smaller end first", option, text);
    if (logarithmic && !(r->from > 0.0))
        return options_misuse(u, "--%s %s: a logarithmic range begins above 0", option, text);
    r->n = (int)n;
    r->logarithmic = logarithmic;
    return 0;
}

int scene_range_read(const struct usage *u, const struct scene *s, const char *option, const char *text,
                     struct scene_range *r)
{
    const char *equal = strchr(text, '=');
    if (!equal)
        return options_misuse(u, "--%s %s: write NAME=FROM:TO:N, or NAME=FROM:TO:N:log", option, text);
    int status = scene_range_find(u, s, text, (size_t)(equal - text), NULL, r);
    return status ? status : scene_range_limits(u, option, text, r);
}

double scene_range_value(const struct scene_range *r, int i)
{
    double part = r->n > 1 ? (double)i / (r->n - 1) : 0.0;
    if (i == 0 || i == r->n - 1)
        return i ? r->to : r->from;
    return r->logarithmic ? r->from * pow(r->to / r->from, part) : r->from + (r->to - r->from) * part;
}

void scene_range_print(FILE *f, const struct scene_range *r)
{
    if (r->n)
        fprintf(f, "%s %.17g %.17g %d %d\n", r->column, r->from, r->to, r->n, r->logarithmic);
}
