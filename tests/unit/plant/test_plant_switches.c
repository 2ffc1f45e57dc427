/* test_plant_switches.c - contact switches of the running
 * plant: instants, speeds, forces, times, and hard cases. */
#include "tests/unit/test.h"

#include <math.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/hertz_rig.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/rig.h"

#define TWO_PI 6.283185307179586477

/* Time in contact of a free period from eta_max, by quadrature of the energy from the top down with
 * eta = top (1 - s^2): no singular end. */
static double contact_time(double top)
{
    enum { N = 200000 };
    double sum = 0.0;
    for (int i = 0; i < N; i++) {
        double s = (i + 0.5) / N, eta = top * (1.0 - s * s);
        /* half of v^2 is the energy above that at eta, about (top - eta)(2/3)(top^1.5 - 1) near the top */
        double v2 = (4.0 / 3.0) * (0.4 * (pow(top, 2.5) - pow(eta, 2.5)) - (top - eta));
        sum += 2.0 * top * s / sqrt(v2) / N;
    }
    return 2.0 * sum;
}

/* Nothing that could be apart is never apart. */
static void check_no_contact(void)
{
    struct plant pl;
    struct plant_config c = {.model = &hertz_rig_linear, .method = &rk4, .tick_s = 1e-5, .dilation = 1.0};
    check_no_error("a linear rig", plant_init(&pl, &c));
    rig_run(&pl, 100);
    check_near("time apart without a contact", pl.loss_time, 0.0, 0.0);
    check_near("of all the time, to 100 roundings", pl.total_time, 100.0 * pl.h, 2e-14);
}

/* The flight is a parabola under the preload, 3 v0 long: its share of the period. */
TEST(plant_loss_time)
{
    const double top[] = {1.9, 2.5, 3.5};
    for (int i = 0; i < 3; i++) {
        double paper[PAPER], contact = contact_time(top[i]);
        double flight = 3.0 * sqrt((4.0 / 3.0) * (0.4 * pow(top[i], 2.5) - top[i]));
        struct plant pl;
        rig_paper(paper);
        paper[XI] = 0.0;
        rig_start(&pl, paper, (contact + flight) / 4096.0, 1.5 * (top[i] - 1.0), 0.0);
        rig_run(&pl, 4096 * 20);
        check_near("share of the time apart", pl.loss_time / pl.total_time, flight / (contact + flight),
                   1e-8);
        check_int("switches in 20 periods", pl.counts.switches, 40);
        check_near("peak force over the preload", pl.peak_force, pow(top[i], 1.5), 1e-5);
        check_near("time that pieces add up to", pl.total_time / (4096 * 20 * pl.h), 1.0, 1e-11);
    }
    check_no_contact();
}

/* More switches than the ring holds: the newest stay, in order, the others are counted. */
static double event_x[PLANT_EVENTS][MODEL_STATES];

TEST(plant_events)
{
    double paper[PAPER], last = 0.0, top = 1.9;
    struct plant pl;
    struct event e;
    int n = 0, wrong_kind = 0, wrong_order = 0;
    rig_paper(paper);
    paper[XI] = 0.0;
    rig_start(&pl, paper, 0.01, 1.5 * (top - 1.0), 0.0);
    pl.event_x = event_x;
    rig_run(&pl, 50 * 669);
    uint32_t switches = pl.counts.switches;
    double period = contact_time(top) + 3.0 * sqrt((4.0 / 3.0) * (0.4 * pow(top, 2.5) - top));
    double v0 = sqrt((4.0 / 3.0) * (0.4 * pow(top, 2.5) - top)), speed = 0.0, instant = 0.0, peak = 0.0,
           gap = 0.0;
    check_int("events lost", pl.counts.events_lost, switches - PLANT_EVENTS);
    while (plant_take_event(&pl, &e)) {
        uint32_t i = switches - PLANT_EVENTS + (uint32_t)n; /* even: lift-off */
        double t = ((double)e.tick + e.fraction) * pl.tick_s;
        double truth = (i / 2) * period + contact_time(top) / 2.0 + (i % 2 ? 3.0 * v0 : 0.0);
        wrong_kind += e.touch != (i % 2 == 1) || e.contact != 0;
        wrong_order += t <= last || e.fraction < 0.0 || e.fraction > 1.0;
        instant = fmax(instant, fabs(t - truth));
        speed = fmax(speed, fabs(e.speed - v0));
        speed = fmax(speed, fabs(fabs(e.x[1]) - v0));
        gap = fmax(gap, fabs(e.x[0]));
        peak = fmax(peak, fabs(e.peak_force - (e.touch ? 0.0 : pow(top, 1.5))));
        last = t;
        n++;
    }
    check_int("events kept", n, PLANT_EVENTS);
    check_int("of the wrong kind", wrong_kind, 0);
    check_int("out of order", wrong_order, 0);
    check_below("instants against the truth ones, up to 50 periods", instant, 2e-6);
    check_below("gap that is left at the switches", gap, 4e-15);
    check_below("peak force at each lift-off, 0 at touchdown", peak, 1e-5);
    check_below("speeds at the switches", speed, 1e-7);
    check_true("none is left", !plant_take_event(&pl, &e));
}

