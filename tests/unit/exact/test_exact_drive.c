/* test_exact_drive.c - method exact under waves of every kind, and what it carries from tick to tick. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/reduced/shaft_mode.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/gap_oscillator.h"
#include "tests/fixture/paper.h"

/* One method on one model, segment by segment. */
struct walk {
    const struct model *m;
    const struct method *method;
    double p[MODEL_DERIVED], scratch[METHOD_SCRATCH], x[MODEL_STATES];
    unsigned regime;
    int switches;
};

/* The segment to its end, cut at its switches, in `parts` equal parts. */
static void walk_segment(struct walk *w, const struct segment *e, int parts)
{
    struct segment rest = *e, head;
    struct crossing c;
    for (int i = 0; i < parts; i++) {
        double part = rest.length / (parts - i);
        segment_head(&rest, w->m->n_inputs, part, &head);
        head.changed = e->changed || parts > 1;
        while (w->method->bind(w->m)(w->m, w->p, w->scratch, &head, w->regime, w->x, &c) == STEP_SWITCH) {
            segment_tail(&head, w->m->n_inputs, c.done);
            w->regime ^= 1u << c.contact;
            w->switches++;
        }
        segment_tail(&rest, w->m->n_inputs, part);
    }
}

static double between(uint64_t *seed, double low, double high)
{
    return low + (high - low) * exact_uniform(seed);
}

/* Waves at random, of one kind after the other; model time. */
static void random_wave(uint64_t *seed, int kind, double h, struct wave *w)
{
    double angle = between(seed, -3.0, 3.0);
    *w = (struct wave){.cosine = cos(angle), .sine = sin(angle), .omega = 0.3};
    if (kind & 1)
        w->offset = between(seed, -0.3, 0.3), w->slope = (kind & 8) ? between(seed, -0.1, 0.1) : 0.0;
    if (kind & 2)
        w->amplitude = between(seed, -0.5, 0.5), w->growth = (kind & 4) ? between(seed, -0.2, 0.2) : 0.0;
    if (kind & 16)
        w->omega = between(seed, 0.0, 3.1 / h);
}

/* exact against rk4 in 200 parts a segment, on the same waves; each segment from the same state. */
static void check_waves(const char *name, const struct model *m, const double *si, double h, double tolerance,
                        int at_least)
{
    static struct walk a, b;
    struct scale scale;
    uint64_t seed = 11;
    double worst = 0.0;
    memset(&a, 0, sizeof a);
    m->prepare(si, a.p, &scale);
    b = a;
    a.m = b.m = m;
    a.method = &exact;
    b.method = &rk4;
    exact.prepare(m, a.p, h, 0.0, a.scratch);
    for (int n = 0; n < 640; n++) {
        struct segment e;
        memset(&e, 0, sizeof e);
        e.length = n % 5 ? h : h * between(&seed, 0.0, 1.0);
        e.active = (unsigned)(n / 32) % (1u << m->n_inputs);
        e.changed = n % 3 == 0;
        for (int i = 0; i < m->n_inputs; i++)
            random_wave(&seed, n % 32, h, &e.wave[i]);
        segment_tail(&e, m->n_inputs, 0.0); /* the three instants */
        e.changed = n % 3 == 0;
        memcpy(b.x, a.x, sizeof b.x);
        b.regime = a.regime;
        walk_segment(&a, &e, 1);
        walk_segment(&b, &e, 200);
        for (int k = 0; k < m->n_states; k++)
            worst = fmax(worst, fabs(a.x[k] - b.x[k]));
        if (a.regime != b.regime)
            check_hex("regime at the end of a segment", a.regime, b.regime);
    }
    check_below(name, worst, tolerance);
    check_int("switches of rk4", a.switches, b.switches);
    check_above("switches", a.switches, at_least);
}

static void shaft_parameters(double *si)
{
    for (int i = 0; i < shaft_bearing.n_parameters; i++)
        si[i] = shaft_bearing.parameter[i].initial;
}

