/* test_plant_change.c - parameters: what is refused, and what goes on when they change live. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "tests/fixture/rig.h"

/* The default rig, shaken by all four drives, one of them in a ramp and one on a sample's slope. */
static void start_shaken(struct plant *pl)
{
    struct plant_config c = {.model = &hertz_rig, .method = &rk4, .tick_s = 1e-3 / 64.0, .dilation = 2.0};
    check_no_error("default rig", plant_init(pl, &c));
    plant_drive(pl, RIG_FORCE, 30.0, 80.0, 0.2, 0.001);
    plant_drive(pl, RIG_FAST_FORCE, 10.0, 700.0, 0.0, 0.01);
    plant_drive(pl, RIG_BASE, 4e-7, 500.0, 1.0, 0.0);
    plant_drive(pl, RIG_STIFFNESS, 0.1, 300.0, 0.0, 0.0);
    check_true("runs", plant_advance(pl, (struct instant){900, 7777}));
    plant_drive(pl, RIG_FORCE, 45.0, 100.0, 0.2, 0.01);
    plant_sample(pl, RIG_BASE, 1e-6, 600);
    check_true("runs", plant_advance(pl, (struct instant){1000, 12345}));
}

/* Input i and its rate in SI, as the plant last used it. */
static double input_si(const struct plant *pl, int i, double *rate)
{
    double unit = scale_of(&pl->scale, hertz_rig.input_signal[i].quantity);
    *rate = pl->segment.at[2][i].rate * unit / pl->scale.time_s;
    return pl->segment.at[2][i].value * unit;
}

/* m v^2/2 + (2/5) k pen^(5/2) - N z by its SI formula; v in real seconds. */
static double energy_si(const struct plant *pl, const double *si)
{
    double z = pl->x[0] * pl->scale.length_m, v = plant_read(pl, "velocity") * pl->dilation, rate;
    double pen = fmax(z - input_si(pl, RIG_BASE, &rate), 0.0);
    return 0.5 * si[RIG_MASS] * v * v + 0.4 * si[RIG_CONTACT_STIFFNESS] * pow(pen, 2.5) - si[RIG_PRELOAD] * z;
}

/* Parameters that a user could set, one at a time and then all together. */
static void new_parameters(int which, double *si)
{
    const double factor[] = {1.3, 0.6, 1.7, 2.5};
    for (int i = 0; i < 4; i++)
        si[i] = hertz_rig.parameter[i].initial * (i == which || which == 4 ? factor[i] : 1.0);
}

static double relative(double a, double b)
{
    return fabs(a - b) / fmax(fabs(b), 1e-300);
}

/* Back to the old parameters at once: the bookings cancel. */
static void check_twice(struct plant pl, const double *old, double booked)
{
    check_near("booked before, J", sum_of(&pl.ledger.change) * pl.scale.energy_J, booked, 1e-16);
    check_no_error("accepted", plant_change(&pl, old));
    check_near("there and back, J", sum_of(&pl.ledger.change) * pl.scale.energy_J, 0.0, 1e-16);
}

