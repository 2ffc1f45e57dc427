/* scene_range.c - see scene_range.h. */
#include "host_sim/scene/scene_range.h"
#include "host_sim/cli/options_nearest.h"

#include <string.h>

enum { WORD = 64, ADVICE = 2048 };

/* ---- names ---- */

void scene_range_spell(char *text, size_t size, const char *name, const char *unit)
{
    bool has_unit = *unit && strcmp(unit, "1");
    size_t n = (size_t)snprintf(text, size, "%s%s", name, has_unit ? "_" : "");
    if (has_unit && n < size)
        scene_keys_spell(unit, text + n, size - n);
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
    snprintf(text, size, bare ? "%s%s" : "%s%s (%s)", r->values.logarithmic ? "log10 of " : "", r->words,
             r->unit);
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
    enum { KEYS = 2 * MODEL_PARAMETERS + 8 * MODEL_INPUTS, FEW = 24 /* names that a line may list */ };
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
    const char *hint = also && also->where ? also->where
                       : count > FEW       ? "contactplant scene shows them"
                                           : NULL;
    return options_misuse(u, "%.*s: no such number in this scene%s", (int)n, name,
                          options_advise_in(advice, sizeof advice, name, n, names, count, hint));
}

static struct range_rules rules_of(const struct scene_range *r)
{
    return (struct range_rules){.named = true,
                                .unit = r->key.unit,
                                .bare = true,
                                .min = r->key.min,
                                .max = r->key.max,
                                .n_min = 2,
                                .n_max = SCENE_RANGE_POINTS};
}

/* The value behind the equal sign. */
static int read_number(const struct usage *u, const struct scene_range *r, const char *equal, double *value)
{
    struct range_rules rules = rules_of(r);
    char why[RANGE_REASON];
    return range_read_number(equal + 1, strlen(equal + 1), &rules, value, why)
               ? 0
               : options_misuse(u, "%s: %s", r->column, why);
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
    status = status ? status : read_number(u, &r, equal, &value);
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
    return read_number(u, &r, equal, value);
}

int scene_range_limits(const struct usage *u, const char *option, const char *text, struct scene_range *r)
{
    struct range_rules rules = rules_of(r);
    char why[RANGE_REASON];
    return range_read(text, &rules, &r->values, why) ? 0
                                                     : options_misuse(u, "--%s %s: %s", option, text, why);
}

int scene_range_read(const struct usage *u, const struct scene *s, const char *option, const char *text,
                     struct scene_range *r)
{
    const char *equal = strchr(text, '=');
    *r = (struct scene_range){.input = -1};
    int status = equal ? scene_range_find(u, s, text, (size_t)(equal - text), NULL, r) : 0;
    return status ? status : scene_range_limits(u, option, text, r);
}

void scene_range_print(FILE *f, const struct scene_range *r)
{
    const struct range *v = &r->values;
    if (v->n)
        fprintf(f, "%s %.17g %.17g %d %d", r->column, v->from, v->to, v->n, v->logarithmic);
}