/* Landing exactly at the end of a tick: whatever rounding
 * says, there is one switch, not none and not several. */
TEST(plant_switch_at_tick_end)
{
    double paper[PAPER], h = 0.015625;
    int wrong = 0, residual = 0;
    rig_paper(paper);
    paper[XI] = 0.0;
    for (int sense = 0; sense < 2; sense++) {
        double lo = 0.3,
               hi = 1.7; /* speed at the start; bisected to the one that just switches in the tick */
        double x0 = sense ? 0.016 : -0.016, sign = sense ? -1.0 : 1.0;
        for (int i = 0; i < 60; i++) {
            double v = 0.5 * (lo + hi);
            struct plant pl;
            rig_start(&pl, paper, h, 0.0, 0.0);
            plant_set_state(&pl, (double[]){x0, sign * v});
            rig_run(&pl, 1);
            if (pl.counts.switches > 0)
                hi = v;
            else
                lo = v;
        }
        for (int k = -20; k <= 20; k++) {
            struct plant pl;
            rig_start(&pl, paper, h, 0.0, 0.0);
            plant_set_state(&pl, (double[]){x0, sign * (hi + k * 1.2e-16)});
            rig_run(&pl, 1);
            wrong += pl.counts.switches > 1;
            rig_run(&pl, 10);
            wrong += pl.counts.switches != 1 || pl.regime != (sense ? 0u : 1u);
            residual += (int)pl.counts.residual;
        }
    }
    check_int("starts where a switch at a tick's end is missed or doubled", wrong, 0);
    check_int("roots that kept a residual", residual, 0);
}

/* For the rest of a tick after a switch a method gets every input from the switch's own instant on. */
TEST(plant_inputs_after_switch)
{
    double paper[PAPER], t, fast;
    struct plant pl;
    struct event e = {0};
    rig_paper(paper);
    paper[SIGMA] = 0.9;
    paper[OMEGA] = 0.7;
    paper[FAST_OMEGA] = 2.9;
    paper[A_FORCE] = 0.4;
    paper[A_BASE] = 0.3;
    paper[A_STIFF] = 0.2;
    rig_start(&pl, paper, 0.1, 1.0, 0.0);
    pl.event_x = event_x;
    while (pl.n_event == 0 && pl.now.tick < 10000)
        rig_run(&pl, 1);
    check_true("a switch", plant_take_event(&pl, &e));
    t = ((double)e.tick + e.fraction) * pl.h;
    fast = cos(2.9 * t);
    const double value[] = {0.9 * cos(0.7 * t), 0.4 * fast, 0.2 * fast, 0.2 * fast};
    for (int i = 0; i < 4; i++)
        check_near("input at the switch", pl.segment.at[0][i].value, value[i], 1e-12);
    check_near("what is left of the tick", pl.segment.length, (1.0 - e.fraction) * pl.h, 1e-15);
    check_near("speed of the mass against the base", e.speed, fabs(e.x[1] + 0.2 * 2.9 * sin(2.9 * t)), 1e-12);
}

/* Peaks below the preload, of which a force lifts all but a fifth: free bounces from eta = 0.7 on. The
 * peak force is 0.7^1.5 preloads before each lift-off. The speed there follows from the energy. */
