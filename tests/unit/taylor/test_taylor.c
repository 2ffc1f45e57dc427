/* test_taylor.c - taylor under changing inputs, states and parameters, against rk4 in 400 parts a segment on
 * the very same excitation; and what it carries over from step to step. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/method/taylor/taylor_piece.h"
#include "firmware/method/taylor/taylor_short.h"
#include "firmware/method/taylor/taylor_short_cubic.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/rolling_contact.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"

enum { FINE = 400, BLOCKS = 48 };

static double scratch[METHOD_SCRATCH];

/* rk4 in FINE parts a segment: independent of every series, its error below 1e-8 at the ticks used here. */
static enum step_status fine_step(const struct model *m, const double *p, double *w, const struct segment *e,
                                  unsigned regime, double *x, struct crossing *c)
{
    struct segment rest = *e, head;
    enum step_status status = STEP_END;
    (void)regime;
    for (int left = FINE; left > 0 && status == STEP_END; left--) {
        double length = rest.length / left;
        segment_head(&rest, m->n_inputs, length, &head);
        status = rk4.bind(m)(m, p, w, &head, REGIME_ANY, x, c);
        segment_tail(&rest, m->n_inputs, length);
    }
    return status;
}

static step_function *fine_bind(const struct model *m)
{
    (void)m;
    return fine_step;
}

static const char *fine_refuse(const struct model *m, const double *p, double h, double tol)
{
    return rk4.refuse(m, p, h / FINE, tol);
}

/* rk4's other functions with the step above. */
static struct method fine_method(void)
{
    struct method m = rk4;
    m.bind = fine_bind;
    m.bind_run = NULL;
    m.refuse = fine_refuse;
    return m;
}

/* Both methods on one model: model time is bus time, `tick` apart. */
struct pair {
    struct method fine;
    struct plant a, b; /* taylor, rk4 */
    double worst;
};

static void pair_start(struct pair *p, const struct model *m, const double *paper, double tick, double tol)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    m->from_paper(paper, si, drive);
    p->fine = fine_method();
    p->worst = 0.0;
    struct plant_config c = {.model = m,
                             .si = si,
                             .method = &taylor,
                             .tick_s = tick,
                             .dilation = 1.0,
                             .tol = tol,
                             .scratch = scratch};
    const char *why = plant_init(&p->a, &c);
    check_string("taylor takes the plant", why ? why : "", "");
    c.method = &p->fine;
    why = plant_init(&p->b, &c);
    check_string("rk4 takes the plant", why ? why : "", "");
}

static void pair_run(struct pair *p, uint64_t tick, uint32_t fraction)
{
    struct instant to = {tick, fraction};
    if (!plant_advance(&p->a, to) || !plant_advance(&p->b, to))
        check_true("both stay finite", 0);
    exact_worst(&p->worst, (long double)fmax(fabs(p->a.x[0] - p->b.x[0]), fabs(p->a.x[1] - p->b.x[1])));
}

static void pair_drive(struct pair *p, int i, double amplitude, double omega, double phase, double ramp)
{
    plant_drive(&p->a, i, amplitude, omega / 6.283185307179586477, phase, ramp);
    plant_drive(&p->b, i, amplitude, omega / 6.283185307179586477, phase, ramp);
}

static void pair_sample(struct pair *p, int i, double value, uint64_t ticks)
{
    plant_sample(&p->a, i, value, ticks);
    plant_sample(&p->b, i, value, ticks);
}

/* The defaults; the tip with the sign that it does not run away with. */
static void paper_of(const struct model *m, double *paper)
{
    paper_defaults(m, paper);
    if (m == &afm_tip || m == &afm_tip_cubic) {
        paper[TIP_PAPER_SIGN] = -1.0;
        paper[TIP_PAPER_BETA] = 0.8;
    }
}

/* One command after another, each input in turn: amplitude,
 * frequency and phase ramps, samples held and linear. */
static void command(struct pair *p, int k)
{
    int n = p->a.model->n_inputs, i = k % n;
    double sign = k % 3 == 0 ? -1.0 : 1.0;
    switch (k / n % 6) {
    case 0:
        pair_drive(p, i, 0.3, 0.9 + 0.4 * i, 0.3 * k, 0.7);
        break;
    case 1:
        pair_sample(p, i, 0.05 * sign, (uint64_t)(k % 4) * 3);
        break;
    case 2:
        pair_drive(p, i, 0.2, 2.1 + 0.3 * i, 0.1 * k, 0.0);
        break;
    case 3:
        pair_drive(p, i, 0.35, 2.1, -0.4 * k, 1.3);
        break;
    case 4:
        pair_sample(p, i, -0.04 * sign, 0);
        break;
    default:
        pair_drive(p, i, 0.0, 2.1, 0.0, 0.4);
    }
}

