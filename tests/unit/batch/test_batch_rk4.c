/* test_batch_rk4.c - batch_rk4 beside the plant's rk4: the same
 * bits, in any company, with contact lost, and in whole plants. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/batch/batch_rk4.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/batch.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/trajectory.h"

/* 17 periods of the slowest drive, four re-synchronisations, no end of an interval at one. */
enum { LANES = 70, STEPS = 37, INTERVALS = 29 };
#define TWO_PI 6.283185307179586477

/* A trajectory with what it points to. */
struct one {
    double p[MODEL_DERIVED];
    struct batch_rk4_lane lane;
};

/* A batch of one model in which these inputs sound (bit i), and what drives it. */
struct many {
    const struct model *model;
    unsigned active;
    struct drive_setting drive[MODEL_INPUTS];
    struct one one[LANES];
};

static double between(uint64_t *seed, double a, double b)
{
    return batch_between(seed, a, b);
}

/* Parameters, step, amplitudes (a fifth of them 0) and
 * start at random; most starts are thrown off the contact. */
static void random_one(uint64_t *seed, const struct many *m, struct one *o)
{
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS];
    struct scale scale;
    paper_defaults(m->model, paper);
    paper[0] = m->model == &afm_tip ? between(seed, 0.3, 2.0) : between(seed, 0.005, 0.05);
    if (m->model == &afm_tip)
        paper[TIP_PAPER_SIGN] = -1.0;
    paper_prepare(m->model, paper, si, o->p, &scale);
    memset(&o->lane, 0, sizeof o->lane);
    o->lane.step = between(seed, 0.05, 0.1);
    for (int i = 0; i < m->model->n_inputs; i++) {
        double amplitude = between(seed, -0.5, 0.8);
        if ((m->active >> i) & 1u && between(seed, 0.0, 1.0) > 0.2)
            o->lane.amplitude[i] = amplitude;
    }
    o->lane.x[0] = between(seed, -2.5, 2.0);
    o->lane.x[1] = between(seed, -1.0, 1.0);
}

static void random_many(uint64_t *seed, const struct model *m, unsigned active, struct many *many)
{
    *many = (struct many){.model = m, .active = active};
    for (int i = 0; i < m->n_inputs; i++)
        many->drive[i] = (struct drive_setting){0.0, between(seed, i ? 0.05 : 0.016, i ? 0.2 : 0.03),
                                                between(seed, -1.0, 1.0), 0};
    for (int i = 0; i < LANES; i++)
        random_one(seed, many, &many->one[i]);
}

static void *start(struct batch_rk4 *b, struct many *m, int n)
{
    void *memory = malloc(batch_rk4_bytes(n));
    if (!memory)
        abort();
    batch_ran(batch_rk4_init(b, n, m->model, m->drive, memory));
    for (int i = 0; i < n; i++) {
        m->one[i].lane.p = m->one[i].p;
        batch_ran(batch_rk4_set(b, i, &m->one[i].lane));
    }
    return memory;
}

/* ---- the plant's rk4, one trajectory ---- */

struct scalar {
    const struct many *many;
    const struct one *one;
    struct drive drive[MODEL_INPUTS];
    double x[MODEL_STATES];
    int64_t open; /* steps that ended without contact */
};

static void begin_drives(struct scalar *s)
{
    for (int i = 0; i < s->many->model->n_inputs; i++) {
        struct drive_setting setting = s->many->drive[i];
        setting.amplitude = s->one->lane.amplitude[i];
        drive_init(&s->drive[i]);
        drive_start(&s->drive[i], &setting);
    }
}

static void begin_scalar(struct scalar *s, const struct many *m, int i)
{
    *s = (struct scalar){.many = m, .one = &m->one[i]};
    memcpy(s->x, m->one[i].lane.x, sizeof m->one[i].lane.x);
    begin_drives(s);
}