TEST(plant_peak_force)
{
    const double si[] = {6.5, 3.4e9, 64.0, 0.0},
                 speed = sqrt((4.0 / 3.0) * (0.4 * pow(0.7, 2.5) - 0.2 * 0.7));
    struct plant_config c = {.model = &hertz_rig, .si = si, .method = &rk4, .tick_s = 5e-6, .dilation = 1.0};
    struct plant pl;
    struct event e = {0};
    check_no_error("a rig without damping", plant_init(&pl, &c));
    rig_run(&pl, 10);
    plant_sample(&pl, RIG_FORCE, -0.8 * 64.0, 0);
    plant_set_state(&pl, (double[]){0.7, 0.0});
    check_near("none yet", pl.peak_force, 0.0, 0.0);
    while (pl.regime != 0 && pl.now.tick < 6000)
        rig_run(&pl, 1);
    check_near("kept in flight", pl.peak_force, pow(0.7, 1.5), 1e-6);
    rig_run(&pl, 6000);
    check_above("switches", pl.counts.switches, 5.0);
    while (plant_take_event(&pl, &e)) {
        check_near(e.touch ? "touchdown: 0" : "lift-off, N", e.peak_force,
                   e.touch ? 0.0 : 64.0 * pow(0.7, 1.5), 1e-4);
        check_near("speed, m/s", e.speed, speed * pl.scale.length_m / pl.scale.time_s, 1e-8);
    }
}

/* The mass rises to an apex that is `beyond` past the point of lift-off, or short of it, in the middle of a
 * tick. The speed at the start is from the energy; near the apex the arc is eta = t^2/3 - beyond. */
static void graze(double beyond, struct plant *pl)
{
    const double depth = 1e-4;
    double paper[PAPER];
    rig_paper(paper);
    paper[XI] = 0.0;
    rig_start(pl, paper, 0.04, 0.0, 0.0);
    plant_set_state(pl, (double[]){depth, -sqrt((4.0 / 3.0) * (beyond + depth - 0.4 * pow(depth, 2.5)))});
    rig_run(pl, 3);
}

TEST(plant_grazing)
{
    int odd = 0, open = 0, residual = 0, missed = 0, false_alarm = 0;
    double worst = 0.0;
    for (int k = 0; k < 200; k++) {
        struct plant pl;
        struct event up, down;
        double beyond =
            4e-5 * pow(10.0, -0.075 * k); /* down to 5e-20: what is below 1e-9 may go either way */
        graze(beyond, &pl);
        odd += pl.counts.switches % 2 || pl.counts.switches > 2 || pl.counts.budget;
        residual += pl.counts.residual != 0;
        open += pl.regime != 1;
        missed += pl.counts.switches == 0 && beyond > 1e-9;
        if (beyond > 1e-6 && plant_take_event(&pl, &up) && plant_take_event(&pl, &down)) {
            double apart = ((double)down.tick + down.fraction - (double)up.tick - up.fraction) * pl.h;
            worst = fmax(worst, fabs(apart / (2.0 * sqrt(3.0 * beyond)) - 1.0));
        }
        graze(-beyond, &pl);
        odd += pl.counts.switches % 2 || pl.counts.switches > 2 || pl.counts.budget;
        open += pl.regime != 1;
        false_alarm += pl.counts.switches != 0 && beyond > 1e-9;
    }
    check_int("grazing arcs with other than 0 or 2 switches", odd, 0);
    check_int("left with the wrong regime", open, 0);
    check_int("roots with a residual", residual, 0);
    check_int("dips past zero by more than 1e-9 that were missed", missed, 0);
    check_int("dips short of zero by more than 1e-9 taken for switches", false_alarm, 0);
    check_below("time apart against the parabola's, relative", worst, 1e-4);
}

/* 1e7 ticks with a drive and contact loss: phase truth, energy balanced, nothing drifts. */
TEST(plant_soak)
{
    double paper[PAPER];
    struct plant pl;
    rig_paper(paper);
    paper[XI] = 0.05;
    paper[SIGMA] = 0.6;
    paper[OMEGA] = 0.8;
    rig_start(&pl, paper, 0.01, 0.0, 0.0);
    double turns = paper[OMEGA] / TWO_PI * pl.tick_s;
    uint64_t step = (uint64_t)ldexp(turns, 64);
    rig_run(&pl, 10000000);
    check_int("tick", (int64_t)pl.now.tick, 10000000);
    check_hex("carrier of the drive", pl.drive[0].carrier, step * 10000000u);
    check_above("switches", pl.counts.switches, 20000.0);
    check_int("segments out of budget", pl.counts.budget, 0);
    check_int("roots with a residual", pl.counts.residual, 0);
    check_above("energy through the damper, J", sum_of(&pl.ledger.damping), 1e3);
    check_below("residual over it",
                fabs(plant_residual(&pl)) / (pl.scale.energy_J * sum_of(&pl.ledger.damping)), 1e-8);
    check_near("time that pieces add up to", pl.total_time / 1e5, 1.0, 1e-9);
}