static void check_commands(const struct model *m, const double *paper, const char *name)
{
    static struct pair p;
    uint32_t switches = 0;
    pair_start(&p, m, paper, 0.1, 1e-11);
    for (int k = 0; k < BLOCKS; k++) {
        uint64_t tick = p.a.now.tick;
        pair_run(&p, tick + 4, (uint32_t)(7919 * k % TICK_FRACTIONS));
        command(&p, k);
        pair_run(&p, tick + 12, 0);
        /* keep the two together: what is tested is each stretch, not chaos */
        switches = p.a.counts.switches;
        double x[MODEL_STATES];
        m->rest(p.a.p, x);
        plant_set_state(&p.a, m->n_contacts > 0 ? p.a.x : x); /* a cubic force lets go beyond its maximum */
        plant_set_state(&p.b, p.a.x);
    }
    check_below(check_name("%s: taylor against rk4 in %d parts, all inputs, ramps and samples", name, FINE),
                p.worst, 2e-8);
    check_int("roots that did not converge", p.a.counts.residual, 0);
    check_int("budgets reached", p.a.counts.budget + p.a.counts.work, 0);
    if (m->n_contacts > 0)
        check_above("contact switches on the way", switches, 2);
}

TEST(taylor_commands)
{
    static const struct model *const models[] = {&hertz_rig, &rolling_contact, &hertz_rig_cubic, &afm_tip};
    double paper[MODEL_PARAMETERS];
    for (unsigned i = 0; i < sizeof models / sizeof *models; i++) {
        paper_of(models[i], paper);
        check_commands(models[i], paper, models[i]->name);
    }
}

/* New samples at every tick and no harmonic drive: nearly every tick is one short series. */
static void check_short(const struct model *m, const double *paper)
{
    static struct pair p;
    uint32_t random = 1;
    int n_short = 0, n_ticks = 1200;
    pair_start(&p, m, paper, 0.06, 1e-8);
    for (int k = 0; k < n_ticks; k++) {
        uint64_t tick = p.a.now.tick;
        for (int i = 0; i < m->n_inputs; i++) {
            random = random * 1664525u + 1013904223u;
            double slow = i == 0 ? 1.2 * cos(0.05 * k) : 0.0;
            pair_sample(&p, i, slow + 0.02 * (double)(random >> 8) * 0x1p-24,
                        (uint64_t)(k % 3)); /* held, or straight */
        }
        pair_run(&p, tick + 1, 0);
        n_short += ((struct taylor *)(void *)scratch)->kind == TAYLOR_NONE;
        plant_set_state(&p.b, p.a.x);
    }
    check_below(check_name("%s: taylor against rk4 in %d parts, new samples each tick", m->name, FINE),
                p.worst, 2e-9);
    check_above("share of ticks with one short series", (double)n_short / n_ticks, 0.7);
    check_above("contact switches on the way", p.a.counts.switches, 10);
}

TEST(taylor_short)
{
    static const struct model *const models[] = {&hertz_rig, &rolling_contact, &afm_tip};
    double paper[MODEL_PARAMETERS];
    for (unsigned i = 0; i < sizeof models / sizeof *models; i++) {
        paper_of(models[i], paper);
        check_short(models[i], paper);
    }
}

/* Steady drives on every input, then ramps, at a loose tolerance and ticks that a long series would outlive
 * by little: one short series a tick. n_steady, n_ramp: such ticks. */
static void check_brief(const struct model *m, const double *paper)
{
    enum { TICKS = 300 };
    static struct pair p;
    int n_steady = 0, n_ramp = 0;
    const double tol = 1e-4; /* relative to so small a motion; 16 times that is asked for */
    pair_start(&p, m, paper, 0.42, 16.0 * tol);
    for (int i = 0; i < m->n_inputs; i++)
        pair_drive(&p, i, 0.02, 2.0 + 0.3 * i, 0.5 * i, 0.0);
    for (int k = 0; k < 2 * TICKS; k++) {
        if (k == TICKS)
            for (int i = 0; i < m->n_inputs; i++)
                pair_drive(&p, i, 0.03, 2.2 + 0.2 * i, 0.4 * i, 0.35 * TICKS);
        pair_run(&p, p.a.now.tick + 1, 0);
        *(k < TICKS ? &n_steady : &n_ramp) += ((struct taylor *)(void *)scratch)->kind == TAYLOR_NONE;
        plant_set_state(&p.b, p.a.x);
    }
    check_below(check_name("%s: error of a tick of short series over the tolerance", m->name), p.worst / tol,
                0.35); /* the error of the rate, per time unit, over a tick of 0.35 */
    check_above("share of steady ticks with one short series", (double)n_steady / TICKS, 0.9);
    check_above("share of ticks in a ramp with one short series", (double)n_ramp / TICKS, 0.9);
    check_int("contact switches on the way", (long long)p.a.counts.switches, 0);
}

