/* test_beside.c - plants side by side have the bits of plants one by one. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "host_sim/beside/beside.h"
#include "host_sim/beside/rk4_beside.h"
#include "host_sim/beside/rk4_beside_avx2.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/rolling_contact.h"
#include "tests/fixture/any_motion.h"

enum { RUNS = 150, PARTS = 25, LONGEST = 200 };

static struct plant one_by_one[SIDES], beside[SIDES];
static double scratch[2][SIDES][METHOD_SCRATCH];
static struct stages stages[2][SIDES];

/* All that a plant shows at the ends of its ticks. */
static uint64_t seen[2][SIDES];

static void look(void *sum, const struct plant *pl)
{
    uint64_t word, *s = sum;
    for (int i = 0; i < 2 + MODEL_INPUTS; i++) {
        double shown = i < 2 ? pl->x[i] : pl->segment.at[2][i - 2].value;
        memcpy(&word, &shown, sizeof word);
        *s = *s * 31 + word;
    }
    *s = *s * 31 + pl->now.tick;
}

/* The models of INSTANCES_BESIDE. */
enum { KINDS = 3 };
static const struct model *const kinds[KINDS] = {&hertz_rig, &rolling_contact, &afm_tip};

/* Plants of one model that differ in their masses, and in one of eight in model or method. */
static bool start_plants(uint32_t n)
{
    double si[MODEL_PARAMETERS];
    const struct model *most = kinds[any_pick(KINDS)];
    for (uint32_t i = 0; i < n; i++) {
        bool other = any_pick(8) == 0;
        const struct model *m = other ? model_table[any_pick(MODELS)] : most;
        const struct method *own = any_pick(2) ? &rk4 : &auto_method,
                            *method = other ? method_table[any_pick(METHODS)] : own;
        double tick_s = any_tick_s(m);
        if (!any_start(&one_by_one[i], m, method, tick_s, scratch[0][i], &stages[0][i]) ||
            !any_start(&beside[i], m, method, tick_s, scratch[1][i], &stages[1][i]))
            return false;
        memcpy(si, one_by_one[i].si, sizeof si);
        si[RIG_MASS] *= any_between(0.8, 1.0);
        const char *why = plant_change(&one_by_one[i], si), *other_why = plant_change(&beside[i], si);
        if (why != other_why)
            check_true("both refuse the mass", false);
        seen[0][i] = seen[1][i] = 0;
    }
    return true;
}

static void command(uint32_t i)
{
    uint32_t kind = any_pick(9);
    int input = (int)any_pick((uint32_t)beside[i].model->n_inputs);
    double a = any_between(0.0, 1.0), b = any_between(0.0, 1.0);
    any_command(&one_by_one[i], kind, input, a, b);
    any_command(&beside[i], kind, input, a, b);
}

/* Each plant runs ticks of its own; some are looked at. Returns those that differ then. */
static int run_part(uint32_t n)
{
    struct plant_run r[SIDES];
    bool good[SIDES];
    uint32_t ticks = 1 + any_pick(LONGEST);
    int n_differ = 0;
    for (uint32_t i = 0; i < n; i++) {
        struct plant *pl = &one_by_one[i];
        uint32_t own = any_pick(3) > 0 ? ticks : 1 + any_pick(LONGEST);
        r[i] = (struct plant_run){.pl = &beside[i], .to = beside[i].now.tick + own};
        if (any_pick(2)) {
            r[i].look = look;
            r[i].who = &seen[1][i];
            good[i] = plant_run_seen(pl, own, look, NULL, &seen[0][i]);
        } else {
            good[i] = plant_run(pl, own);
        }
    }
    plant_run_beside(r, n, beside_bind);
    for (uint32_t i = 0; i < n; i++) {
        n_differ += good[i] != r[i].good || seen[0][i] != seen[1][i] || !any_same(&one_by_one[i], &beside[i]);
        if (!good[i]) { /* both go on from rest */
            plant_reset(&one_by_one[i]);
            plant_reset(&beside[i]);
        }
    }
    return n_differ;
}

/* A snapshot of one of them: what was tried in between leaves nothing. */
static void try_and_return(uint32_t i)
{
    struct plant copy = beside[i];
    static double kept[METHOD_SCRATCH];
    memcpy(kept, scratch[1][i], sizeof kept);
    (void)!plant_run(&beside[i], 30);
    beside[i] = copy;
    memcpy(scratch[1][i], kept, sizeof kept);
}

/* 2 to SIDES plants with random commands: they meet switches, corners, ramps, noise and phasors that are due
 * at instants of their own. */
TEST(beside_plants)
{
    int n_runs = 0, n_differ = 0;
    uint64_t switches = 0, ticks = 0;
    any_seed = 7;
    while (n_runs < RUNS) {
        uint32_t n = 2 + any_pick(SIDES - 1);
        if (!start_plants(n))
            continue;
        n_runs++;
        for (int k = 0; k < PARTS; k++) {
            for (uint32_t i = 0; i < n; i++) {
                if (any_pick(4) == 0)
                    command(i);
                if (any_pick(32) == 0)
                    try_and_return(i);
            }
            n_differ += run_part(n);
        }
        for (uint32_t i = 0; i < n; i++) {
            switches += beside[i].counts.switches;
            ticks += beside[i].now.tick;
        }
    }
    check_int("plants that differ from those one by one", n_differ, 0);
    check_above("ticks", (double)ticks, 1e6);
    check_above("contact switches among them", (double)switches, 1e4);
}

