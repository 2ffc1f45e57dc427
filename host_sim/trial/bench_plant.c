/* bench_plant.c - see bench_plant.h. */
#include "host_sim/trial/bench_plant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/app/parameters.h"
#include "hal/link/faults.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/selftest.h"
#include "host_sim/cli/unit.h"
#include "host_sim/live/fault_list.h"
#include "models/models.h"

/* Every case expects 0 of these, unless it names the metric. */
static const enum metric_kind implicit[BENCH_IMPLICIT] = {METRIC_FAULTS, METRIC_REFUSED, METRIC_TIMEOUTS,
                                                          METRIC_MALFORMED};

/* ---- set-up ---- */

static bool is_known(const char *name)
{
    bool known = scenes_find(name) != NULL;
    for (int i = 0; i < MODELS; i++)
        known = known || !strcmp(name, model_table[i]->name);
    return known;
}

void bench_scene_path(const char *file, const char *name, char path[BENCH_PATH])
{
    const char *slash = strrchr(file, '/');
    if (is_known(name) || *name == '/' || !slash)
        snprintf(path, BENCH_PATH, "%s", name);
    else
        snprintf(path, BENCH_PATH, "%.*s/%s", (int)(slash - file), file, name);
}

static void put(struct scene_app *s, unsigned index, double value)
{
    if (index < SETTING_FIRST)
        s->si[index] = value;
    else
        s->setting[index - SETTING_FIRST] = value;
}

static bool make(struct bench_plant *p, const struct trial *t, const struct trial_case *c, char *why)
{
    char path[BENCH_PATH];
    struct scene_app *s = &p->scene;
    bench_scene_path(t->file, t->scene_name, path);
    if (!scene_init(s, path, why))
        return false;
    if (c->plant.rate_Hz > 0.0)
        s->config.frame_s = 1.0 / c->plant.rate_Hz;
    if (c->plant.substeps)
        s->config.substeps = c->plant.substeps;
    for (int i = 0; i < SETTINGS; i++)
        s->setting[i] = setting_initial(i, s->config.model, s->config.frame_s);
    for (int i = 0; i < t->plant.n; i++)
        put(s, t->plant.set[i].index, t->plant.set[i].value);
    return true;
}

/* The case's own values are news to the controller: [plant] is what it was told, identity and scale stay those of it. A plant
 * without a start of its own rests under the new values. */
static bool deviate(struct bench_plant *p, const struct trial_case *c, const double *varied, char *why)
{
    struct app *a = &p->scene.app;
    struct staged staged;
    double x[MODEL_STATES];
    memset(&staged, 0, sizeof staged);
    for (int i = 0; i < c->plant.n; i++)
        staged_put(&staged, c->plant.set[i].index, c->plant.set[i].value);
    if (varied)
        staged_put(&staged, (unsigned)c->varied, *varied);
    if (staged_count(&staged) == 0)
        return true;
    const char *reason = parameters_check(a, &staged);
    if (reason) {
        snprintf(why, TRIAL_REASON, "the case's parameters and settings do not fit: %s", reason);
        return false;
    }
    (void)parameters_apply(a, &staged); /* it fits */
    if (!p->scene.scene.started) {
        a->plant.model->rest(a->plant.p, x);
        plant_set_state(&a->plant, x);
    }
    return true;
}

static bool is_named(const struct trial_case *c, enum metric_kind kind)
{
    for (int i = 0; i < c->n_expects; i++)
        if (c->expect[i].what.kind == kind)
            return true;
    return false;
}

static void begin_measurements(struct bench_plant *p, const struct trial_case *c)
{
    const struct plant *pl = &p->scene.app.plant;
    for (int i = 0; i < c->n_expects; i++) {
        struct metric_setting what = c->expect[i].what;
        what.to_s = fmin(what.to_s, c->over_s);
        p->reads_signals |=
            metric_table[what.kind].of == OF_SIGNAL || metric_table[what.kind].of == OF_TARGET;
        p->reads_frequencies |= what.signal >= 0 && metric_is_frequency(pl->model, what.signal);
        measurement_begin(&p->measurement[p->n++], &what, pl);
    }
    for (int i = 0; i < BENCH_IMPLICIT; i++)
        if (!is_named(c, implicit[i]))
            measurement_begin(&p->measurement[p->n++],
                              &(struct metric_setting){.kind = implicit[i], .to_s = c->over_s}, pl);
    p->regime = pl->regime;
}

