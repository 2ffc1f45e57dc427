/* scene_words.c - see scene_words.h. */
#include "host_sim/scene/scene_words.h"

#include <stdio.h>
#include <string.h>
#include "firmware/bus/settings.h"
#include "firmware/bus/wire.h"
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/cli/unit.h"
#include "host_sim/scene/scene_app.h"

#define RAMP_MAX  1e4
#define PHASE_MAX 1e6
#define DRIVE_MAX 1e12

bool scene_words_next(struct word *rest, struct word *name, struct word *value, char *why)
{
    if (!rest->n)
        return false;
    const char *equal = memchr(rest->at, '=', rest->n), *end = rest->at + rest->n, *next;
    if (!equal) {
        snprintf(why, SCENE_REASON, "\"%.*s\": write NAME=VALUE", scene_text_shown(*rest), rest->at);
        return false;
    }
    *name = scene_text_trimmed((struct word){rest->at, (size_t)(equal - rest->at)});
    next = memchr(equal + 1, '=', (size_t)(end - equal - 1));
    while (next && next > equal + 1 && (next[-1] == ' ' || next[-1] == '\t'))
        next--;
    while (next && next > equal + 1 && next[-1] != ' ' && next[-1] != '\t')
        next--;
    next = next ? next : end;
    *value = scene_text_trimmed((struct word){equal + 1, (size_t)(next - equal - 1)});
    *rest = scene_text_trimmed((struct word){next, (size_t)(end - next)});
    if (name->n && value->n)
        return true;
    snprintf(why, SCENE_REASON, "\"%.*s\": %s is missing; write NAME=VALUE", scene_text_shown(*name),
             name->at, name->n ? "the value" : "the name");
    return false;
}

static bool in_range(const char *name, struct word w, const char *unit, double min, double max, double value,
                     char *why)
{
    bool bare = !*unit || !strcmp(unit, "1");
    if (value >= min && value <= max)
        return true;
    snprintf(why, SCENE_REASON, "%s: %.*s is out of range; give %g to %g%s%s", name, scene_text_shown(w),
             w.at, min, max, bare ? "" : " ", bare ? "" : unit);
    return false;
}

static bool misread(const char *name, const char *reason, char *why)
{
    snprintf(why, SCENE_REASON, "%s: %s", name, reason);
    return false;
}

bool scene_words_number(const char *name, struct word w, const char *unit, double min, double max,
                        double *value, char *why)
{
    char reason[UNIT_REASON];
    return unit_read(w.at, w.n, unit, value, reason) ? in_range(name, w, unit, min, max, *value, why)
                                                     : misread(name, reason, why);
}

/* As scene_words_number; a bare number is in the unit, too. */
static bool number_or_bare(const char *name, struct word w, const char *unit, double min, double max,
                           double *value, char *why)
{
    char reason[UNIT_REASON];
    return unit_read_or_bare(w.at, w.n, unit, value, reason) ? in_range(name, w, unit, min, max, *value, why)
                                                             : misread(name, reason, why);
}

/* ---- parameters and settings ---- */

int scene_words_find(const struct model *m, struct word name, struct scene_key *k)
{
    for (int i = 0; i < SETTING_FIRST + SETTINGS; i++) {
        if (!scene_parameter(m, i))
            continue;
        scene_keys_parameter(scene_parameter(m, i), 0, k);
        if (scene_text_is(name, k->full) || scene_text_is(name, k->name))
            return i;
    }
    return -1;
}

bool scene_words_no_name(const struct model *m, struct word name, const char *const *key, int n_keys,
                         char *why)
{
    static struct scene_key known[SETTING_FIRST + SETTINGS];
    const char *names[2 * (SETTING_FIRST + SETTINGS) + SCENE_WORDS_KEYS];
    int n = 0;
    for (; n < n_keys && n < SCENE_WORDS_KEYS; n++)
        names[n] = key[n];
    for (int i = 0; i < SETTING_FIRST + SETTINGS; i++) {
        if (!scene_parameter(m, i))
            continue;
        scene_keys_parameter(scene_parameter(m, i), 0, &known[i]);
        names[n++] = known[i].name;
        names[n++] = known[i].full;
    }
    snprintf(why, SCENE_REASON, "%.*s: no such %sparameter or setting of %s%s", scene_text_shown(name),
             name.at, n_keys ? "key, " : "", m->name,
             options_advise(name.at, name.n, names, n, "contactplant list shows them"));
    return false;
}

/* A parameter or setting that was found. */
static bool read_value(const struct model *m, int index, const struct scene_key *k, struct word name,
                       struct word value, double *x, char *why)
{
    bool good = scene_text_is(name, k->full)
                    ? number_or_bare(k->full, value, k->unit, k->min, k->max, x, why)
                    : scene_words_number(k->name, value, k->unit, k->min, k->max, x, why);
    return good && scene_accepts(m, index, *x, why);
}

int scene_words_read(const struct model *m, struct word name, struct word value, double *x, char *why)
{
    struct scene_key k;
    int index = scene_words_find(m, name, &k);
    bool good = index >= 0 ? read_value(m, index, &k, name, value, x, why)
                           : scene_words_no_name(m, name, NULL, 0, why);
    return good ? index : -1;
}

/* ---- drives ---- */

static double largest(int field)
{
    return field == DRIVE_RAMP         ? RAMP_MAX
           : field == DRIVE_NOISE_HOLD ? 65535.0
           : field == DRIVE_NOISE_SEED ? 16777215.0
           : field == DRIVE_PHASE      ? PHASE_MAX
                                       : DRIVE_MAX;
}

int scene_words_field(const struct model *m, int input, struct word name, struct word value, double *x,
                      char *why)
{
    const char *field[DRIVE_FIELDS];
    struct named n;
    for (int i = 0; i < DRIVE_FIELDS; i++) {
        (void)names_get(m, NAMES_ARM, (unsigned)i, &n);
        field[i] = n.name;
        if (!scene_text_is(name, n.name))
            continue;
        bool own = i == DRIVE_AMPLITUDE || i == DRIVE_NOISE;
        double min = i == DRIVE_AMPLITUDE || i == DRIVE_PHASE ? -largest(i) : 0.0;
        const char *unit = own ? m->input_signal[input].unit : n.unit;
        return number_or_bare(n.name, value, unit, min, largest(i), &x[i], why) ? i : -1;
    }
    snprintf(why, SCENE_REASON, "no field \"%.*s\"%s", scene_text_shown(name), name.at,
             options_advise(name.at, name.n, field, DRIVE_FIELDS, NULL));
    return -1;
}