/* ---- dips: contact is lost and found within one tick ---- */

/* A state on its way out of contact, which comes to y = 0 at a speed so small that the load brings it back
 * within less than a tick: y'' = 2/3 (1 - y^{3/2}), without the damper. */
static void set_grazing(struct plant *a, struct plant *b)
{
    double y = any_between(0.0, 0.05), out = any_between(0.0, 1.0 / 3.0) * a->h;
    const double x[2] = {y, -sqrt(out * out + 4.0 / 3.0 * (y - 0.4 * y * y * sqrt(y)))};
    plant_set_state(a, x);
    plant_set_state(b, x);
}

/* Ticks of which the plant has a lift-off and then a touchdown. */
static int count_dips(struct plant pl)
{
    struct event e, before = {.touch = true};
    int n = 0;
    while (plant_take_event(&pl, &e)) {
        n += e.touch && !before.touch && e.tick == before.tick;
        before = e;
    }
    return n;
}

TEST(beside_dips)
{
    struct plant_run r[SIDES];
    bool good[SIDES];
    int n_dips = 0, n_differ = 0;
    any_seed = 5;
    for (int run = 0; run < 100; run++) {
        for (int i = 0; i < SIDES; i++) {
            double tick_s = any_tick_s(&hertz_rig);
            if (!any_start(&one_by_one[i], &hertz_rig, &rk4, tick_s, scratch[0][i], &stages[0][i]) ||
                !any_start(&beside[i], &hertz_rig, &rk4, tick_s, scratch[1][i], &stages[1][i]))
                check_true("a rig by rk4", false);
            set_grazing(&one_by_one[i], &beside[i]);
            r[i] = (struct plant_run){.pl = &beside[i], .to = 40};
            good[i] = plant_run(&one_by_one[i], 40);
        }
        plant_run_beside(r, SIDES, beside_bind);
        for (int i = 0; i < SIDES; i++) {
            n_differ += !good[i] || !r[i].good || !any_same(&one_by_one[i], &beside[i]);
            n_dips += count_dips(one_by_one[i]);
        }
    }
    check_int("plants with dips that differ from those alone", n_differ, 0);
    check_above("dips within one tick", n_dips, 150);
}

/* ---- the width of vectors ---- */

/* Plants near contact whose ledgers are under way, and blocks of ticks. */
static void fill(const struct model *m, struct method_block *b, struct plant *pl)
{
    double si[MODEL_PARAMETERS];
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    for (int i = 0; i < SIDES; i++) {
        memset(&pl[i], 0, sizeof pl[i]);
        memset(&b[i], 0, sizeof b[i]);
        m->prepare(si, pl[i].p, &pl[i].scale);
        pl[i].ledger.active = b[i].active = (1u << m->n_inputs) - 1u;
        pl[i].regime = b[i].regime = 1;
        b[i].length = any_between(0.01, 0.1);
        ledger_weigh(&pl[i].ledger, b[i].length);
        b[i].x[0][0] = any_between(0.01, 1.3);
        b[i].x[0][1] = any_between(-0.3, 0.3);
        for (int k = 0; k <= 2 * BLOCK_TICKS; k++)
            for (int j = 0; j < m->n_inputs; j++)
                b[i].at[k][j] = (struct input){any_between(-0.1, 0.1), any_between(-0.1, 0.1)};
    }
}

/* Returns the ticks moved. */
static uint32_t run_block(plant_sides_function *run, struct method_block *b, struct plant *pl,
                          unsigned *stopped)
{
    struct plant_side side[SIDES];
    for (int i = 0; i < SIDES; i++)
        side[i] = (struct plant_side){&pl[i], &b[i], b[i].at, b[i].x};
    return run(side, BLOCK_TICKS, stopped);
}

TEST(beside_widths)
{
#if defined(BESIDE_AVX2)
    static struct method_block narrow[SIDES], wide[SIDES];
    static struct plant narrow_plant[SIDES], wide_plant[SIDES];
    unsigned active[2] = {1u << RIG_FORCE, 1u << RIG_BASE};
    unsigned narrow_stopped, wide_stopped;
    uint32_t moved = 0;
    int n_differ = 0;
    any_seed = 3;
    if (!__builtin_cpu_supports("avx2")) {
        check_true("a processor with AVX2", 0);
        return;
    }
    for (int k = 0; k < 2000; k++) {
        const struct model *m = kinds[k / 2 % KINDS];
        unsigned which = active[k % 2];
        fill(m, narrow, narrow_plant);
        memcpy(wide, narrow, sizeof wide);
        memcpy(wide_plant, narrow_plant, sizeof wide_plant);
        uint32_t n = run_block(rk4_bind_sides_plain(m, which), narrow, narrow_plant, &narrow_stopped);
        n_differ += n != run_block(rk4_bind_sides_avx2(m, which), wide, wide_plant, &wide_stopped);
        n_differ += narrow_stopped != wide_stopped;
        n_differ += memcmp(wide, narrow, sizeof wide) != 0 ||
                    memcmp(wide_plant, narrow_plant, sizeof wide_plant) != 0;
        moved += n;
    }
    check_int("blocks whose bits depend on the width of vectors", n_differ, 0);
    check_above("ticks moved", moved, 5000);
    check_below("of those asked for", moved, 2000 * BLOCK_TICKS - 1000);
#else
    check_true("no model goes side by side without vectors, or by one width only", true);
#endif
}
