/* test_quiet.c - quiet ticks: the bits of a motion do not depend on how its time is cut into parts.
 *
 * Two plants take the same commands. One runs tick by tick and takes every tick the general way. The other
 * runs in parts of random length, and takes quiet ticks in runs. All that they hold beyond scratch is
 * compared after each part. */
#include "tests/unit/test.h"

#include <string.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "firmware/stage/stages.h"
#include "models/afm_lever.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "tests/fixture/exact.h"

enum { RUNS = 400, PARTS = 25, LONGEST = 90 };

static double alone_scratch[METHOD_SCRATCH], parts_scratch[METHOD_SCRATCH], kept_scratch[METHOD_SCRATCH];
static struct plant alone, parts;
static struct stages alone_stages, parts_stages, kept_stages;
static bool has_stages;
static uint64_t quiet_seed;

static double between(double low, double high)
{
    return low + (high - low) * exact_uniform(&quiet_seed);
}

static uint32_t pick(uint32_t n)
{
    return (uint32_t)between(0.0, (double)n);
}

/* A lever is warm: each of its ticks has a noise of its own. */
static bool start_quiet(struct plant *pl, const struct model *m, const struct method *method, double tick_s,
                        double *scratch, struct stages *stages)
{
    double si[MODEL_PARAMETERS];
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    if (m->modal_form)
        si[LEVER_TEMPERATURE] = 295.0;
    struct plant_config c = {.model = m,
                             .si = si,
                             .method = method,
                             .tick_s = tick_s,
                             .dilation = 1.0,
                             .tol = 1e-3,
                             .scratch = scratch,
                             .stage_calls = &stages_for_plants,
                             .stages = stages};
    return plant_init(pl, &c) == NULL;
}

/* A resonant actuator before an input and a noisy, late
 * sensor behind an output; more or fewer of both by `a`. */
static void set_stages(struct plant *pl, int i, double a, double b)
{
    const double tick_s = pl->tick_s / pl->dilation;
    double setting[SETTINGS];
    for (int k = 0; k < SETTINGS; k++)
        setting[k] = setting_table[k].initial;
    double *actuator = &setting[SET_STAGE], *sensor = &setting[SET_STAGE + STAGE_SETTINGS];
    actuator[STAGE_AT] = a > 0.1 ? 1.0 + i : 0.0;
    actuator[STAGE_SET_GAIN] = 1.0 + 0.1 * b;
    actuator[STAGE_SET_CREEP] = 0.02;
    actuator[STAGE_SET_RESONANCE] = 0.05 * b / tick_s;
    actuator[STAGE_SET_DELAY] = 3.0 * a;
    sensor[STAGE_AT] = a < 0.9 ? 1.0 + MODEL_INPUTS + i : 0.0;
    sensor[STAGE_SET_LAG] = 0.01 / tick_s;
    sensor[STAGE_SET_NOISE] = 1e-9;
    sensor[STAGE_SET_DELAY] = 20.0 * b;
    if (!stages_for_plants.refuse(pl->model, tick_s, setting))
        stages_for_plants.change(pl->stages, pl, setting);
}

/* One command for both: a drive with a ramp or without,
 * a sample, noise, other parameters, a state, silence. */
static void command(struct plant *pl, uint32_t kind, int i, double a, double b)
{
    double unit = scale_of(&pl->scale, pl->model->input_signal[i].quantity),
           hz = b < 0.2 ? 0.0 : (0.002 + 0.05 * b) / pl->tick_s;
    double si[MODEL_PARAMETERS], x[MODEL_STATES];
    switch (kind) {
    case 0:
    case 1:
    case 2:
        plant_drive(pl, i, 2.0 * a * unit, hz, 6.0 * a, pl->tick_s * (kind == 0 ? 0.0 : 40.0 * b));
        break;
    case 3:
        plant_sample(pl, i, 0.3 * a * unit, (uint64_t)((a < 0.5 ? 9.0 : 90.0) * b));
        break;
    case 4:
        plant_noise(pl, i, 0.01 * a * unit, 1 + (uint32_t)(4.0 * b), 7, 0.0);
        break;
    case 5:
        memcpy(si, pl->si, sizeof si);
        si[0] *= 1.0 + 0.01 * a;
        if (plant_change(pl, si))
            return;
        break;
    case 6:
        memcpy(x, pl->x, sizeof x);
        x[0] *= 1.0 - 0.1 * a;
        plant_set_state(pl, x);
        break;
    case 7:
        plant_drives_to_zero(pl, pl->tick_s * 30.0 * b);
        break;
    case 9:
        set_stages(pl, i, a, b);
        break;
    default:
        plant_noise(pl, i, 0.0, 1, 0, 0.0);
    }
}

