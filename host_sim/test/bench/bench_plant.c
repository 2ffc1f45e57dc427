/* bench_plant.c - see bench_plant.h. */
#include "host_sim/test/bench/bench_plant.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/app/parameters.h"
#include "firmware/app/session.h"
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_report.h"
#include "hal/link/faults.h"
#include "host_sim/cli/names.h"
#include "host_sim/cli/selftest.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/live/fault_list.h"
#include "host_sim/scene/scene_keys.h"
#include "host_sim/test/bench/bench_microscope.h"
#include "host_sim/test/test_at.h"

/* ---- set-up ---- */

static void put(struct scene_app *s, unsigned index, double value)
{
    if (index < SETTING_FIRST)
        s->si[index] = value;
    else
        s->setting[index - SETTING_FIRST] = value;
}

static bool make(struct scene_app *s, const struct test_file *t, const struct test_case *c,
                 const double *varied, char *why)
{
    char path[BENCH_PATH];
    bench_scene_path(t->file, t->scene_name, path);
    if (!(t->lever.model ? bench_microscope_make(s, t, c, varied, why) : scene_init(s, path, why)))
        return false;
    if (c->plant.rate_Hz > 0.0)
        s->config.frame_s = 1.0 / c->plant.rate_Hz;
    if (c->plant.substeps)
        s->config.substeps = c->plant.substeps;
    scene_app_default_settings(s);
    for (int i = 0; i < t->plant.n; i++)
        put(s, t->plant.set[i].index, t->plant.set[i].value);
    return true;
}

/* As scene_subject, for the plant's parameters with a set above them. */
static void find_subject(const struct app *a, const struct staged *set, char *subject)
{
    double si[MODEL_PARAMETERS];
    for (unsigned i = 0; i < MODEL_PARAMETERS; i++)
        si[i] = staged_has(set, i) ? set->value[i] : a->plant.si[i];
    scene_subject(a->plant.model, si, subject);
}

/* The case's own values are news to the controller: [plant] is what it was told, identity and scale stay
 * those of it. A plant without a start of its own rests under the new values. */
static bool deviate(struct bench_plant *p, const struct test_case *c, const double *varied, char *why)
{
    struct app *a = &p->scene.app;
    struct staged staged;
    char subject[SCENE_SUBJECT];
    double x[MODEL_STATES];
    memset(&staged, 0, sizeof staged);
    for (int i = 0; i < c->plant.n; i++)
        staged_put(&staged, c->plant.set[i].index, c->plant.set[i].value);
    if (varied)
        staged_put(&staged, (unsigned)c->varied, *varied);
    int seed = scene_kind(a->plant.model)->seed;
    if (seed >= 0 && p->seed > 1)
        staged_put(&staged, (unsigned)seed,
                   (staged_has(&staged, (unsigned)seed) ? staged.value : a->plant.si)[seed] +
                       (p->seed - 1.0));
    if (staged_count(&staged) == 0)
        return true;
    const char *reason = parameters_check(a, &staged);
    if (reason) {
        find_subject(a, &staged, subject);
        snprintf(why, TEST_REASON, "the case's parameters and settings do not fit: %s%s", subject, reason);
        return false;
    }
    (void)parameters_apply(a, &staged); /* it fits */
    if (!p->scene.scene.started) {
        a->plant.model->rest(a->plant.p, x);
        plant_set_state(&a->plant, x);
    }
    return scene_app_is_quiet(a, why);
}

/* Tells the readers a sample of a microscope. */
static void tell_sample(struct bench_plant *p, const struct plant *pl)
{
    double value[METRIC_SIGNALS];
    bench_microscope_read(pl, value);
    for (int k = 0; k < p->n_readers; k++)
        measurement_tick(p->reader[k], pl->now.tick, value);
}

/* Tells the readers the ticks of the block: many at once, since each then reads one array. */
static void tell_block(struct bench_plant *p)
{
    struct metric_block *b = &p->block;
    for (int k = 0; k < p->n_readers; k++)
        measurement_ticks(p->reader[k], b->first, b->n, b->value[p->reader[k]->set.signal],
                          b->tones ? b->drive : NULL);
    b->n = 0;
}

