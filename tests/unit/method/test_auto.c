/* test_auto.c - which method auto takes, and that both give equal bits, through changes of parameters too. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/method/auto.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/models.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/bus.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/trajectory.h"

static double scratch[METHOD_SCRATCH], other_scratch[METHOD_SCRATCH];

static void defaults(const struct model *m, double *p, struct scale *scale)
{
    double si[MODEL_PARAMETERS];
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    m->prepare(si, p, scale);
}

/* The choice at a step of `angle` radians of the contact. */
static const struct method *choice(const struct model *m, double angle, double tol)
{
    double p[MODEL_DERIVED] = {0};
    struct scale scale;
    defaults(m, p, &scale);
    return auto_choice(m, p, angle / m->eigenfrequency(p), tol, NULL, NULL);
}

static void check_choice(const struct model *m, double angle, double tol, const struct method *expected)
{
    check_string(check_name("%s, %g rad, tolerance %g", m->name, angle, tol), choice(m, angle, tol)->name,
                 expected->name);
}

TEST(auto_choice)
{
    const struct model *const hertzian[3] = {&hertz_rig, &rolling_contact, &afm_tip};
    for (int i = 0; i < 3; i++) {
        check_choice(hertzian[i], 0.19, 0.0, &taylor);
        check_choice(hertzian[i], 0.0015, 0.0, &taylor);
        check_choice(hertzian[i], 0.0015, 1e-9, &taylor);
        check_choice(hertzian[i], 0.02, 1e-4, &rk4);
        check_choice(hertzian[i], 0.0249, 1e-3, &adams);
        check_choice(hertzian[i], 0.0251, 1e-3, &rk4);
        check_choice(hertzian[i], 0.0249, 0.99e-3, &rk4);
        check_choice(hertzian[i], 0.0249, 0.011, &rk4);
        check_choice(hertzian[i], 0.19, 0.05, &rk4);
        check_choice(hertzian[i], 0.21, 0.05, &taylor); /* rk4 does not take this step */
        check_choice(hertzian[i], 1.0, 0.1, &taylor);
        for (int k = 2; k < 10; k++) {
            double tol = pow(10.0, -k), angle = pow(tol, 0.4);
            check_choice(hertzian[i], angle * 0.999, tol, &rk4);
            check_choice(hertzian[i], angle * 1.001, tol, &taylor);
        }
    }
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        if (m->hertz_form)
            continue;
        const struct method *best = m->linear ? &exact : m->modal_form ? &modal : &taylor;
        check_choice(m, 0.1, 0.0, best);
        check_choice(m, 0.01, 1e-2, best);
    }
    check_choice(&hertz_rig_linear, 2.05, 0.0, &exact);
    check_choice(&hertz_rig_linear, 60.0, 0.0, &exact);
    struct model odd = hertz_rig_linear;
    odd.n_states = 3;
    odd.name = "a linear model that is not in second-order form";
    check_choice(&odd, 0.1, 0.0, &taylor);
    struct model plain = hertz_rig;
    plain.hertz_form = NULL;
    plain.name = "a model with nothing but rhs";
    check_choice(&plain, 0.1, 1e-9, &rk4);
}

/* Follows a stored trajectory at the longest step with which rk4 is taken, at least 8 in a drive's period.
 * The error is at most the tolerance asked, times the growth of an error at the start. */
static void check_tolerance(const struct trajectory *r)
{
    for (int k = 2; k < 6; k++) {
        double tol = pow(10.0, -k), steps = 6.2831853 / (0.999 * pow(tol, 0.4));
        steps = fmax(steps, 64.0);
        struct trajectory_errors e = trajectory_run(r, &auto_method, tol, scratch, steps);
        check_below(check_name("%s, tolerance %g: error over it and the growth", r->name, tol),
                    e.state / tol / fmax(r->growth, 1.0), 2.0);
    }
}

TEST(auto_tolerance)
{
    check_int("trajectories", trajectory_each("tests/data/rig_trajectories.txt", check_tolerance), 10);
}

