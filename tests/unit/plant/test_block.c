/* test_block.c - blocks of quiet ticks: the bits of a motion do not depend on how its time is cut into parts.
 *
 * Two plants take the same commands: one runs tick by tick, without blocks; the other in parts of random length, with
 * blocks. Everything that a plant holds beyond scratch is compared after each part. */
#include "tests/unit/test.h"

#include <string.h>
#include "firmware/plant/plant.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "tests/fixture/exact.h"

enum { RUNS = 400, PARTS = 25, LONGEST = 90 };

static double alone_scratch[METHOD_WORK], parts_scratch[METHOD_WORK], kept_scratch[METHOD_WORK];
static struct plant alone, parts;
static struct path path;
static uint64_t seed;

static double between(double low, double high)
{
    return low + (high - low) * exact_uniform(&seed);
}

static uint32_t pick(uint32_t n)
{
    return (uint32_t)between(0.0, (double)n);
}

static bool start(struct plant *pl, const struct model *m, const struct method *method, double tick_s,
                  double *scratch)
{
    struct plant_config c = {
        .model = m, .method = method, .tick_s = tick_s, .dilation = 1.0, .tol = 1e-3, .work = scratch};
    return plant_init(pl, &c) == NULL;
}

/* The same command for both: a drive with a ramp or without, a sample, noise, other parameters, a state, silence. */
static void command(struct plant *pl, uint32_t kind, int i, double a, double b)
{
    double unit = scale_of(&pl->scale, pl->model->input_signal[i].quantity),
           hz = (0.002 + 0.05 * b) / pl->tick_s;
    double si[MODEL_PARAMETERS], x[MODEL_STATES];
    switch (kind) {
    case 0:
    case 1:
    case 2:
        plant_drive(pl, i, 2.0 * a * unit, hz, 6.0 * a, pl->tick_s * (kind == 0 ? 0.0 : 40.0 * b));
        break;
    case 3:
        plant_sample(pl, i, 0.3 * a * unit, (uint64_t)(9.0 * b));
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
    default:
        plant_noise(pl, i, 0.0, 1, 0, 0.0);
    }
}

/* What a plant holds; the segment is scratch but for the inputs at its end. */
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

static bool run_alone(uint64_t ticks, uint32_t fraction)
{
    struct instant to = {alone.now.tick + ticks, fraction};
    while (alone.now.tick < to.tick)
        if (!plant_advance(&alone, (struct instant){alone.now.tick + 1, 0}))
            return false;
    return plant_advance(&alone, to);
}

/* Tick k of the path is where the other plant stands. */
static bool on_path(uint32_t k)
{
    const struct plant *pl = &alone;
    bool good = memcmp(path.x[k], pl->x, (size_t)pl->model->n_states * sizeof *pl->x) == 0 &&
                memcmp(path.u[k], pl->segment.at[2], sizeof path.u[k]) == 0;
    for (int i = 0; i < pl->model->n_inputs; i++)
        if ((pl->segment.active >> i) & 1u)
            good = good && path.cosine[k][i] == pl->drive[i].cosine && path.sine[k][i] == pl->drive[i].sine;
    return good;
}

enum outcome { SAME, DIFFERS, BOTH_FAILED };

/* Along paths; each of their places must be one where the other plant stood. */
static enum outcome run_along(uint32_t ticks)
{
    for (uint32_t left = ticks; left > 0; left -= path.n) {
        if (!plant_run_path(&parts, left, &path))
            return run_alone(1, 0) ? DIFFERS : BOTH_FAILED;
        for (uint32_t k = 0; k < path.n; k++)
            if (!run_alone(1, 0) || !on_path(k))
                return DIFFERS;
    }
    return SAME;
}

static enum outcome run_to(uint32_t ticks, uint32_t fraction)
{
    bool one = run_alone(ticks, fraction);
    bool other = plant_advance(&parts, (struct instant){parts.now.tick + ticks, fraction});
    return one != other ? DIFFERS : one ? SAME : BOTH_FAILED;
}

/* A snapshot is a copy of the plant and its scratch: what follows does not depend on what was tried in between. */
static void try_and_return(void)
{
    struct plant copy = parts;
    memcpy(kept_scratch, parts_scratch, sizeof kept_scratch);
    (void)!plant_run(&parts, 40);
    parts = copy;
    memcpy(parts_scratch, kept_scratch, sizeof kept_scratch);
}

static enum outcome part(void)
{
    uint32_t ticks = 1 + pick(LONGEST), fraction = pick(4) == 0 ? pick(65536) : 0;
    bool along = fraction == 0 && alone.now.fraction == 0 && pick(2) == 0;
    enum outcome end = along ? run_along(ticks) : run_to(ticks, fraction);
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
    uint32_t kind = pick(9), i = pick((uint32_t)alone.model->n_inputs);
    double a = between(0.0, 1.0), b = between(0.0, 1.0);
    command(&alone, kind, (int)i, a, b);
    command(&parts, kind, (int)i, a, b);
}

/* Random parts with random commands between them. False when this method refuses the model. */
static bool run(const struct model *m, const struct method *method, enum outcome *end)
{
    double tick_s = tick_of(m);
    if (!start(&alone, m, method, tick_s, alone_scratch) || !start(&parts, m, method, tick_s, parts_scratch))
        return false;
    alone.block = NULL;
    *end = SAME;
    for (int k = 0; k < PARTS && *end == SAME; k++) {
        if (pick(3) == 0)
            command_both();
        *end = part();
    }
    return true;
}

/* 400 motions of 25 parts: 10,000 subdivisions, of every model by the methods that have blocks. */
TEST(block_subdivisions)
{
    const struct method *const method[] = {&rk4, &rk4_unlocated, &auto_method};
    enum outcome end;
    int n_runs = 0, n_differ = 0, n_failed = 0;
    uint64_t switches = 0, ticks = 0;
    seed = 1;
    for (int i = 0; n_runs < RUNS; i++) {
        if (!run(model_table[i % MODELS], method[i / MODELS % 3], &end))
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

/* A quiet motion is run in blocks: the general path is left alone, or the comparison above would show nothing. */
TEST(block_taken)
{
    seed = 2;
    check_true("rig", start(&parts, &hertz_rig, &rk4, 1e-5, parts_scratch));
    plant_drive(&parts, RIG_FORCE, 1.0, 100.0, 0.0, 0.0);
    check_true("its ramp", plant_run(&parts, 3));
    check_true("a path", plant_run_path(&parts, 64, &path));
    check_int("ticks in one block", path.n, BLOCK_TICKS);
    plant_noise(&parts, RIG_FORCE, 0.1, 1, 1, 0.0);
    check_true("a path", plant_run_path(&parts, 64, &path));
    check_int("ticks of a noisy input in one block", path.n, 1);
}
