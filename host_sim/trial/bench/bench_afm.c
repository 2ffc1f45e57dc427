/* bench_afm.c - see bench_afm.h. */
#include "host_sim/trial/bench/bench_afm.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/afm/afm_plant.h"
#include "firmware/plant/hash.h"
#include "host_sim/afm/afm_bench.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/files.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/trial/bench/controller.h"
#include "host_sim/trial/trial_afm.h"
#include "host_sim/trial/verdict.h"
#include "models/math/elementary.h"

enum { REASON = 512 };

struct bench_afm {
    const struct trial_case *c;
    double si[LEVER_PARAMETERS], number[STATION_NUMBERS];
    struct station_config config;
    struct stage piezo, sensor;
    struct station station;
    struct microscope_in in;
    int next_act, n;
    struct measurement measurement[VERDICT_MEASUREMENTS];
    uint64_t sample; /* now */
    struct trial_afm contact;
    FILE *log;
};

/* ---- set-up ---- */

static void put_number(struct bench_afm *b, const struct action_set *set)
{
    if (set->index < AFM_PLANT_NUMBERS)
        b->si[set->index] = set->value;
    else if (set->index < AFM_PLANT_SCAN)
        b->number[set->index - AFM_PLANT_NUMBERS] = set->value;
}

static const char of_a_bus[] =
    "scan, ramp_speed, ramp_dwell and settings are commands over a bus; builtin = loops has none";

static bool beyond(const struct action_set *set, int n)
{
    for (int i = 0; i < n; i++)
        if (set[i].index >= AFM_PLANT_SCAN)
            return true;
    return false;
}

/* Lines of a file that are about a bus. */
static const char *refuse_bus(const struct trial_case *c)
{
    if (c->plant.rate_Hz > 0.0 || c->plant.substeps)
        return "rate and substeps are a bus's; a microscope has ticks, its lever's in a sample";
    if (*c->link || *c->golden)
        return "link and golden are a bus's, and a microscope has none";
    for (int i = 0; i < c->n_acts; i++)
        if (c->act[i].what.verb != ACTION_SET && c->act[i].what.verb != ACTION_STREAM)
            return "at: a microscope has no arm and no faults; write set drive=20 nm, or stream x 1 um, say";
    for (int i = 0; i < c->n_expects; i++)
        if (metric_table[c->expect[i].what.kind].of == OF_CONTROLLER)
            return "expect: refused to stopped are about a bus; builtin = loops has none";
    if (beyond(c->plant.set, c->plant.n) || (c->varied >= AFM_PLANT_SCAN))
        return of_a_bus;
    for (int i = 0; i < c->n_acts; i++)
        if (beyond(c->act[i].what.set, c->act[i].what.n))
            return of_a_bus;
    return trial_afm_refuse(c);
}

/* NULL, or the reason of a refusal. */
static const char *open_station(struct bench_afm *b, const struct trial *t, const double *varied, double seed,
                                char why[REASON])
{
    struct harmonic unused[MODEL_INPUTS];
    double si[MODEL_PARAMETERS];
    int which;
    scenes_resolve(&t->lever, si, unused);
    memcpy(b->si, si, sizeof b->si);
    station_defaults(b->number);
    for (int i = 0; i < t->plant.n; i++)
        put_number(b, &t->plant.set[i]);
    for (int i = 0; i < b->c->plant.n; i++)
        put_number(b, &b->c->plant.set[i]);
    if (varied)
        put_number(b, &(struct action_set){(unsigned)b->c->varied, *varied});
    b->si[LEVER_SEED] += seed - 1.0;
    b->config = (struct station_config){
        .si = b->si, .number = b->number, .tick_s = t->lever.frame_s / t->lever.substeps / t->lever.dilation};
    const char *reason = afm_bench_stages(&t->lever, b->si, &b->config, &b->piezo, &b->sensor);
    if (reason)
        return reason;
    reason = station_check(&b->config, &which);
    if (!reason)
        return station_init(&b->station, &b->config);
    snprintf(why, REASON, "%s %s", station_number[which].name, reason);
    return why;
}

static const char *open_bench(struct bench_afm *b, const struct trial *t, const struct trial_case *c,
                              const double *varied, double seed, char why[REASON])
{
    memset(b, 0, sizeof *b);
    b->c = c;
    const char *reason = beyond(t->plant.set, t->plant.n) ? of_a_bus : refuse_bus(c);
    return reason ? reason : open_station(b, t, varied, seed, why);
}

/* ---- what happens ---- */

static const char *apply(struct bench_afm *b, const struct trial_act *act, char why[REASON])
{
    double *const to[VIEW_INPUTS] = {&b->in.force_N, &b->in.z_m, &b->in.x_m, &b->in.y_m};
    int which;
    if (act->what.verb == ACTION_STREAM) {
        *to[act->what.input] = act->what.sample;
        return NULL;
    }
    for (int i = 0; i < act->what.n; i++)
        put_number(b, &act->what.set[i]);
    const char *reason = station_change(&b->station, &b->config, &which);
    if (!reason)
        return NULL;
    snprintf(why, REASON, "at %g s: set: %s %s", act->at_s, station_number[which].name, reason);
    return why;
}