TEST(taylor_brief)
{
    static const struct model *const models[] = {&hertz_rig, &rolling_contact, &afm_tip};
    double paper[MODEL_PARAMETERS];
    for (unsigned i = 0; i < sizeof models / sizeof *models; i++) {
        paper_of(models[i], paper);
        check_brief(models[i], paper);
    }
}

/* Short series of a polynomial force, under the inputs that are forces and one other, or NO_OTHER; the
 * share is that of all ticks. */
enum { NO_OTHER = -1 };
static void check_cubic(const struct model *m, int other, double tick, double tol)
{
    enum { TICKS = 300 };
    static struct pair p;
    double paper[MODEL_PARAMETERS];
    int n_short = 0;
    paper_of(m, paper);
    pair_start(&p, m, paper, tick, tol);
    for (int k = 0; k < 2 * TICKS; k++) {
        for (int i = 0; i < m->n_inputs && k % TICKS == 0; i++)
            if (m->input_signal[i].quantity == QUANTITY_FORCE || i == other)
                pair_drive(&p, i, 0.02 + 0.01 * (k > 0), 0.8 + 0.3 * i, 0.5 * i, k > 0 ? tick * TICKS : 0.0);
        pair_run(&p, p.a.now.tick + 1, 0);
        n_short += ((struct taylor *)(void *)scratch)->kind == TAYLOR_NONE;
        plant_set_state(&p.b, p.a.x);
    }
    check_below(check_name("%s%s%s: error of a tick of %g by short series over the tolerance %g", m->name,
                           other < 0 ? "" : ", moving ", other < 0 ? "" : m->input_signal[other].name, tick,
                           tol),
                p.worst / (tol * tick), 1.0);
    check_above("share of ticks with one short series", n_short / (2.0 * TICKS), 0.9);
}

TEST(taylor_short_cubic)
{
    static const struct model *const models[] = {&hertz_rig_cubic, &afm_tip_cubic, &hertz_rig_linear,
                                                 &hertz_rig_averaged};
    static const double tick_tol[][2] = {{1.5, 1e-2}, {1.0, 1e-3}, {0.9, 1e-5}, {0.45, 1e-8}, {0.3, 1e-10}};
    for (unsigned i = 0; i < sizeof models / sizeof *models; i++)
        for (unsigned k = 0; k < sizeof tick_tol / sizeof *tick_tol; k++)
            check_cubic(models[i], NO_OTHER, tick_tol[k][0], tick_tol[k][1]);
    for (unsigned k = 0; k < sizeof tick_tol / sizeof *tick_tol; k++) {
        check_cubic(&hertz_rig_cubic, RIG_STIFFNESS, tick_tol[k][0], tick_tol[k][1]);
        check_cubic(&hertz_rig_cubic, RIG_BASE, tick_tol[k][0], tick_tol[k][1]);
        check_cubic(&afm_tip_cubic, TIP_STIFFNESS, tick_tol[k][0], tick_tol[k][1]);
    }
}

/* A steady force of this amplitude, theta = 0.4 + 0.9 s, from s on. */
static void steady_segment(double s, double length, struct segment *e)
{
    memset(e, 0, sizeof *e);
    e->length = length;
    e->active = 1;
    e->wave[0] = (struct wave){
        .amplitude = 0.3, .omega = 0.9, .cosine = cos(0.4 + 0.9 * s), .sine = sin(0.4 + 0.9 * s)};
    for (int k = 0; k < 3; k++)
        wave_at(&e->wave[0], 0.5 * k * length, &e->at[k][0]);
}

/* At a loose tolerance a series begun anew would differ by 1e-5: short steps agree with one long step to
 * rounding only if they read the same series. And they differ as soon as something says that the inputs
 * changed. */