static void check_refused(const struct model *m, double angle, double tol, const char *part)
{
    double p[MODEL_DERIVED] = {0};
    struct scale scale;
    defaults(m, p, &scale);
    const char *why = auto_method.refuse(m, p, angle / m->eigenfrequency(p), tol);
    check_string(m->name, why && strstr(why, part) ? part : why, part);
}

TEST(auto_refusals)
{
    struct model plain = hertz_rig;
    plain.hertz_form = NULL;
    check_refused(&shaft_bearing, 4.0, 1e-3, "too coarse for exact");
    check_refused(&hertz_rig, 1.0, 1e-15, "taylor: tolerance outside");
    check_refused(&hertz_rig, 1e-3, -1.0, "taylor: tolerance outside");
    check_refused(&hertz_rig, 1e-3, (double)NAN, "taylor: tolerance outside");
    check_refused(&hertz_rig, 1.0, 0.2, "taylor: tolerance outside");
    check_refused(&hertz_rig, 50.0, 0.0, "step too long for taylor");
    check_refused(&hertz_rig_cubic, 50.0, 1e-9, "step too long for taylor");
    check_refused(&hertz_rig_linear, 70.0, 0.0, "too coarse for exact");
    check_refused(&plain, 0.3, 0.0, "too coarse for rk4");
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        double p[MODEL_DERIVED] = {0};
        struct scale scale;
        defaults(m, p, &scale);
        check_no_error(m->name, auto_method.refuse(m, p, 0.1 / m->eigenfrequency(p), 0.0));
        check_below("its scratch memory", (double)auto_method.n_scratch(m), METHOD_SCRATCH);
    }
}

/* One run by auto, in memory full of rubbish, and by the method that it takes: equal bits. */
static void check_bits_of(const struct model *m, const double *paper, double h, double tol,
                          const double *state, const struct method *expected)
{
    struct plant a, b;
    for (int i = 0; i < METHOD_SCRATCH; i++)
        scratch[i] = (double)NAN;
    paper_start_by(&a, m, &auto_method, tol, scratch, paper, h, state);
    paper_start_by(&b, m, expected, tol, other_scratch, paper, h, state);
    check_string(m->name, auto_now(a.scratch)->name, expected->name);
    check_true("both stay finite", plant_run(&a, 3000) && plant_run(&b, 3000));
    check_above("switches", a.counts.switches, m->n_contacts ? 2 : 0);
    check_hex("state hash", plant_hash(&a), plant_hash(&b));
}

TEST(auto_bits)
{
    double paper[MODEL_PARAMETERS];
    const double lost[2] = {1.8, 0.0}, inside[2] = {0.5, 0.0}, shaft[6] = {0, 0, 0, 0.3, 0.2, 0.3};
    paper_defaults(&hertz_rig, paper);
    paper[paper_index(&hertz_rig, "a_stiff")] = 0.2;
    check_bits_of(&hertz_rig, paper, 0.05, 1e-3, lost, &rk4);
    check_bits_of(&hertz_rig, paper, 0.05, 0.0, lost, &taylor);
    paper[paper_index(&hertz_rig, "a_stiff")] = 0.0;
    paper[paper_index(&hertz_rig, "sigma")] = 0.5;
    check_bits_of(&hertz_rig, paper, 0.02, 1e-3, lost, &adams);
    paper_defaults(&hertz_rig_cubic, paper);
    check_bits_of(&hertz_rig_cubic, paper, 0.05, 0.0, inside, &taylor);
    paper_defaults(&hertz_rig_linear, paper);
    check_bits_of(&hertz_rig_linear, paper, 0.3, 0.0, inside, &exact);
    paper_defaults(&shaft_bearing, paper);
    check_bits_of(&shaft_bearing, paper, 1e-4, 0.0, shaft, &exact);
}

/* `pl` as a plant of its own by this method, with fresh tables in `memory`. */
static struct plant alone(const struct plant *pl, const struct method *method, double *memory)
{
    struct plant copy = *pl;
    copy.method = method;
    copy.step = method->bind(pl->model);
    copy.bind_run = NULL;
    copy.scratch = memory;
    method->prepare(pl->model, pl->p, pl->h, pl->tol, memory);
    return copy;
}

