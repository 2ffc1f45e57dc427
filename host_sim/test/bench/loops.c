/* loops.c - see loops.h. */
#include "host_sim/test/bench/loops.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/files.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/test/bench/bench_microscope.h"
#include "host_sim/test/bench/bench_plant.h"
#include "host_sim/test/bench/controller.h"

struct loops {
    struct bench_plant plant;
    uint64_t log_every; /* ticks: a row each period of the lever */
    FILE *log;          /* or NULL */
};

static bool of_a_bus(const struct action_set *set, int n)
{
    for (int i = 0; i < n; i++)
        if (set[i].index >= AFM_PLANT_SCAN)
            return true;
    return false;
}

/* NULL, or which lines of a case are about a bus. */
static const char *refuse(const struct test_file *t, const struct test_case *c)
{
    bool settings = of_a_bus(t->plant.set, t->plant.n) || of_a_bus(c->plant.set, c->plant.n) ||
                    c->varied >= AFM_PLANT_SCAN;
    if (c->plant.rate_Hz > 0.0 || c->plant.substeps)
        return "rate and substeps are a bus's; a microscope has ticks, its lever's in a sample";
    if (*c->link || *c->golden)
        return "link and golden are a bus's, and a microscope has none";
    for (int i = 0; i < c->n_acts; i++) {
        if (c->act[i].what.verb != ACTION_SET && c->act[i].what.verb != ACTION_STREAM)
            return "at: a microscope has no arm and no faults; write set drive=20 nm, or stream x 1 um, say";
        settings = settings || of_a_bus(c->act[i].what.set, c->act[i].what.n);
    }
    for (int i = 0; i < c->n_expects; i++)
        if (metric_table[c->expect[i].what.kind].of == OF_CONTROLLER)
            return "expect: refused to stopped are about a bus; builtin = loops has none";
    return settings
               ? "scan, ramp_speed, ramp_dwell and settings are commands over a bus; builtin = loops has none"
               : NULL;
}

bool loops_approve(const struct test_file *t, const struct test_case *c, char *why)
{
    const char *reason = refuse(t, c);
    return reason ? scene_text_wrong(t->file, c->line, why, "[case %s]: %.400s", c->name, reason)
                  : bench_approve(t, c, why);
}

/* ---- a run ---- */

static bool open_log(struct loops *b, const struct bench_setting *s, struct bench_result *r)
{
    const struct plant *pl = &b->plant.scene.app.plant;
    char path[BENCH_PATH], name[METRIC_UNIT];
    if (!s->log)
        return true;
    uint64_t each = (uint64_t)lround(1.0 / (pl->si[LEVER_F0] * pl->tick_s));
    b->log_every = each ? each : 1;
    controller_log_path(s, r, ".csv", path);
    b->log = files_create(path);
    if (!b->log)
        return controller_fail(r, "--log: cannot write %.400s: %s", path, strerror(errno));
    fprintf(b->log, "time_s");
    for (int i = 0; i <= VIEW_OUTPUTS + VIEW_INPUTS; i++) {
        metric_signal_name(&test_afm_view, i, name);
        fprintf(b->log, ",%s_%s", name, metric_signal(&test_afm_view, i)->unit);
    }
    fprintf(b->log, "\n");
    return true;
}

static void put_row(struct loops *b)
{
    const struct plant *pl = &b->plant.scene.app.plant;
    double value[METRIC_SIGNALS];
    if (!b->log || pl->now.tick % b->log_every)
        return;
    bench_microscope_read(pl, value);
    fprintf(b->log, "%.9g", plant_time(pl));
    for (int i = 0; i <= VIEW_OUTPUTS + VIEW_INPUTS; i++)
        fprintf(b->log, ",%.9g", value[i]);
    fprintf(b->log, "\n");
}

static void run_samples(struct loops *b, struct bench_result *r)
{
    struct plant *pl = &b->plant.scene.app.plant;
    char why[CONTROLLER_REASON];
    uint64_t samples = ticks_begun(b->plant.c->over_s, pl->tick_s);
    put_row(b);
    while (pl->now.tick < samples) {
        bool done = bench_plant_act(&b->plant, why);
        if (done && !plant_run_seen(pl, 1, b->plant.scene.config.observe, NULL, &b->plant)) {
            snprintf(why, sizeof why, "the motion left the finite numbers; take more substeps or less ki");
            done = false;
        }
        if (!done) {
            (void)controller_fail(r, "%s%s", why, "");
            return;
        }
        put_row(b);
    }
}

void loops_run(const struct bench_setting *s, struct bench_result *r)
{
    static struct loops b; /* large: not on the stack */
    static const struct bench_link none = {0.0, -1.0};
    const struct test_case *c = &s->test->cases[r->i_case];
    const struct app *a = &b.plant.scene.app;
    char why[CONTROLLER_REASON];
    double begin_s = clock_now_s();
    memset(&b, 0, sizeof b);
    b.plant.seed = r->seed;
    if (!bench_plant_open(&b.plant, s->test, c, r->varied ? &r->varied_value : NULL, why))
        (void)controller_fail(r, "%s%s", why, "");
    else if (open_log(&b, s, r))
        run_samples(&b, r);
    bench_plant_frame(&b.plant, &none);
    r->plant_s = plant_time(&a->plant);
    bench_plant_judge(&b.plant, c, r);
    if (b.log && !files_finish(b.log, true))
        (void)controller_fail(r, "--log: %s%s", files_unwritten(errno), "");
    bench_plant_close(&b.plant);
    r->took_s = clock_now_s() - begin_s;
}