TEST(taylor_reuse)
{
    enum { STEPS = 50 };
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], paper[MODEL_PARAMETERS], x[2] = {1.5, 0.0}, y[2],
                                                                            length = 2.9;
    struct scale scale;
    struct segment e;
    struct crossing c;
    paper_defaults(&hertz_rig, paper);
    paper_prepare(&hertz_rig, paper, si, p, &scale);
    step_function *step = taylor.bind(&hertz_rig);
    taylor.prepare(&hertz_rig, p, length, 1e-4, scratch);
    steady_segment(0.0, length, &e);
    check_int("one long step ends", step(&hertz_rig, p, scratch, &e, 1, x, &c), STEP_END);
    for (int changed = 0; changed < 2; changed++) {
        taylor.prepare(&hertz_rig, p, length / STEPS, 1e-4, scratch);
        y[0] = 1.5;
        y[1] = 0.0;
        for (int i = 0; i < STEPS; i++) {
            steady_segment(length * i / STEPS, length / STEPS, &e);
            e.changed = changed;
            step(&hertz_rig, p, scratch, &e, 1, y, &c);
        }
        double apart = fmax(fabs(x[0] - y[0]), fabs(x[1] - y[1]));
        if (changed)
            check_above("steps that begin anew differ within the tolerance", apart, 1e-8);
        else
            check_below("steps that read one series agree to rounding", apart, 1e-14);
    }
}

/* A segment of no length changes nothing, whatever its inputs are: no 0/0 in a rate per tick. */
TEST(taylor_zero_length)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED], paper[MODEL_PARAMETERS], x[2] = {1.5, -0.3};
    struct scale scale;
    struct segment e;
    struct crossing c;
    paper_defaults(&hertz_rig, paper);
    paper_prepare(&hertz_rig, paper, si, p, &scale);
    for (int tone = 0; tone < 2; tone++) {
        taylor.prepare(&hertz_rig, p, 0.1, 1e-9, scratch);
        steady_segment(0.0, 0.0, &e);
        e.changed = true;
        e.wave[0].amplitude *= tone;
        e.wave[0].offset = 0.1;
        check_int("it ends", taylor.bind(&hertz_rig)(&hertz_rig, p, scratch, &e, 1, x, &c), STEP_END);
        check_near("position", x[0], 1.5, 0.0);
        check_near("velocity", x[1], -0.3, 0.0);
    }
}

/* The default rig, force and base at work, contact lost. */
static void busy_rig(struct pair *p)
{
    double paper[MODEL_PARAMETERS];
    paper_defaults(&hertz_rig, paper);
    pair_start(p, &hertz_rig, paper, 0.05, 1e-10);
    pair_drive(p, RIG_FORCE, 0.8, 0.9, 0.0, 0.0);
    pair_drive(p, RIG_BASE, 0.1, 3.1, 1.0, 0.0);
    pair_run(p, 400, 0);
    check_above("contact switches so far", p->a.counts.switches, 2);
}

/* A snapshot is plant and scratch memory: taken inside a series, the run after it has the same bits. */
TEST(taylor_snapshot)
{
    static struct pair p;
    static double kept[METHOD_SCRATCH];
    uint64_t hash;
    busy_rig(&p);
    struct plant copy = p.a;
    memcpy(kept, scratch, sizeof kept);
    check_true("the plant runs on", plant_run(&p.a, 300));
    hash = plant_hash(&p.a);
    p.a = copy;
    memcpy(scratch, kept, sizeof kept);
    check_true("and again from the snapshot", plant_run(&p.a, 300));
    check_hex("state hash", plant_hash(&p.a), hash);
}

TEST(taylor_parameter_change)
{
    static struct pair p;
    double si[MODEL_PARAMETERS];
    busy_rig(&p);
    memcpy(si, p.a.si, sizeof si);
    si[RIG_DAMPING] *= 4.0;
    si[RIG_CONTACT_STIFFNESS] *= 1.3;
    check_no_error("both take new parameters", plant_change(&p.a, si));
    check_no_error("both take new parameters", plant_change(&p.b, si));
    plant_set_state(&p.b, p.a.x);
    p.worst = 0.0;
    pair_run(&p, 440, 0);
    check_below("taylor against rk4 after a parameter change inside a series", p.worst, 2e-8);
}

/* A state put in place inside a series, with inputs that only run on. */
TEST(taylor_set_state)
{
    static struct pair p;
    static const double state[4][2] = {{1.4, -0.3}, {-0.5, 0.2}, {0.05, 0.4}, {2.5, 0.0}};
    busy_rig(&p);
    p.worst = 0.0;
    for (int i = 0; i < 4; i++) {
        plant_set_state(&p.a, state[i]);
        plant_set_state(&p.b, state[i]);
        pair_run(&p, p.a.now.tick + 9, 0);
    }
    check_below("taylor against rk4 after states set inside a series", p.worst, 2e-8);
}