static void begin_measurements(struct bench_plant *p, const struct test_case *c)
{
    const struct plant *pl = &p->scene.app.plant;
    struct metric_setting set[VERDICT_MEASUREMENTS];
    uint32_t read = 0;
    p->n = p->n_judged = verdict_settings(c, set);
    verdict_truths(c, &set[p->n]);
    p->n += p->see->n_contacts > 0 ? BENCH_TRUTHS : 0;
    p->regime = pl->regime;
    p->contact.open = true;
    for (int i = 0; i < p->n; i++) {
        struct measurement *m = &p->measurement[i];
        measurement_begin(m, &set[i], pl->tick_s, pl->model->n_contacts > 0 && pl->regime == 0);
        if (!measurement_reads(m))
            continue;
        read |= 1u << set[i].signal;
        p->reader[p->n_readers++] = m;
    }
    if (p->see == &test_afm_view) {
        tell_sample(p, pl);
        return;
    }
    metric_block_begin(&p->block, pl, read);
    for (int k = 0; k < p->n_readers; k++)
        p->block.tones = p->block.tones || measurement_is_tone(p->reader[k]);
    (void)metric_block_add(&p->block, pl);
}

/* Contact switches of this tick in their order. After a
 * change of parameters the regime may be another without one. */
NEVER_INLINE void take_switches(struct bench_plant *p, const struct plant *pl)
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
    if (pl->counts.switches != p->switches || pl->regime != p->regime)
        take_switches(p, pl);
    if (p->n_readers && metric_block_add(&p->block, pl))
        tell_block(p);
}

static void observe_microscope(void *observer, const struct plant *pl)
{
    struct bench_plant *p = observer;
    test_afm_watch(&p->contact, bench_microscope_station(pl), pl->now.tick, p->measurement, p->n);
    if (p->n_readers)
        tell_sample(p, pl);
}

/* As contactplant run: a controller hears of it. */
static bool take_selftest(struct app *a, char *why)
{
    struct selftest_result r;
    snprintf(why, TEST_REASON, "no memory for the self-test");
    if (!selftest_of_host(&r))
        return false;
    app_take_selftest(a, &r);
    return true;
}