/* Does what the lines up to this sample say. */
static const char *act(struct bench_afm *b, uint64_t sample, char why[REASON])
{
    const char *reason = NULL;
    for (; !reason && b->next_act < b->c->n_acts; b->next_act++) {
        if (ticks_begun(b->c->act[b->next_act].at_s, b->station.sample_s) > sample)
            break;
        reason = apply(b, &b->c->act[b->next_act], why);
    }
    return reason;
}

bool bench_afm_approve(const struct trial *t, const struct trial_case *c, char *why)
{
    static struct bench_afm b; /* large: not on the stack */
    char text[REASON];
    const char *reason = open_bench(&b, t, c, NULL, 1.0, text);
    if (!reason && c->varied >= 0)
        reason = open_bench(&b, t, c, &c->vary_to, 1.0, text);
    reason = reason ? reason : act(&b, UINT64_MAX, text);
    return !reason || scene_text_wrong(t->file, c->line, why, "[case %s]: %.400s", c->name, reason);
}

/* ---- what is measured ---- */

static void measure(struct bench_afm *b)
{
    double value[METRIC_SIGNALS];
    trial_afm_read(&b->station, &b->in, value);
    trial_afm_watch(&b->contact, &b->station, b->sample, b->measurement, b->n);
    for (int i = 0; i < b->n; i++)
        measurement_tick(&b->measurement[i], b->sample, value);
    /* a row each period of the lever */
    uint64_t each = (uint64_t)lround(1.0 / (b->si[LEVER_F0] * b->station.sample_s));
    if (!b->log || b->sample % (each ? each : 1))
        return;
    fprintf(b->log, "%.9g", (double)b->sample * b->station.sample_s);
    for (int i = 0; i <= VIEW_OUTPUTS + VIEW_INPUTS; i++)
        fprintf(b->log, ",%.9g", value[i]);
    fprintf(b->log, "\n");
}

static void begin_measurements(struct bench_afm *b)
{
    struct metric_setting set[VERDICT_MEASUREMENTS];
    b->n = verdict_settings(b->c, set);
    b->contact.open = true;
    for (int i = 0; i < b->n; i++)
        measurement_begin(&b->measurement[i], &set[i], b->station.sample_s, true);
    measure(b);
}

/* ---- a run ---- */

static bool open_log(struct bench_afm *b, const struct bench_setting *s, struct bench_result *r)
{
    char path[BENCH_PATH], name[METRIC_UNIT];
    if (!s->log)
        return true;
    controller_log_path(s, r, ".csv", path);
    b->log = files_create(path);
    if (!b->log)
        return controller_fail(r, "--log: cannot write %.400s: %s", path, strerror(errno));
    fprintf(b->log, "time_s");
    for (int i = 0; i <= VIEW_OUTPUTS + VIEW_INPUTS; i++) {
        metric_signal_name(&trial_afm_view, i, name);
        fprintf(b->log, ",%s_%s", name, metric_signal(&trial_afm_view, i)->unit);
    }
    fprintf(b->log, "\n");
    return true;
}

static void run_samples(struct bench_afm *b, struct bench_result *r)
{
    char why[REASON];
    uint64_t samples = ticks_begun(b->c->over_s, b->station.sample_s);
    begin_measurements(b);
    while (b->sample < samples) {
        const char *reason = act(b, b->sample, why);
        if (!reason && !station_run(&b->station, &b->in))
            reason = "the motion left the finite numbers; take more substeps or less ki";
        if (reason) {
            (void)controller_fail(r, "%s%s", reason, "");
            return;
        }
        b->sample++;
        measure(b);
    }
}

static void judge(struct bench_afm *b, struct bench_result *r)
{
    static const uint32_t none[DIAG_COUNTERS];
    for (int i = 0; i < b->n; i++)
        measurement_frame(&b->measurement[i], r->plant_s, 0.0); /* nothing of a bus ever comes about */
    const struct evidence e = {&trial_afm_view, r->plant_s, station_hash(&b->station, HASH_BEGIN), 0, none};
    verdict_judge(&e, b->c, b->measurement, b->n, r);
}

void bench_afm_run(const struct bench_setting *s, struct bench_result *r)
{
    static struct bench_afm b; /* large: not on the stack */
    char why[REASON];
    double begin_s = clock_now_s();
    const struct trial_case *c = &s->trial->cases[r->i_case];
    const char *reason = open_bench(&b, s->trial, c, r->varied ? &r->varied_value : NULL, r->seed, why);
    if (reason)
        (void)controller_fail(r, "%s%s", reason, "");
    else if (open_log(&b, s, r))
        run_samples(&b, r);
    r->plant_s = (double)b.sample * b.station.sample_s;
    judge(&b, r);
    if (b.log && fclose(b.log) != 0)
        (void)controller_fail(r, "--log: %s%s", strerror(errno), "");
    r->took_s = clock_now_s() - begin_s;
}
