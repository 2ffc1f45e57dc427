/* trial.c - a test file: refused with one line that names a place, or taken, with cases that can be run. */
#include "host_sim/test/test_read.h"
#include "models/models.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <string.h>

/* Models and presets only: a fuzzer opens no files. */
static bool load(const char *file, const char *name, struct scene *s, char *why)
{
    const struct preset *p = scenes_find(name);
    (void)file;
    snprintf(why, SCENE_FILE_REASON, "no such preset");
    if (p)
        *s = p->scene;
    for (int i = 0; i < MODELS && !p; i++)
        if (!strcmp(name, model_table[i]->name)) {
            scenes_default(s, model_table[i]);
            return true;
        }
    return p != NULL;
}

static void check_case(const struct test_file *t, const struct test_case *c)
{
    const struct model *m = t->scene.model;
    MUST(c->over_s > 0.0 && (c->n_expects > 0 || *c->golden) && c->n_expects <= TEST_EXPECTS &&
         c->n_acts <= TEST_ACTS);
    MUST(c->n_seeds >= 1 && c->vary.n >= 1 && memchr(c->name, 0, sizeof c->name));
    for (int i = 0; i < c->n_expects; i++) {
        const struct test_expect *e = &c->expect[i];
        enum metric_of of = metric_table[e->what.kind].of;
        MUST(e->what.from_s < e->what.to_s && isfinite(e->value) && memchr(e->text, 0, sizeof e->text));
        MUST(of != OF_CONTACTS || m->n_contacts > 0);
        MUST((of != OF_SIGNAL && of != OF_TARGET) ||
             (e->what.signal >= 0 && e->what.signal < metric_signals(m)));
    }
    for (int i = 0; i < DECODE_SIGNALS && *c->golden; i++)
        MUST(isnan(c->limit[i].tolerance) || (c->limit[i].tolerance >= 0.0 && c->limit[i].one > 0.0));
    for (int i = 0; i < c->n_acts; i++) {
        MUST(c->act[i].at_s >= 0.0 && c->act[i].at_s < c->over_s);
        MUST(i == 0 || c->act[i - 1].at_s <= c->act[i].at_s);
        const struct action *a = &c->act[i].what;
        MUST(a->verb < ACTION_VERBS && (a->verb != ACTION_SET || a->n > 0) && a->n <= ACTION_SETS);
        MUST(a->verb != ACTION_FIRE_INPUT || a->given);
        MUST(a->input >= 0 && a->input < m->n_inputs && (a->verb != ACTION_FAULTS || *a->text));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct test_file t;
    char why[TEST_REASON];
    if (!test_parse("my.test", (const char *)data, size, load, &t, why)) {
        MUST(!strncmp(why, "my.test:", 8) && !strchr(why, '\n') && strlen(why) < sizeof why);
        return 0;
    }
    MUST(t.n_cases > 0 && t.n_cases <= TEST_CASES && t.scene.model && (*t.command || t.attached));
    for (int i = 0; i < t.n_cases; i++)
        check_case(&t, &t.cases[i]);
    return 0;
}