TEST(exact_waves)
{
    double si[MODEL_PARAMETERS];
    const double oscillator[GAP_PARAMETERS] = {0.03, 1.0, 50.0, 1e6},
                 rigid[GAP_PARAMETERS] = {0.0, 0.0, 0.0, 1e6},
                 critical[GAP_PARAMETERS] = {1.0, 1.0, 0.0, 1e6};
    shaft_parameters(si);
    check_waves("shaft, no contact", &shaft_bearing_linear, si, 0.5, 1e-9, 0);
    check_waves("oscillator with base", &gap_oscillator, oscillator, 0.2, 1e-9, 0);
    check_waves("free mass", &gap_oscillator, rigid, 0.2, 1e-9, 0);
    check_waves("critical damping", &gap_oscillator, critical, 0.5, 1e-9, 0);
}

TEST(exact_waves_contact)
{
    double si[MODEL_PARAMETERS];
    const double oscillator[GAP_PARAMETERS] = {0.03, 1.0, 50.0, 0.2};
    shaft_parameters(si);
    check_waves("shaft with contacts", &shaft_bearing, si, 0.5, 1e-8, 50);
    check_waves("oscillator with contacts", &gap_oscillator, oscillator, 0.2, 1e-8, 50);
}

static void shaft_start(struct gap_run *r, const struct method *method, double tick_s)
{
    double si[MODEL_PARAMETERS];
    const struct harmonic drive[3] = {{0.0, 0.0, 0.0}, {8.0, 6.283185307179586 * 25.0, 0.2}, {0.0, 0.0, 0.0}};
    const double x[6] = {0.1, 0.0, -0.1, 0.0, 0.0, 0.0};
    shaft_parameters(si);
    gap_start(r, &shaft_bearing, method, si, drive, tick_s, x);
}

/* The plant's own drives: ramps, a new frequency, held and sloping samples. rk4 at the same tick, without
 * contact: its error there is (omega h)^4/120 = 1e-9. */
TEST(exact_plant_drives)
{
    static struct gap_run a, b;
    const struct method *const method[2] = {&exact, &rk4};
    struct gap_run *const run[2] = {&a, &b};
    double worst = 0.0;
    for (int i = 0; i < 2; i++)
        shaft_start(run[i], method[i], 2e-6);
    for (int n = 0; n < 200; n++) {
        for (int i = 0; i < 2; i++) {
            struct plant *pl = &run[i]->plant;
            if (n == 20)
                plant_drive(pl, 1, 4.0, 31.0, 1.0, 1e-3);
            if (n == 60)
                plant_drive(pl, 0, 3.0, 400.0, 0.0, 5e-4);
            if (n == 90)
                plant_sample(pl, 2, 2.0, 0);
            if (n == 120)
                plant_sample(pl, 2, -1.0, 333);
            if (n == 160)
                plant_drive(pl, 0, 0.0, 400.0, 0.0, 2e-4);
            gap_advance(run[i], 50, NULL, NULL);
        }
        for (int k = 0; k < 6; k++)
            worst = fmax(worst, fabs(a.plant.x[k] - b.plant.x[k]));
    }
    check_int("no contact", a.n_events + b.n_events, 0);
    check_below("exact against rk4", worst, 1e-9);
}

static double distance(const struct plant *a, const struct plant *b)
{
    double worst = 0.0;
    for (int k = 0; k < 6; k++)
        worst = fmax(worst, fabs(a->x[k] - b->x[k]));
    return worst;
}

/* A state put in place is where the motion goes on from, in its own regime. */
TEST(exact_state_set)
{
    static struct gap_run a, b;
    const double x[6] = {1.2, 0.9, -0.5, 0.1, 0.0, 0.2};
    shaft_start(&a, &exact, 5e-5);
    shaft_start(&b, &exact, 5e-5);
    gap_advance(&a, 1000, NULL, NULL);
    gap_advance(&b, 1000, NULL, NULL);
    check_near("two plants", distance(&a.plant, &b.plant), 0.0, 0.0);
    plant_set_state(&a.plant, x);
    gap_advance(&a, 3, NULL, NULL);
    /* b: the same in a plant that never was elsewhere */
    memset(b.scratch, 0, sizeof b.scratch);
    exact.prepare(&shaft_bearing, b.plant.p, b.plant.h, 0.0, b.scratch);
    plant_set_state(&b.plant, x);
    gap_advance(&b, 3, NULL, NULL);
    check_near("with fresh tables", distance(&a.plant, &b.plant), 0.0, 1e-14);
}