bool bench_plant_open(struct bench_plant *p, const struct test_file *t, const struct test_case *c,
                      const double *varied, char *why)
{
    p->c = c;
    p->see = t->scene.model;
    p->loops = t->loops;
    if (!make(&p->scene, t, c, varied, why))
        return false;
    p->scene.config.observe = p->see == &test_afm_view ? observe_microscope : observe;
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

/* The link has these faults from here on, and no others. */
static bool apply_faults(struct bench_plant *p, const struct test_act *act, char *why)
{
    p->link->n_rules = 0;
    return !strcmp(act->what.text, "none") ||
           fault_list_read(p->link, act->what.text, p->scene.config.frame_s, why);
}

/* No act is a drive or sample that the bus would refuse. */
static bool act_fits(const struct plant *pl, const struct test_act *act, char *why)
{
    double hz = act->what.value[DRIVE_FREQUENCY];
    const struct signal *input = &pl->model->input_signal[act->what.input];
    double limit = DRIVE_LIMIT * scale_of(&pl->scale, input->quantity);
    if (act->what.given >> DRIVE_FREQUENCY & 1u && hz * pl->tick_s * DRIVE_TICKS_MIN > 1.0) {
        snprintf(why, SCENE_REASON, "arm: " DRIVE_TICKS_TOO_FEW "%g Hz; more substeps", hz);
        return false;
    }
    double armed = act->what.given >> DRIVE_AMPLITUDE & 1u ? act->what.value[DRIVE_AMPLITUDE] : 0.0;
    double size = fabs(act->what.verb == ACTION_STREAM ? act->what.sample : armed);
    if (size > limit)
        snprintf(why, SCENE_REASON, "%s takes at most %g %s", input->name, limit, input->unit);
    return size <= limit;
}

/* ---- what happens ---- */

/* A set of values, as PARAM_COMMIT would apply it. */
static bool apply_set(struct bench_plant *p, const struct test_act *act, char *why)
{
    struct app *a = &p->scene.app;
    char subject[SCENE_SUBJECT];
    struct staged staged;
    memset(&staged, 0, sizeof staged);
    for (int i = 0; i < act->what.n; i++)
        staged_put(&staged, act->what.set[i].index, act->what.set[i].value);
    const char *reason = parameters_check(a, &staged);
    find_subject(a, &staged, subject);
    if (!reason && p->loops)
        reason = bench_microscope_check_set(&a->plant, &staged, subject);
    if (reason)
        snprintf(why, TEST_REASON, "set at %g s does not fit: %s%s", act->at_s, subject, reason);
    else
        (void)parameters_apply(a, &staged); /* it fits */
    return !reason;
}

static bool apply(struct bench_plant *p, const struct test_act *act, char *why)
{
    struct app *a = &p->scene.app;
    switch (act->what.verb) {
    case ACTION_SET:
        return apply_set(p, act, why);
    case ACTION_FAULTS:
        return apply_faults(p, act, why);
    case ACTION_STREAM:
        plant_sample(&a->plant, act->what.input, act->what.sample, 0);
        break;
    case ACTION_FIRE_INPUT: /* put_fires */
        return true;
    default:
        if (act->waits)
            return true;
        plant_set_drive(&a->plant, act->what.input, act->what.given, act->what.value);
    }
    a->plant.counts.changes++;
    return true;
}

static struct fire fire_of(const struct test_act *act, double tick_s)
{
    struct fire f = {.at = test_instant(act, tick_s), .channels = (uint8_t)(1u << act->what.input)};
    f.received_tick = f.at.tick;
    f.armed[act->what.input].given = (uint8_t)act->what.given;
    memcpy(f.armed[act->what.input].value, act->what.value, sizeof act->what.value);
    return f;
}

static bool waits_in(const struct mailbox *b, const struct fire *f, int input)
{
    const struct armed *mine = &f->armed[input];
    for (uint32_t i = 0; i < b->n_fires; i++) {
        const struct armed *there = &b->fire[i].armed[input];
        if (!instant_compare(b->fire[i].at, f->at) && b->fire[i].channels == f->channels &&
            there->given == mine->given && !memcmp(there->value, mine->value, sizeof mine->value))
            return true;
    }
    return false;
}

/* Passes over the fires whose instants are over. Where a time-out or a stop emptied the mailbox in the very
 * frame of one, it did not act. */
static bool settle_fires(struct bench_plant *p, char *why)
{
    const struct app *a = &p->scene.app;
    uint32_t passed = 0, applied = a->count[DIAG_FIRE_APPLIED] - p->fired;
    p->fired = a->count[DIAG_FIRE_APPLIED];
    for (; p->next_fire < p->c->n_acts; p->next_fire++) {
        const struct test_act *act = &p->c->act[p->next_fire];
        if (act->what.verb != ACTION_FIRE_INPUT)
            continue;
        if (test_instant(act, a->plant.tick_s).tick >= a->plant.now.tick)
            return true;
        if (++passed > applied) {
            snprintf(why, TEST_REASON, "fire at %g s did not act: a time-out or stop of that frame forgot it",
                     act->at_s);
            return false;
        }
    }
    return true;
}

/* The fires of the coming frame wait where those of the controller do. A stop or time-out forgets them there;
 * while plant time is before its instant, a fire is put there again. */
static bool put_fires(struct bench_plant *p, char *why)
{
    struct app *a = &p->scene.app;
    for (int i = p->next_fire; i < p->c->n_acts; i++) {
        const struct test_act *act = &p->c->act[i];
        if (act->what.verb != ACTION_FIRE_INPUT)
            continue;
        struct fire f = fire_of(act, a->plant.tick_s);
        if (f.at.tick >= a->plant.now.tick + a->config.substeps)
            return true;
        if (!waits_in(&a->mailbox, &f, act->what.input) && !mailbox_put_fire(&a->mailbox, &f)) {
            snprintf(why, TEST_REASON, "fire at %g s: the controller has %d fires waiting, and no more fit",
                     act->at_s, MAILBOX_FIRES);
            return false;
        }
    }
    return true;
}

bool bench_plant_act(struct bench_plant *p, char *why)
{
    if (!settle_fires(p, why) || !put_fires(p, why))
        return false;
    for (; p->next_act < p->c->n_acts; p->next_act++) {
        const struct test_act *act = &p->c->act[p->next_act];
        if (ticks_begun(act->at_s, p->scene.app.plant.tick_s) > p->scene.app.plant.now.tick)
            return true;
        if (!apply(p, act, why))
            return false;
    }
    return true;
}

bool bench_has_faults(const struct test_case *c)
{
    bool has = *c->link;
    for (int i = 0; i < c->n_acts; i++)
        has = has || c->act[i].what.verb == ACTION_FAULTS;
    return has;
}

bool bench_approve(const struct test_file *t, const struct test_case *c, char *why)
{
    static struct bench_plant p;
    static struct faults faults;
    static const struct hal none = {0};
    char reason[SCENE_REASON];
    memset(&p, 0, sizeof p);
    const char *refused = t->scene.model == &test_afm_view ? test_afm_refuse(c) : NULL;
    snprintf(reason, sizeof reason, "%s", refused ? refused : "");
    bool good = !refused && bench_plant_open(&p, t, c, c->varied >= 0 ? &c->vary.to : NULL, reason);
    faults_init(&faults, &none, 1);
    if (good && *c->link)
        good = fault_list_read(&faults, c->link, p.scene.config.frame_s, reason);
    p.link = &faults;
    for (int i = 0; good && i < c->n_acts; i++)
        good = c->act[i].what.verb != ACTION_FAULTS || apply_faults(&p, &c->act[i], reason);
    for (int i = 0; good && t->loops && i < c->n_acts; i++)
        good = apply(&p, &c->act[i], reason);
    for (int i = 0; good && i < c->n_acts; i++)
        good = act_fits(&p.scene.app.plant, &c->act[i], reason);
    bench_plant_close(&p);
    return good ? true : scene_text_wrong(t->file, c->line, why, "[case %s]: %.400s", c->name, reason);
}

/* The reading of a metric of controller or run, now. */
static double look(enum metric_kind kind, const struct app *a, const struct bench_link *l)
{
    switch (kind) {
    case METRIC_MALFORMED:
        return l->malformed;
    case METRIC_STOPPED:
        return l->stopped_s;
    case METRIC_FAULTS:
        return metric_faults(a->faults);
    case METRIC_SILENCE:
        return a->enabled ? (double)session_command_age(a) * a->config.frame_s : 0.0;
    case METRIC_RESIDUAL:
        return fabs(plant_residual(&a->plant));
    default:
        return metric_count(kind, a->count);
    }
}

void bench_plant_frame(struct bench_plant *p, const struct bench_link *l)
{
    const struct app *a = &p->scene.app;
    tell_block(p);
    for (int k = 0; k < p->n; k++) {
        struct measurement *m = &p->measurement[k];
        enum metric_of of = metric_table[m->set.kind].of;
        if (of == OF_CONTROLLER || of == OF_RUN)
            measurement_frame(m, plant_time(&a->plant), look(m->set.kind, a, l));
    }
    p->faults |= a->faults & ~(unsigned)FAULT_TIMEOUT;
}

const char *bench_plant_state(const struct bench_plant *p)
{
    const char *name = names_text(p->scene.config.model, NAMES_STATE, (unsigned)p->scene.app.state);
    return name ? name : "?";
}

void bench_plant_judge(struct bench_plant *p, const struct test_case *c, struct bench_result *r)
{
    const struct plant *pl = &p->scene.app.plant;
    const struct evidence e = {plant_time(pl),
                               !pl->model ? 0
                               : p->loops ? bench_microscope_hash(pl)
                                          : plant_hash(pl),
                               p->faults, p->scene.app.count};
    verdict_judge(&e, c, p->measurement, p->n_judged, r);
    for (int i = p->n_judged; i < p->n; i++)
        measurement_end(&p->measurement[i], e.now_s, 0, &r->truth[i - p->n_judged]);
}