/* Parameters turn the choice, to and fro, in the middle of a motion with contact lost. Each time it goes
 * on as if the new method had always been there, and the mass stays where it is. */
TEST(auto_change)
{
    struct plant pl;
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS];
    paper_defaults(&hertz_rig, paper);
    paper[paper_index(&hertz_rig, "sigma")] = 0.5;
    paper_start_by(&pl, &hertz_rig, &auto_method, 1e-3, scratch, paper, 0.04, (double[]){1.8, 0.0});
    memcpy(si, pl.si, sizeof si);
    double soft = si[RIG_CONTACT_STIFFNESS];
    for (int turn = 0; turn < 6; turn++) {
        const struct method *expected = turn % 2 ? &taylor : &rk4;
        check_string("the method", auto_now(pl.scratch)->name, expected->name);
        struct plant copy = alone(&pl, expected, other_scratch);
        check_true("both stay finite", plant_run(&pl, 333) && plant_run(&copy, 333));
        check_hex("state hash", plant_hash(&pl), plant_hash(&copy));
        double metres = pl.x[0] * pl.scale.length_m;
        si[RIG_CONTACT_STIFFNESS] = turn % 2 ? soft : 8.0 * soft;
        check_no_error("new parameters are taken", plant_change(&pl, si));
        check_near("the mass stays where it is", pl.x[0] * pl.scale.length_m / metres, 1.0, 1e-15);
    }
    check_above("switches", pl.counts.switches, 10);
}

/* Several ticks in one call where the drives allow rk4, single steps under a fast one, which taylor takes. */
TEST(auto_blocks)
{
    struct plant pl;
    double paper[MODEL_PARAMETERS];
    paper_defaults(&hertz_rig, paper);
    paper[paper_index(&hertz_rig, "sigma")] = 0.5;
    for (int turn = 0; turn < 2; turn++) {
        paper[paper_index(&hertz_rig, "omega")] = turn ? 30.0 : 0.9;
        paper_start_by(&pl, &hertz_rig, &auto_method, 1e-3, scratch, paper, 0.04, (double[]){1.8, 0.0});
        check_true("finite", plant_run(&pl, 3));
        check_string("the method", auto_now(scratch)->name, turn ? "taylor" : "rk4");
        run_function *by_auto = pl.bind_run ? pl.bind_run(&hertz_rig, scratch) : NULL;
        check_true("several ticks", by_auto == (turn ? NULL : rk4.bind_run(&hertz_rig, NULL)));
    }
}

/* The change of parameters over the bus. */
TEST(auto_bus)
{
    static struct bus bus;
    struct app_config c = bus_config();
    c.method = &auto_method;
    c.tol = 4e-3;
    c.scratch = scratch;
    bus_start_running(&bus, &c);
    bus_drive(&bus, RIG_FORCE, 50.0, 200.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 32, 0);
    bus_run(&bus, 20);
    const struct plant *pl = &bus.app.plant;
    check_above("switches by rk4", pl->counts.switches, 2);
    for (int turn = 0; turn < 4; turn++) {
        const struct method *expected = turn % 2 ? &rk4 : &taylor;
        bus_set_now(&bus, RIG_MASS, turn % 2 ? 6.5 : 2.0);
        check_int("new parameters", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
        check_string("the method", auto_now(pl->scratch)->name, expected->name);
        struct plant copy = alone(pl, expected, other_scratch);
        memcpy(other_scratch, &scratch[METHOD_AUTO_SCRATCH],
               sizeof other_scratch - METHOD_AUTO_SCRATCH * sizeof *other_scratch); /* inside a series */
        uint64_t ticks = copy.now.tick;
        bus_run(&bus, 15);
        check_true("a plant alone", plant_run(&copy, pl->now.tick - ticks));
        check_hex("state hash", plant_hash(pl), plant_hash(&copy));
    }
    bus_set_now(&bus, RIG_MASS, 1e-6);
    check_int("a step too coarse for any is refused", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
}