TEST(plant_change)
{
    for (int which = 0; which < 5; which++) {
        struct plant pl;
        double si[4], old[4], rate[4], off = 0.0, now;
        start_shaken(&pl);
        new_parameters(9, old);
        new_parameters(which, si);
        double z = plant_read(&pl, "displacement"), v = plant_read(&pl, "velocity"), before[4];
        double stored = energy_si(&pl, old), residual = plant_residual(&pl),
               force = pl.peak_force * pl.scale.force_N;
        for (int i = 0; i < 4; i++)
            before[i] = input_si(&pl, i, &rate[i]);
        double damping = sum_of(&pl.ledger.damping) * pl.scale.energy_J;
        double sample = pl.drive[RIG_BASE].sample * pl.scale.length_m;
        check_no_error("accepted", plant_change(&pl, si));
        check_below("displacement goes on, relative", relative(plant_read(&pl, "displacement"), z), 1e-15);
        check_below("velocity goes on, relative", relative(plant_read(&pl, "velocity"), v), 1e-15);
        for (int i = 0; i < 4; i++) {
            double again;
            off = fmax(off, relative(input_si(&pl, i, &again), before[i]));
            off = fmax(off, relative(again, rate[i]));
        }
        check_below("inputs and their rates go on in SI, relative", off, 1e-14);
        check_below("peak force goes on, relative", relative(pl.peak_force * pl.scale.force_N, force), 1e-14);
        check_below("sample goes on, relative",
                    relative(pl.drive[RIG_BASE].sample * pl.scale.length_m, sample), 1e-14);
        check_near("energy by the SI formula, J", plant_energy(&pl), energy_si(&pl, si), 1e-14);
        check_near("energy booked for the change, J", sum_of(&pl.ledger.change) * pl.scale.energy_J,
                   energy_si(&pl, si) - stored, 1e-16);
        check_near("damping so far, J", sum_of(&pl.ledger.damping) * pl.scale.energy_J, damping, 1e-16);
        check_near("residual, J", plant_residual(&pl), residual, 1e-16);
        check_twice(pl, old, energy_si(&pl, si) - stored);
        /* the next tick joins: a step of 1/64 ms moves inputs by a bounded amount, a wrong unit by 30 % */
        rig_run(&pl, 1);
        off = 0.0;
        for (int i = 0; i < 4; i++) {
            now = input_si(&pl, i, &rate[i]) - before[i];
            off = fmax(off, fabs(now) / (fabs(rate[i]) * 2.0 * pl.tick_s + 0.02 * fabs(before[i])));
        }
        check_below("inputs a tick later, over what their rates allow", off, 1.0);
        rig_run(&pl, 20000);
        check_near("base after its slope and at 500 Hz: amplitude in SI",
                   pl.drive[RIG_BASE].amplitude * pl.scale.length_m, 4e-7, 1e-20);
        check_near("sample at its end, m", pl.drive[RIG_BASE].sample * pl.scale.length_m, 1e-6, 1e-20);
        check_near("force ramped to its end, N", pl.drive[RIG_FORCE].amplitude * pl.scale.force_N, 45.0,
                   1e-12);
        check_below("residual afterwards over the damping",
                    fabs(plant_residual(&pl)) / (sum_of(&pl.ledger.damping) * pl.scale.energy_J), 1e-6);
    }
}

/* After a change the plant moves as one that was made
 * with the new parameters and set to the same SI state. */
static void check_same_motion(void)
{
    struct plant pl, fresh;
    double si[4];
    struct plant_config c = {.model = &hertz_rig, .si = si, .method = &rk4, .tick_s = 1e-5, .dilation = 1.0};
    new_parameters(9, si);
    check_no_error("old rig", plant_init(&pl, &c));
    plant_set_state(&pl, (double[]){1.8, 0.3});
    rig_run(&pl, 500);
    double z = plant_read(&pl, "displacement"), v = plant_read(&pl, "velocity");
    new_parameters(4, si);
    check_no_error("changed", plant_change(&pl, si));
    check_no_error("new rig", plant_init(&fresh, &c));
    plant_set_state(&fresh,
                    (double[]){z / fresh.scale.length_m, v * fresh.scale.time_s / fresh.scale.length_m});
    rig_run(&pl, 2000);
    rig_run(&fresh, 2000);
    check_near("position against a rig made so", pl.x[0], fresh.x[0], 1e-11);
    check_near("velocity", pl.x[1], fresh.x[1], 1e-11);
    check_near("residual, without drives", plant_residual(&pl) / pl.scale.energy_J, 0.0, 1e-9);
}

TEST(plant_change_refused)
{
    struct plant pl, before;
    double si[4];
    check_same_motion();
    start_shaken(&pl);
    before = pl;
    new_parameters(9, si);
    si[RIG_MASS] = -1.0;
    check_string("negative mass", plant_change(&pl, si), "parameter outside its range");
    check_string("would be refused", plant_accepts(&pl, si), "parameter outside its range");
    new_parameters(9, si);
    si[RIG_DAMPING] = 1e5;
    check_contains("overdamped", plant_change(&pl, si), "overdamped");
    new_parameters(9, si);
    si[RIG_MASS] = 1e-3;
    check_contains("too fast for the step", plant_change(&pl, si), "step too coarse");
    check_bytes("a refusal changes nothing", &pl, &before, sizeof pl);
    new_parameters(4, si);
    check_no_error("good ones would be taken", plant_accepts(&pl, si));
    check_bytes("asking changes nothing", &pl, &before, sizeof pl);
}

/* The share of time apart counts seconds: half a second open and half a second closed are one half, whatever
 * the unit of model time was in each. */
TEST(plant_change_loss_time)
{
    struct plant pl;
    double si[4];
    struct plant_config c = {.model = &hertz_rig, .si = si, .method = &rk4, .tick_s = 1e-5, .dilation = 1.0};
    new_parameters(9, si);
    check_no_error("rig", plant_init(&pl, &c));
    plant_set_state(&pl, (double[]){-1000.0, 0.0}); /* falls for more than 50 model times */
    rig_run(&pl, 1000);
    check_near("apart all the time", pl.loss_time / pl.total_time, 1.0, 0.0);
    si[RIG_MASS] *= 3.0;
    check_no_error("changed", plant_change(&pl, si));
    plant_set_state(&pl, (double[]){1.0, 0.0});
    rig_run(&pl, 1000);
    check_near("half of the time", pl.loss_time / pl.total_time, 0.5, 1e-12);
}

