/* trial_value.c - values, ranges, signals, parameters and settings in a test file; see trial.h. */
#include "host_sim/trial/trial.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/bus/settings.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scene/scene_words.h"
#include "firmware/afm/afm_plant.h"

bool trial_read_value(struct trial_reader *r, const char *name, struct word w, const char *unit, double min,
                      double max, double *value)
{
    char why[SCENE_REASON];
    return scene_words_number(name, w, unit, min, max, value, why) || trial_wrong(r, "%s", why);
}

bool trial_read_count(struct trial_reader *r, const char *name, struct word w, double min, double max,
                      double *value)
{
    if (!trial_read_value(r, name, w, "", min, max, value))
        return false;
    return *value == floor(*value) ? true : trial_wrong(r, "%s: give a whole number", name);
}

bool trial_split_range(struct word w, struct word *from, struct word *to)
{
    for (size_t i = 0; i + 1 < w.n; i++)
        if (w.at[i] == '.' && w.at[i + 1] == '.') {
            *from = scene_text_trimmed((struct word){w.at, i});
            *to = scene_text_trimmed((struct word){w.at + i + 2, w.n - i - 2});
            return from->n > 0 && to->n > 0;
        }
    return false;
}

bool trial_copy(struct trial_reader *r, struct word w, char *to, size_t size)
{
    if (w.n >= size)
        return trial_wrong(r, "\"%.*s..\" is longer than %zu characters", scene_text_shown(w), w.at,
                           size - 1);
    memcpy(to, w.at, w.n);
    to[w.n] = 0;
    return true;
}

bool trial_take_tail(struct word *rest, const char *mark, struct word *tail)
{
    size_t n = strlen(mark);
    for (size_t i = rest->n; i-- > 0;) {
        bool begins = i == 0 || rest->at[i - 1] == ' ' || rest->at[i - 1] == '\t';
        bool ends = i + n < rest->n && (rest->at[i + n] == ' ' || rest->at[i + n] == '\t');
        if (!begins || !ends || memcmp(rest->at + i, mark, n))
            continue;
        *tail = scene_text_trimmed((struct word){rest->at + i + n, rest->n - i - n});
        *rest = scene_text_trimmed((struct word){rest->at, i});
        return true;
    }
    return false;
}

/* ---- parameters and settings ---- */

const struct model *trial_model(const struct trial *t)
{
    return t->is_microscope ? &afm_plant : t->scene.model;
}

const struct parameter *trial_parameter(const struct trial *t, int index)
{
    return scene_parameter(trial_model(t), index);
}

bool trial_no_name(struct trial_reader *r, struct word name, const char *const *key, int n_keys)
{
    const struct model *m = r->trial->scene.model;
    struct scene_key known[SETTING_FIRST + SETTINGS];
    const char *names[SETTING_FIRST + SETTINGS + TRIAL_KEYS];
    char advice[OPTIONS_ADVICE];
    int n = 0;
    for (; n < n_keys; n++)
        names[n] = key[n];
    for (int i = 0; i < SETTING_FIRST + SETTINGS; i++)
        if (trial_parameter(r->trial, i)) {
            scene_keys_parameter(trial_parameter(r->trial, i), 0, &known[i]);
            names[n++] = i < SETTING_FIRST ? known[i].name : known[i].full;
        }
    return trial_wrong(
        r, "%.*s: no such %sparameter or setting of %s%s", scene_text_shown(name), name.at,
        n_keys ? "key, " : "", m->name,
        options_advise(name.at, name.n, names, n, "contactplant list shows them", advice, sizeof advice));
}

int trial_find_set(struct trial_reader *r, struct word name)
{
    struct scene_key k;
    return scene_words_find(trial_model(r->trial), name, &k);
}

bool trial_read_set(struct trial_reader *r, struct word name, struct word value, struct trial_set *set)
{
    const struct model *m = trial_model(r->trial);
    struct scene_key k;
    char why[SCENE_REASON];
    int i = scene_words_find(m, name, &k);
    if (i < 0)
        return trial_no_name(r, name, NULL, 0);
    set->index = (unsigned)i;
    return scene_words_set(m, i, &k, name, value, &set->value, why) || trial_wrong(r, "%s", why);
}

int trial_find_signal(struct trial_reader *r, struct word name)
{
    const struct model *m = r->trial->scene.model;
    static char known[METRIC_SIGNALS][METRIC_UNIT];
    const char *names[METRIC_SIGNALS];
    char text[OPTIONS_ADVICE];
    int n = metric_signals(m);
    for (int i = 0; i < n; i++) {
        metric_signal_name(m, i, known[i]);
        names[i] = known[i];
        if (scene_text_is(name, known[i]))
            return i;
    }
    trial_wrong(r, "%.*s: no signal of %s%s", scene_text_shown(name), name.at, m->name,
                options_advise(name.at, name.n, names, n, NULL, text, sizeof text));
    return -1;
}

double trial_varied_value(const struct trial_case *c, int i)
{
    return c->vary_from + (c->vary_to - c->vary_from) * i / (c->n_varied - 1);
}