/* As the plant fills in its segment (firmware/plant/plant.c), with no look at switches. */
static void step_scalar(struct scalar *s, int steps)
{
    const struct model *m = s->many->model;
    for (int n = 0; n < steps; n++) {
        struct segment e = {.length = s->one->lane.step};
        struct crossing c;
        struct input gap[MODEL_CONTACTS];
        for (int i = 0; i < m->n_inputs; i++) {
            if (!drive_active(&s->drive[i]))
                continue;
            e.active |= 1u << i;
            drive_segment(&s->drive[i], TICK_FRACTIONS, 1.0 / e.length, &e.wave[i], &e.at[0][i], &e.at[1][i],
                          &e.at[2][i]);
        }
        if (rk4.bind(m)(m, s->one->p, NULL, &e, REGIME_ANY, s->x, &c) != STEP_END)
            check_true("a step of rk4 ends", 0);
        m->gap(s->one->p, e.at[2], s->x, gap);
        s->open += gap[0].value > 0.0;
    }
}

/* Samples of trajectory i of a batch that are not the
 * scalar's; how many steps ended without contact is added up. */
static int differing(const struct many *m, int i, int n, const double *samples, int64_t *open)
{
    struct scalar s;
    int differs = 0;
    begin_scalar(&s, m, i);
    for (int j = 0; j < INTERVALS; j++) {
        double x[2] = {samples[2 * j * n + i], samples[(2 * j + 1) * n + i]};
        step_scalar(&s, STEPS);
        differs += memcmp(x, s.x, sizeof x) != 0;
    }
    *open += s.open;
    return differs;
}

/* ---- the same bits ---- */

static void check_bits(uint64_t *seed, const struct model *m, unsigned active, const char *what)
{
    static const int size[] = {1, 33, LANES};
    static struct many many;
    static double samples[2 * LANES * INTERVALS];
    char text[128];
    int differs = 0;
    int64_t open = 0;
    random_many(seed, m, active, &many);
    for (int k = 0; k < 6; k++) {
        struct batch_rk4 b;
        int n = size[k / 2];
        void *memory = start(&b, &many, n);
        b.kernel = k % 2 ? batch_rk4_plain : b.kernel;
        batch_ran(batch_rk4(&b, STEPS, INTERVALS, samples));
        for (int i = 0; i < n; i++)
            differs += differing(&many, i, n, samples, &open);
        free(memory);
    }
    snprintf(text, sizeof text, "%s: samples that are not the plant's rk4's, bit for bit", what);
    check_int(text, differs, 0);
    snprintf(text, sizeof text, "%s: steps that ended without contact", what);
    check_above(text, (double)open, 1000.0);
}

/* Every model and pattern of inputs, alone and in company,
 * by the kernels of this processor and by the plain ones. */
TEST(batch_rk4)
{
    uint64_t seed = 11;
    check_bits(&seed, &hertz_rig, 0, "rig, nothing sounds");
    check_bits(&seed, &hertz_rig, 1u << RIG_FORCE, "rig, force");
    check_bits(&seed, &hertz_rig, 1u << RIG_FAST_FORCE, "rig, fast force");
    check_bits(&seed, &hertz_rig, 1u << RIG_FORCE | 1u << RIG_FAST_FORCE, "rig, two forces");
    check_bits(&seed, &hertz_rig, 1u << RIG_FORCE | 1u << RIG_STIFFNESS, "rig, force and stiffness");
    check_bits(&seed, &hertz_rig, 1u << RIG_FORCE | 1u << RIG_BASE, "rig, force and base");
    check_bits(&seed, &hertz_rig, (1u << RIG_INPUTS) - 1u, "rig, every input");
    check_bits(&seed, &rolling_contact, 1u << ROLLING_FORCE, "rolling contact, force");
    check_bits(&seed, &rolling_contact, 1u << ROLLING_WAVINESS, "rolling contact, waviness");
    check_bits(&seed, &rolling_contact, 3u, "rolling contact, both");
    check_bits(&seed, &afm_tip, 1u << TIP_FORCE, "tip, force");
    check_bits(&seed, &afm_tip, 3u, "tip, force and stiffness");
}

/* ---- whole plants ---- */