static const char *refusal(double tick_s, double dilation, int which, double value,
                           const struct method *method)
{
    static struct plant pl;
    double si[4];
    struct plant_config c = {
        .model = &hertz_rig, .si = si, .method = method, .tick_s = tick_s, .dilation = dilation};
    new_parameters(9, si);
    if (which >= 0)
        si[which] = value;
    const char *why = plant_init(&pl, &c);
    return why ? why : "";
}

static size_t some_scratch(const struct model *m)
{
    (void)m;
    return 10;
}

TEST(plant_init_refusals)
{
    const double tick = 1e-3 / 64.0;
    struct method greedy = rk4;
    greedy.n_scratch = some_scratch;
    const struct {
        const char *name, *part;
        double tick, dilation;
        int which;
        double value;
        const struct method *method;
    } c[] = {
        {"tick of 0", "tick outside", 0.0, 1.0, -1, 0.0, &rk4},
        {"tick below 0", "tick outside", -tick, 1.0, -1, 0.0, &rk4},
        {"tick not a number", "tick outside", (double)NAN, 1.0, -1, 0.0, &rk4},
        {"tick of 1e7 s", "tick outside", 1e7, 1.0, -1, 0.0, &rk4},
        {"dilation 0", "dilation outside", tick, 0.0, -1, 0.0, &rk4},
        {"dilation not a number", "dilation outside", tick, (double)NAN, -1, 0.0, &rk4},
        {"dilation infinite", "dilation outside", tick, (double)INFINITY, -1, 0.0, &rk4},
        {"no scratch memory", "scratch memory", tick, 1.0, -1, 0.0, &greedy},
        {"mass 0", "outside its range", tick, 1.0, RIG_MASS, 0.0, &rk4},
        {"mass not a number", "outside its range", tick, 1.0, RIG_MASS, (double)NAN, &rk4},
        {"negative damping", "outside its range", tick, 1.0, RIG_DAMPING, -1e-9, &rk4},
        {"stiffness infinite", "outside its range", tick, 1.0, RIG_CONTACT_STIFFNESS, (double)INFINITY, &rk4},
        {"compression of more than a metre", "compression", tick, 1.0, RIG_CONTACT_STIFFNESS, 1.0, &rk4},
        {"overdamped", "overdamped", tick, 1.0, RIG_DAMPING, 3e4, &rk4},
        {"too coarse a step", "step too coarse", 1e-3, 1.0, -1, 0.0, &rk4},
        {"too little dilation", "step too coarse", tick, 0.1, -1, 0.0, &rk4},
    };
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        const char *why = refusal(c[i].tick, c[i].dilation, c[i].which, c[i].value, c[i].method);
        if (!strstr(why, c[i].part))
            check_string(c[i].name, why, c[i].part);
        else
            check_true(c[i].name, 1);
    }
    check_string("a good one", refusal(tick, 1.0, -1, 0.0, &rk4), "");
    /* the guard's edge: 0.2 rad of the contact's eigenfrequency, 1/time_s */
    struct scale s;
    double p[MODEL_DERIVED], si[4];
    new_parameters(9, si);
    hertz_rig.prepare(si, p, &s);
    check_string("just finer than the guard", refusal(0.1999 * s.time_s, 1.0, -1, 0.0, &rk4), "");
    check_contains("just coarser", refusal(0.2001 * s.time_s, 1.0, -1, 0.0, &rk4), "step too coarse");
}

TEST(plant_check)
{
    double si[4];
    int which;
    for (int i = 0; i < 4; i++) {
        const double edge[] = {hertz_rig.parameter[i].min, hertz_rig.parameter[i].max};
        const double beyond[] = {edge[0] - fmax(1e-30, edge[0] * 1e-9), edge[1] * (1.0 + 1e-9)};
        for (int k = 0; k < 2; k++) {
            new_parameters(9, si);
            si[i] = beyond[k];
            check_error("refused beyond its range", plant_check(&hertz_rig, si, &which));
            check_int("named", which, i);
            si[i] = edge[k];
            const char *why = plant_check(&hertz_rig, si, &which);
            check_true("an edge is inside", !why || !strstr(why, "range"));
        }
    }
    new_parameters(9, si);
    si[RIG_DAMPING] = 3e4;
    check_error("against each other", plant_check(&hertz_rig, si, &which));
    check_int("none is to blame", which, -1);
    new_parameters(9, si);
    check_no_error("the defaults are good", plant_check(&hertz_rig, si, &which));
}