/* All that a plant holds; the segment is scratch but for the inputs at its end. */
static bool same(const struct plant *a, const struct plant *b)
{
    bool good = plant_hash(a) == plant_hash(b) && memcmp(&a->counts, &b->counts, sizeof a->counts) == 0;
    good = good && a->peak_force == b->peak_force && a->total_time == b->total_time &&
           a->loss_time == b->loss_time;
    good = good && memcmp(a->segment.at[2], b->segment.at[2], sizeof a->segment.at[2]) == 0;
    good = good && a->ledger.gross == b->ledger.gross && a->ledger.flow.force == b->ledger.flow.force;
    good = good && memcmp(a->event, b->event, sizeof a->event) == 0 && a->n_event == b->n_event;
    for (int i = 0; i < a->model->n_inputs; i++)
        good = good && a->drive[i].cosine == b->drive[i].cosine &&
               a->drive[i].resync_left == b->drive[i].resync_left;
    return good;
}

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
    uint32_t n = 1 + pick(SAMPLES), each = 1 + pick(3);
    int i = (int)pick((uint32_t)alone.model->n_inputs);
    double unit = scale_of(&alone.scale, alone.model->input_signal[i].quantity);
    double ramp_s = pick(SAMPLES) * alone.tick_s;
    uint32_t before = pick(4);
    bool one = true;
    if (before == 0) { /* no other input sounds */
        plant_reset(&alone);
        plant_reset(&parts);
    } else if (before == 1) { /* all fall silent on the way */
        plant_drives_to_zero(&alone, ramp_s);
        plant_drives_to_zero(&parts, ramp_s);
    }
    for (uint32_t k = 0; k < n; k++)
        value[k] = pick(8) == 0 ? 0.0 : between(-0.01, 0.01) * unit;
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
    uint32_t ticks = 1 + pick(LONGEST), fraction = pick(4) == 0 ? pick(65536) : 0;
    bool seen = fraction == 0 && alone.now.fraction == 0 && pick(2) == 0;
    enum outcome end = !seen ? run_to(ticks, fraction) : pick(2) == 0 ? run_samples() : run_seen(ticks);
    if (pick(8) == 0)
        try_and_return();
    return end == SAME && !same(&alone, &parts) ? DIFFERS : end;
}

/* 0.02 to 0.15 of the eigenfrequency's radian a tick. */
static double tick_of(const struct model *m)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    m->prepare(si, p, &scale);
    return between(0.02, 0.15) / m->eigenfrequency(p) * scale.time_s;
}

static void command_both(void)
{
    uint32_t kind = pick(has_stages ? 10 : 9), i = pick((uint32_t)alone.model->n_inputs);
    double a = between(0.0, 1.0), b = between(0.0, 1.0);
    command(&alone, kind, (int)i, a, b);
    command(&parts, kind, (int)i, a, b);
}

/* Random parts with random commands between them. False when this method refuses the model. */
static bool run_both(const struct model *m, const struct method *method, enum outcome *end)
{
    double tick_s = tick_of(m);
    if (!start_quiet(&alone, m, method, tick_s, alone_scratch, &alone_stages) ||
        !start_quiet(&parts, m, method, tick_s, parts_scratch, &parts_stages))
        return false;
    if (has_stages) {
        int i = (int)pick((uint32_t)m->n_inputs);
        double a = between(0.0, 1.0);
        set_stages(&alone, i, a, 0.5);
        set_stages(&parts, i, a, 0.5);
    }
    *end = SAME;
    for (int k = 0; k < PARTS && *end == SAME; k++) {
        if (pick(3) == 0)
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
    quiet_seed = 1;
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