/* Contact switches of this tick in their order. After a change of parameters the regime may be another without one. */
static void take_switches(struct bench_plant *p, const struct plant *pl)
{
    uint32_t n = pl->counts.switches - p->switches, kept = n < pl->n_event ? n : pl->n_event;
    for (uint32_t i = pl->n_event - kept; i < pl->n_event; i++) {
        const struct event *e = &pl->event[(pl->event_head + i) % PLANT_EVENTS];
        p->regime = e->touch ? p->regime | 1u << e->contact : p->regime & ~(1u << e->contact);
        for (int k = 0; k < p->n; k++) {
            measurement_switch(&p->measurement[k], ((double)e->tick + e->fraction) * pl->tick_s,
                               p->regime == 0);
            measurement_event(&p->measurement[k], e);
        }
    }
    p->switches = pl->counts.switches;
    if (p->regime == pl->regime)
        return;
    p->regime = pl->regime;
    for (int k = 0; k < p->n; k++)
        measurement_switch(&p->measurement[k], (double)pl->now.tick * pl->tick_s, p->regime == 0);
}

static void observe(void *observer, const struct plant *pl)
{
    struct bench_plant *p = observer;
    double value[METRIC_SIGNALS];
    if (pl->counts.switches != p->switches || pl->regime != p->regime)
        take_switches(p, pl);
    if (!p->reads_signals)
        return;
    metric_read(pl, p->reads_frequencies, value);
    for (int k = 0; k < p->n; k++)
        measurement_tick(&p->measurement[k], pl, value);
}

/* As contactplant run: a controller hears of it. */
static bool take_selftest(struct app *a, char *why)
{
    struct selftest_result r;
    snprintf(why, TRIAL_REASON, "no memory for the self-test");
    if (!selftest_of_host(&r))
        return false;
    app_take_selftest(a, &r);
    return true;
}

bool bench_plant_open(struct bench_plant *p, const struct trial *t, const struct trial_case *c,
                      const double *varied, char *why)
{
    p->c = c;
    if (!make(p, t, c, why))
        return false;
    p->scene.config.observe = observe;
    p->scene.config.observer = p;
    if (!scene_start(&p->scene, NULL, why))
        return false;
    if (!take_selftest(&p->scene.app, why) || !deviate(p, c, varied, why))
        return false;
    p->switches = p->scene.app.plant.counts.switches;
    begin_measurements(p, c);
    return true;
}

void bench_plant_close(struct bench_plant *p)
{
    scene_free(&p->scene);
}

bool bench_approve(const struct trial *t, const struct trial_case *c, char *why)
{
    static struct bench_plant p;
    static struct faults faults;
    static const struct hal none = {0};
    char reason[SCENE_REASON];
    memset(&p, 0, sizeof p);
    bool good = bench_plant_open(&p, t, c, c->varied >= 0 ? &c->vary_to : NULL, reason);
    faults_init(&faults, &none, 1);
    if (good && *c->link)
        good = fault_list_read(&faults, c->link, p.scene.config.frame_s, reason);
    double tick_s = p.scene.config.frame_s / p.scene.config.substeps;
    for (int i = 0; good && i < c->n_acts; i++)
        if (c->act[i].given >> DRIVE_FREQUENCY & 1u &&
            c->act[i].value[DRIVE_FREQUENCY] * tick_s * DRIVE_TICKS_MIN > 1.0) {
            snprintf(reason, sizeof reason, "arm: " DRIVE_TICKS_TOO_FEW "%g Hz; more substeps",
                     c->act[i].value[DRIVE_FREQUENCY]);
            good = false;
        }
    bench_plant_close(&p);
    return good ? true : scene_text_wrong(t->file, c->line, why, "[case %s]: %.400s", c->name, reason);
}

/* ---- what happens ---- */

/* A set of values, as PARAM_COMMIT would apply it. */
static bool apply_set(struct app *a, const struct trial_act *act, char *why)
{
    struct staged staged;
    memset(&staged, 0, sizeof staged);
    for (int i = 0; i < act->n; i++)
        staged_put(&staged, act->set[i].index, act->set[i].value);
    const char *reason = parameters_check(a, &staged);
    if (reason)
        snprintf(why, TRIAL_REASON, "set at %g s does not fit: %s", act->at_s, reason);
    else
        (void)parameters_apply(a, &staged); /* it fits */
    return !reason;
}

bool bench_plant_act(struct bench_plant *p, char *why)
{
    struct app *a = &p->scene.app;
    for (; p->next_act < p->c->n_acts; p->next_act++) {
        const struct trial_act *act = &p->c->act[p->next_act];
        if (act->at_s > plant_time(&a->plant) + 0.5 * a->plant.tick_s)
            return true;
        if (!act->arms && !apply_set(a, act, why))
            return false;
        if (act->arms) {
            plant_set_drive(&a->plant, act->input, act->given, act->value);
            a->plant.counts.changes++;
        }
    }
    return true;
}

void bench_plant_frame(struct bench_plant *p, const struct measurement_link *l)
{
    for (int k = 0; k < p->n; k++)
        measurement_frame(&p->measurement[k], &p->scene.app, l);
    p->faults |= p->scene.app.faults & ~(unsigned)FAULT_TIMEOUT;
}

