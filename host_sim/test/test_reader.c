/* test_reader.c - see test_reader.h. */
#include "host_sim/test/test_reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/afm/afm_plant.h"
#include "firmware/bus/settings.h"
#include "host_sim/cli/options.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/scene/scene.h"
#include "host_sim/scene/scene_words.h"

bool test_read_value(struct test_reader *r, const char *name, struct word w, const char *unit, double min,
                     double max, double *value)
{
    char why[SCENE_REASON];
    return scene_words_number(name, w, unit, min, max, value, why) || test_wrong(r, "%s", why);
}

bool test_read_count(struct test_reader *r, const char *name, struct word w, double min, double max,
                     double *value)
{
    if (!test_read_value(r, name, w, "", min, max, value))
        return false;
    return *value == floor(*value) ? true : test_wrong(r, "%s: give a whole number", name);
}

bool test_split_range(struct word w, struct word *from, struct word *to)
{
    for (size_t i = 0; i + 1 < w.n; i++)
        if (w.at[i] == '.' && w.at[i + 1] == '.') {
            *from = scene_text_trimmed((struct word){w.at, i});
            *to = scene_text_trimmed((struct word){w.at + i + 2, w.n - i - 2});
            return from->n > 0 && to->n > 0;
        }
    return false;
}

bool test_copy(struct test_reader *r, struct word w, char *to, size_t size)
{
    if (w.n >= size)
        return test_wrong(r, "\"%.*s..\" is longer than %zu characters", scene_text_shown(w), w.at, size - 1);
    memcpy(to, w.at, w.n);
    to[w.n] = 0;
    return true;
}

bool test_take_tail(struct word *rest, const char *mark, struct word *tail)
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

const struct model *test_model(const struct test_file *t)
{
    return t->lever.model ? &afm_plant : t->scene.model;
}

bool test_no_name(struct test_reader *r, struct word name, const char *const *key, int n_keys)
{
    char why[SCENE_REASON];
    scene_words_no_name(test_model(r->test), name, key, n_keys, why);
    return test_wrong(r, "%s", why);
}

int test_find_set(struct test_reader *r, struct word name)
{
    struct scene_key k;
    return scene_words_find(test_model(r->test), name, &k);
}

bool test_read_set(struct test_reader *r, struct word name, struct word value, struct action_set *set)
{
    char why[SCENE_REASON];
    int i = scene_words_read(test_model(r->test), name, value, &set->value, why);
    set->index = (unsigned)i;
    return i >= 0 || test_wrong(r, "%s", why);
}

int test_list_signals(const struct model *m, struct word wanted, const char **name)
{
    static char known[METRIC_SIGNALS][METRIC_UNIT];
    int found = -1;
    for (int i = 0; i < metric_signals(m); i++) {
        metric_signal_name(m, i, known[i]);
        name[i] = known[i];
        found = scene_text_is(wanted, known[i]) ? i : found;
    }
    return found;
}

int test_find_signal(struct test_reader *r, struct word name)
{
    const struct model *m = r->test->scene.model;
    const char *names[METRIC_SIGNALS];
    int i = test_list_signals(m, name, names);
    if (i < 0)
        test_wrong(r, "%.*s: no signal of %s%s", scene_text_shown(name), name.at, m->name,
                   options_advise(name.at, name.n, names, metric_signals(m), NULL));
    return i;
}