/* New parameters reach the tables, and the way back is a way back. */
TEST(exact_parameter_change)
{
    static struct gap_run a, b;
    double si[MODEL_PARAMETERS];
    shaft_start(&a, &exact, 5e-5);
    shaft_start(&b, &exact, 5e-5);
    gap_advance(&a, 100, NULL, NULL);
    gap_advance(&b, 100, NULL, NULL);
    shaft_parameters(si);
    si[SHAFT_KS1] *= 3.0;
    check_no_error("accepted", plant_change(&a.plant, si));
    gap_advance(&a, 100, NULL, NULL);
    gap_advance(&b, 100, NULL, NULL);
    check_above("the motion is another one", distance(&a.plant, &b.plant), 1e-2);
    shaft_parameters(si);
    check_no_error("accepted", plant_change(&a.plant, si));
    plant_set_state(&a.plant, b.plant.x);
    gap_advance(&a, 100, NULL, NULL);
    gap_advance(&b, 100, NULL, NULL);
    check_near("back", distance(&a.plant, &b.plant), 0.0, 1e-13);
}

/* Plant and work, copied, go on bit for bit; the plant alone, to rounding. */
TEST(exact_snapshot)
{
    static struct gap_run a, b, c;
    shaft_start(&a, &exact, 5e-5);
    plant_drive(&a.plant, 1, 40.0, 31.0, 1.0, 0.02);
    gap_advance(&a, 333, NULL, NULL);
    b = a;
    b.plant.scratch = b.scratch;
    c = a;
    c.plant.scratch = c.scratch;
    exact.prepare(&shaft_bearing, c.plant.p, c.plant.h, 0.0, c.scratch);
    for (int n = 0; n < 10; n++) {
        gap_advance(&a, 20, NULL, NULL);
        gap_advance(&b, 20, NULL, NULL);
        gap_advance(&c, 20, NULL, NULL);
    }
    check_above("switches since", a.n_events, 10);
    check_hex("plant and work", plant_hash(&b.plant), plant_hash(&a.plant));
    check_near("plant alone", distance(&a.plant, &c.plant), 0.0, 1e-9);
}

/* ---- peak forces ---- */

/* The rotor's first mode is thrown from 0.9 of the clearance of bearing 3, which is the closer and the softer
 * one, at a speed in units of the model. The largest force by `method` up to loss, in those of the model. */
static double peak_of(const struct method *method, double speed)
{
    static double work[METHOD_SCRATCH];
    static struct plant thrown;
    struct event e = {.touch = true};
    double si[MODEL_PARAMETERS];
    for (int i = 0; i < shaft_bearing_mode.n_parameters; i++)
        si[i] = shaft_bearing_mode.parameter[i].initial;
    si[SHAFT_G3] = 0.6 * si[SHAFT_G1];
    si[SHAFT_KG3] = 0.2 * si[SHAFT_KG1];
    struct plant_config c = {.model = &shaft_bearing_mode,
                             .si = si,
                             .method = method,
                             .tick_s = 1e-5,
                             .dilation = 1.0,
                             .scratch = work};
    check_no_error(method->name, plant_init(&thrown, &c));
    plant_set_state(&thrown, (double[]){0.5, speed});
    for (int k = 0; k < 100000 && e.touch; k++)
        if (!plant_run(&thrown, 1) || (plant_take_event(&thrown, &e) && !e.touch))
            break;
    check_true("lost again", !e.touch);
    return e.peak_force / thrown.scale.force_N;
}

/* Both sides of a bearing of one mode close at one position, and the other bearing's behind them. */
TEST(exact_peak_one_mode)
{
    for (int k = 0; k < 3; k++) {
        double speed = 0.3 * (1 << 2 * k), truth = peak_of(&rk4, speed);
        check_above("a force", truth, 1e-3);
        check_near(check_name("peak at %g over that of rk4", speed), peak_of(&exact, speed) / truth, 1.0,
                   1e-3);
    }
}