const char *bench_plant_state(const struct bench_plant *p)
{
    const char *name = names_text(p->scene.config.model, NAMES_STATE, (unsigned)p->scene.app.state);
    return name ? name : "?";
}

/* ---- the verdict ---- */

static bool holds(enum trial_operator op, double value, double limit)
{
    bool equal = !(value < limit) && !(value > limit);
    switch (op) {
    case TRIAL_EQUAL:
        return equal;
    case TRIAL_UNEQUAL:
        return !equal;
    case TRIAL_AT_MOST:
        return value <= limit;
    case TRIAL_AT_LEAST:
        return value >= limit;
    case TRIAL_BELOW:
        return value < limit;
    default:
        return value > limit;
    }
}

static void name_faults(unsigned faults, char *text, size_t size)
{
    static const char *const name[] = {"not_finite", "budget",  "ledger", "overrun",
                                       "bus",        "timeout", "assert", "self_test"};
    size_t n = 0;
    for (int i = 0; i < 8 && n < size; i++)
        if (faults >> i & 1u)
            n += (size_t)snprintf(text + n, size - n, "%s%s", n ? ", " : "", name[i]);
}

/* The causes of what was refused, from the counters. */
static void name_refusals(const struct app *a, char *text, size_t size)
{
    size_t n = 0;
    for (int i = DIAG_CRC; i <= DIAG_SELF_TEST && n < size; i++)
        if (a->count[i] && i != DIAG_LOST)
            n += (size_t)snprintf(text + n, size - n, "%s%u %s", n ? ", " : "", a->count[i],
                                  diag_name[i].name);
}

/* Four digits are enough for people; the report for programs has all. */
static void write_value(double value, const char *unit, char text[UNIT_TEXT])
{
    char rounded[UNIT_TEXT];
    snprintf(rounded, sizeof rounded, "%.4g", value);
    unit_write(strtod(rounded, NULL), unit, text);
}

static void describe(const struct bench_plant *p, const struct metric_setting *what, struct outcome *o)
{
    char unit[METRIC_UNIT], more[128] = "", value[UNIT_TEXT] = "";
    const struct metric_value *v = &o->value;
    metric_unit(p->scene.config.model, what->kind, what->signal, unit);
    if (what->kind == METRIC_FAULTS)
        name_faults(p->faults, more, sizeof more);
    if (what->kind == METRIC_REFUSED)
        name_refusals(&p->scene.app, more, sizeof more);
    if (v->known && isfinite(v->value))
        write_value(v->value, unit, value);
    if (!v->known)
        snprintf(o->found, sizeof o->found, "nothing to judge fell into its window");
    else if (*v->note)
        snprintf(o->found, sizeof o->found, "%s", v->note);
    else if (what->kind == METRIC_HASH)
        snprintf(o->found, sizeof o->found, "it was %016llx", (unsigned long long)v->hash);
    else
        snprintf(o->found, sizeof o->found, "it was %s%s%s%s at %.6g s", value, *more ? " (" : "", more,
                 *more ? ")" : "", v->when_s);
}

static void judge_one(struct bench_plant *p, const struct trial_expect *e, struct measurement *m,
                      struct outcome *o)
{
    measurement_end(m, &p->scene.app, &o->value);
    o->line = e->line;
    o->kind = e->what.kind;
    memcpy(o->text, e->text, sizeof o->text);
    bool good = e->what.kind == METRIC_HASH ? (o->value.hash == e->hash) == (e->op == TRIAL_EQUAL)
                                            : holds(e->op, o->value.value, e->value);
    o->verdict = !o->value.known ? VERDICT_UNTESTED : good ? VERDICT_OK : VERDICT_FAIL;
    if (o->verdict == VERDICT_FAIL && !e->line && e->what.kind == METRIC_FAULTS)
        o->verdict = VERDICT_ERROR; /* the plant's own trouble */
    describe(p, &e->what, o);
}

/* After an error of the bench the measurements are incomplete and none is judged. */
void bench_plant_judge(struct bench_plant *p, const struct trial_case *c, struct bench_result *r)
{
    if (p->scene.app.plant.model)
        r->hash = plant_hash(&p->scene.app.plant);
    for (int i = 0; i < p->n && r->verdict != VERDICT_ERROR; i++) {
        struct trial_expect e = {.what = p->measurement[i].set};
        snprintf(e.text, sizeof e.text, "%s == 0 (every case, unless it names it)",
                 metric_table[e.what.kind].name);
        judge_one(p, i < c->n_expects ? &c->expect[i] : &e, &p->measurement[i], &r->outcome[r->n++]);
    }
    for (int i = 0; i < r->n; i++)
        if (r->outcome[i].verdict > r->verdict)
            r->verdict = r->outcome[i].verdict;
}