/* Gentle enough to keep contact: no step is cut, so the whole plant has these bits too. */
static void gentle(const struct model *m, double *paper)
{
    paper_defaults(m, paper);
    if (m == &hertz_rig) {
        paper[RIG_PAPER_SIGMA] = 0.05;
        paper[RIG_PAPER_FORCE] = 0.3;
        paper[RIG_PAPER_BASE] = 0.02;
        paper[RIG_PAPER_STIFFNESS] = 0.1;
        paper[RIG_PAPER_PHI] = 0.4;
        paper[RIG_PAPER_XI] = 0.05;
    } else if (m == &rolling_contact) {
        paper[ROLLING_PAPER_ZETA] = 0.05;
        paper[ROLLING_PAPER_XI0] = 0.02;
    } else {
        paper[TIP_PAPER_SIGN] = -1.0;
        paper[TIP_PAPER_F] = 0.02;
        paper[TIP_PAPER_R] = 0.1;
        paper[TIP_PAPER_C] = 0.1;
    }
}

/* As plant_drive_start makes it of a drive of the paper's. */
static struct drive_setting setting_of(const struct harmonic *h, double tick)
{
    return (struct drive_setting){h->amplitude, h->omega / TWO_PI * tick, h->phase / TWO_PI, 0};
}

static void check_plant(const struct model *m)
{
    enum { N = 5, TICKS = 1500 };
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS], state[2] = {0.0, 0.0}, tick = 0.0625;
    struct harmonic drive[MODEL_INPUTS] = {{0.0, 0.0, 0.0}};
    struct drive_setting setting[MODEL_INPUTS] = {{0.0, 0.0, 0.0, 0}};
    struct plant pl;
    struct batch_rk4 b;
    int differs = 0;
    uint64_t switches = 0;
    void *memory = malloc(batch_rk4_bytes(N));
    gentle(m, paper);
    state[0] = m == &rolling_contact ? 1.0 : 0.0; /* near rest */
    m->from_paper(paper, si, drive);
    for (int i = 0; i < m->n_inputs; i++)
        setting[i] = setting_of(&drive[i], tick);
    for (int i = 0; i < N; i++) {
        struct batch_rk4_lane lane;
        double x[2];
        paper[m == &afm_tip ? TIP_PAPER_BETA : 0] *= 1.1;
        paper[m == &hertz_rig ? (int)RIG_PAPER_SIGMA : 1] *= 1.05;
        trajectory_start(&pl, m, &rk4, 0.0, NULL, paper, tick, state);
        lane = (struct batch_rk4_lane){.p = pl.p, .step = pl.h, .x = {pl.x[0], pl.x[1]}};
        for (int k = 0; k < m->n_inputs; k++)
            lane.amplitude[k] = pl.drive[k].amplitude;
        batch_ran(batch_rk4_init(&b, 1, m, setting, memory));
        batch_ran(batch_rk4_set(&b, 0, &lane));
        batch_ran(batch_rk4(&b, TICKS, 1, NULL));
        check_true("the plant runs", plant_run(&pl, TICKS));
        batch_rk4_state(&b, 0, x);
        differs += memcmp(x, pl.x, sizeof x) != 0;
        switches += pl.counts.switches;
    }
    check_int("plants that end elsewhere than the batch, bit for bit", differs, 0);
    check_int("contact switches", (int64_t)switches, 0);
    free(memory);
}

TEST(batch_rk4_plant)
{
    check_plant(&hertz_rig);
    check_plant(&rolling_contact);
    check_plant(&afm_tip);
}

/* ---- calls, escape, refusals ---- */

/* Intervals in one call or in several, a step at a time: the same bits in all that a batch holds. */
TEST(batch_rk4_split)
{
    static struct many many;
    struct batch_rk4 b[2];
    uint64_t seed = 5;
    random_many(&seed, &hertz_rig, (1u << RIG_INPUTS) - 1u, &many);
    void *memory[2] = {start(&b[0], &many, LANES), start(&b[1], &many, LANES)};
    batch_ran(batch_rk4(&b[0], 150, 5, NULL));
    batch_ran(batch_rk4(&b[0], 1, 3, NULL));
    batch_ran(batch_rk4(&b[1], 150, 2, NULL));
    batch_ran(batch_rk4(&b[1], 150, 3, NULL));
    for (int i = 0; i < 3; i++)
        batch_ran(batch_rk4(&b[1], 1, 1, NULL));
    check_int("753 steps in two calls and in five: the same bits",
              memcmp(memory[0], memory[1], batch_rk4_bytes(LANES)), 0);
    check_int("and the same drives", memcmp(b[0].drive, b[1].drive, sizeof b[0].drive), 0);
    free(memory[0]);
    free(memory[1]);
}

