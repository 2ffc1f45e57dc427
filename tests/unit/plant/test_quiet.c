/* test_quiet.c - quiet ticks: the bits of a motion do not depend on how its time is cut into parts.
 *
 * Two plants take the same commands. One runs tick by tick and takes every tick the general way. The other
 * runs in parts of random length, and takes quiet ticks in runs. All that they hold beyond scratch is
 * compared after each part. */
#include "tests/unit/test.h"

#include <string.h>
#include "models/models.h"
#include "tests/fixture/any_motion.h"

enum { RUNS = 400, PARTS = 25, LONGEST = 90 };

static double alone_scratch[METHOD_SCRATCH], parts_scratch[METHOD_SCRATCH], kept_scratch[METHOD_SCRATCH];
static struct plant alone, parts;
static struct stages alone_stages, parts_stages, kept_stages;
static bool has_stages;

/* A tick in which a silent input may have been told something is not quiet. (Where all sound it may be.) */
static bool general_tick(void)
{
    for (int i = 0; i < MODEL_INPUTS; i++)
        if (!((alone.segment.active >> i) & 1u))
            (void)plant_touch_drive(&alone, i);
    return plant_advance(&alone, (struct instant){alone.now.tick + 1, 0});
}

static bool run_alone(uint64_t ticks, uint32_t fraction)
{
    struct instant to = {alone.now.tick + ticks, fraction};
    while (alone.now.tick < to.tick)
        if (!general_tick())
            return false;
    return plant_advance(&alone, to);
}

enum outcome { SAME, DIFFERS, BOTH_FAILED };

/* The plant that is seen at the end of a tick is where the other one stands. */
static void compare(void *n_differ, const struct plant *pl)
{
    bool good = general_tick() && pl->now.tick == alone.now.tick && pl->regime == alone.regime &&
                pl->counts.switches == alone.counts.switches && memcmp(pl->x, alone.x, sizeof pl->x) == 0 &&
                memcmp(pl->segment.at[2], alone.segment.at[2], sizeof pl->segment.at[2]) == 0;
    for (int i = 0; i < pl->model->n_inputs; i++)
        good =
            good && pl->drive[i].cosine == alone.drive[i].cosine && pl->drive[i].sine == alone.drive[i].sine;
    *(int *)n_differ += !good;
}

static enum outcome run_seen(uint32_t ticks)
{
    uint64_t to = alone.now.tick + ticks;
    int n_differ = 0;
    bool good = plant_run_seen(&parts, ticks, compare, NULL, &n_differ);
    if (n_differ > 0 || (good && alone.now.tick != to))
        return DIFFERS;
    return good ? SAME : general_tick() ? DIFFERS : BOTH_FAILED;
}

/* Samples that are told ahead, some of them 0, against each told at its instant. */
static enum outcome run_samples(void)
{
    enum { SAMPLES = 40 };
    double value[SAMPLES];
    uint32_t n = 1 + any_pick(SAMPLES), each = 1 + any_pick(3);
    int i = (int)any_pick((uint32_t)alone.model->n_inputs);
    double unit = scale_of(&alone.scale, alone.model->input_signal[i].quantity);
    double ramp_s = any_pick(SAMPLES) * alone.tick_s;
    uint32_t before = any_pick(4);
    bool one = true;
    if (before == 0) { /* no other input sounds */
        plant_reset(&alone);
        plant_reset(&parts);
    } else if (before == 1) { /* all fall silent on the way */
        plant_drives_to_zero(&alone, ramp_s);
        plant_drives_to_zero(&parts, ramp_s);
    }
    for (uint32_t k = 0; k < n; k++)
        value[k] = any_pick(8) == 0 ? 0.0 : any_between(-0.01, 0.01) * unit;
    for (uint32_t k = 0; k < n && one; k++) {
        plant_sample(&alone, i, value[k], 0);
        one = run_alone(each, 0);
    }
    bool other = plant_run_samples(&parts, i, value, n, each);
    return one != other ? DIFFERS : one ? SAME : BOTH_FAILED;
}

static enum outcome run_to(uint32_t ticks, uint32_t fraction)
{
    bool one = run_alone(ticks, fraction);
    bool other = plant_advance(&parts, (struct instant){parts.now.tick + ticks, fraction});
    return one != other ? DIFFERS : one ? SAME : BOTH_FAILED;
}

/* A snapshot is a copy of the plant and its scratch: what
 * follows does not depend on what was tried in between. */
static void try_and_return(void)
{
    struct plant copy = parts;
    memcpy(kept_scratch, parts_scratch, sizeof kept_scratch);
    kept_stages = parts_stages;
    (void)!plant_run(&parts, 40);
    parts = copy;
    parts_stages = kept_stages;
    memcpy(parts_scratch, kept_scratch, sizeof kept_scratch);
}

static enum outcome part(void)
{
    uint32_t ticks = 1 + any_pick(LONGEST), fraction = any_pick(4) == 0 ? any_pick(65536) : 0;
    bool seen = fraction == 0 && alone.now.fraction == 0 && any_pick(2) == 0;
    enum outcome end = !seen ? run_to(ticks, fraction) : any_pick(2) == 0 ? run_samples() : run_seen(ticks);
    if (any_pick(8) == 0)
        try_and_return();
    return end == SAME && !any_same(&alone, &parts) ? DIFFERS : end;
}

static void command_both(void)
{
    uint32_t kind = any_pick(has_stages ? 10 : 9), i = any_pick((uint32_t)alone.model->n_inputs);
    double a = any_between(0.0, 1.0), b = any_between(0.0, 1.0);
    any_command(&alone, kind, (int)i, a, b);
    any_command(&parts, kind, (int)i, a, b);
}

/* Random parts with random commands between them. False when this method refuses the model. */
static bool run_both(const struct model *m, const struct method *method, enum outcome *end)
{
    double tick_s = any_tick_s(m);
    if (!any_start(&alone, m, method, tick_s, alone_scratch, &alone_stages) ||
        !any_start(&parts, m, method, tick_s, parts_scratch, &parts_stages))
        return false;
    if (has_stages) {
        int i = (int)any_pick((uint32_t)m->n_inputs);
        double a = any_between(0.0, 1.0);
        any_set_stages(&alone, i, a, 0.5);
        any_set_stages(&parts, i, a, 0.5);
    }
    *end = SAME;
    for (int k = 0; k < PARTS && *end == SAME; k++) {
        if (any_pick(3) == 0)
            command_both();
        *end = part();
    }
    return true;
}

static void run_all(void)
{
    enum outcome end;
    int n_runs = 0, n_differ = 0, n_failed = 0;
    uint64_t switches = 0, ticks = 0;
    any_seed = 1;
    for (int i = 0; n_runs < RUNS; i++) {
        if (!run_both(model_table[i % MODELS], method_table[i / MODELS % METHODS], &end))
            continue;
        n_runs++;
        n_differ += end == DIFFERS;
        n_failed += end == BOTH_FAILED;
        switches += parts.counts.switches;
        ticks += parts.now.tick;
    }
    check_int("motions", n_runs, RUNS);
    check_int("motions whose bits depend on their parts", n_differ, 0);
    check_below("motions that left the finite numbers, in both", n_failed, RUNS / 4);
    check_above("ticks", (double)ticks, 3e5);
    check_above("contact switches among them", (double)switches, 1e3);
}

/* 400 motions of 25 parts: 10,000 subdivisions, of every model by every method that takes it. */
TEST(quiet_subdivisions)
{
    has_stages = false;
    run_all();
}

/* With actuators and sensors, which also change between the parts. */
TEST(quiet_stages)
{
    has_stages = true;
    run_all();
}