/* Behind the saddle of the attracting tip the motion escapes; its neighbours do not notice. */
TEST(batch_rk4_escape)
{
    enum { BAD = 4 };
    static struct many many;
    static double samples[2 * LANES * INTERVALS];
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS], x[2];
    struct scale scale;
    struct batch_rk4 b;
    uint64_t seed = 23;
    int64_t open = 0;
    int differs = 0, numbers = 0;
    random_many(&seed, &afm_tip, 3u, &many);
    paper_defaults(&afm_tip, paper);
    paper_prepare(&afm_tip, paper, si, many.one[BAD].p, &scale);
    many.one[BAD].lane.x[0] = 4.0;
    many.one[BAD].lane.x[1] = 1.0;
    void *memory = start(&b, &many, LANES);
    batch_ran(batch_rk4(&b, STEPS, INTERVALS, samples));
    int64_t reached = batch_rk4_intervals(&b, BAD);
    for (int i = 0; i < LANES; i++)
        differs += i != BAD ? differing(&many, i, LANES, samples, &open) : 0;
    for (int64_t j = reached; j < INTERVALS; j++)
        numbers += !isnan(samples[2 * j * LANES + BAD]) + !isnan(samples[(2 * j + 1) * LANES + BAD]);
    check_true("it has escaped", !batch_rk4_good(&b, BAD));
    check_is("it has escaped", reached, <, INTERVALS);
    check_int("samples of it that are numbers", numbers, 0);
    check_int("samples of others that are not the plant's rk4's", differs, 0);
    batch_rk4_state(&b, BAD, x);
    double last = reached ? samples[2 * (reached - 1) * LANES + BAD] : 4.0;
    check_near("it stays where its last good interval ended", x[0], last, 0.0);
    batch_ran(batch_rk4(&b, STEPS, 1, NULL));
    check_int("called again, it has completed no more", batch_rk4_intervals(&b, BAD), reached);
    batch_rk4_state(&b, BAD, x);
    check_near("and is still there", x[0], last, 0.0);
    free(memory);
}

static void refused(const char *what, const char *why)
{
    char text[200];
    snprintf(text, sizeof text, "%s: %s", what, why ? why : "not refused");
    check_error(text, why);
}

TEST(batch_rk4_refusals)
{
    static struct many many;
    struct batch_rk4 b, before;
    struct batch_rk4_block block;
    uint64_t seed = 3;
    random_many(&seed, &hertz_rig, 1u, &many);
    void *memory = start(&b, &many, 1);
    before = b;
    memcpy(&block, memory, sizeof block);
    refused("a shaft", batch_rk4_init(&b, 1, &shaft_bearing, many.drive, memory));
    many.drive[0].turns_per_tick = 0.26;
    refused("3.8 steps in a period", batch_rk4_init(&b, 1, &hertz_rig, many.drive, memory));
    many.drive[0].turns_per_tick = (double)NAN;
    refused("a frequency that is no number", batch_rk4_init(&b, 1, &hertz_rig, many.drive, memory));
    refused("no step", batch_rk4(&b, 0, 1, NULL));
    refused("negative intervals", batch_rk4(&b, 64, -1, NULL));
    many.one[0].lane.step = 0.0;
    refused("step 0", batch_rk4_set(&b, 0, &many.one[0].lane));
    many.one[0].lane.step = 0.21;
    refused("30 steps a period", batch_rk4_set(&b, 0, &many.one[0].lane));
    many.one[0].lane.step = 0.1;
    many.one[0].lane.amplitude[1] = 1.1e9;
    refused("a force of 1.1e9", batch_rk4_set(&b, 0, &many.one[0].lane));
    check_int("and nothing has changed", memcmp(&before, &b, sizeof b) | memcmp(&block, memory, sizeof block),
              0);
    free(memory);
}
