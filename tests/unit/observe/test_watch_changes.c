/* test_watch_changes.c - the watch on `changes` and on `drive_frequency`.
 *
 * Each kind of command that changes the certified scene trips it at its tick; other commands do not. Ramps
 * of frequency trip by closed form. */
#include <math.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

#define PI 3.14159265358979324

static struct bus bus;
static double scratch[METHOD_SCRATCH];

/* ---- changes ---- */

static const struct watch_limits any_change = {MODEL_CHANGES, -(double)INFINITY, 0.0};

/* The rig on the bus, running, a drive sounding where
 * it is asked for; its watch begins to count from here. */
static void start_changes(bool driven)
{
    struct app_config c = bus_config();
    c.watch = &any_change;
    bus_start(&bus, &c);
    if (driven)
        plant_drive_start(&bus.app.plant, RIG_FORCE, 2.0, 50.0, 0.0);
    bus_run(&bus, 1);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 5);
    check_int("nothing has changed yet", bus.app.plant.counts.changes, 0);
}

static uint64_t now(void)
{
    return bus.app.plant.now.tick;
}

/* No trip so far; after one more frame it is that of this tick, the first change of all. */
static void check_next_frame(const char *what, uint64_t tick)
{
    check_int(what, bus.app.count[DIAG_WATCH_TRIPS], 0);
    bus_run(&bus, 1);
    check_int("  trips", bus.app.count[DIAG_WATCH_TRIPS], 1);
    check_int("  at the end of its tick", (int64_t)bus.app.watch.tick, (int64_t)tick);
    check_near("  STATUS", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 1, 0);
    check_near("  no fault", bus_value(&bus, WIRE_STATUS, STATUS_FAULTS), 0, 0);
    check_near("  WATCH names it", bus_value(&bus, WIRE_WATCH, WATCH_OBSERVABLE), MODEL_CHANGES, 0);
    check_near("  its tick", bus_value(&bus, WIRE_WATCH, WATCH_TICK), (double)(uint16_t)tick, 0);
    check_near("  one", bus_value(&bus, WIRE_WATCH, WATCH_VALUE), 1.0, 0);
}

/* Three frames and five ticks ahead, within a tick and at its end; ARM by itself changes nothing. */
TEST(watch_changes_fire)
{
    for (unsigned fraction = 0; fraction < 256; fraction += 128) {
        start_changes(false);
        uint64_t tick = now() + 3 * BUS_TICKS + 5;
        bus_drive(&bus, RIG_FORCE, 2.0, 50.0, 0.0, 0.0);
        bus_drive(&bus, RIG_BASE, 1e-9, 70.0, 0.0, 0.0);
        bus_fire(&bus, 1u << RIG_FORCE | 1u << RIG_BASE, false, tick, fraction);
        bus_run(&bus, 3);
        check_next_frame("a FIRE that waits", tick + (fraction > 0));
        bus_run(&bus, 20);
        check_int("one command, one change", bus.app.plant.counts.changes, 1);
        check_int("and one trip", bus.app.count[DIAG_WATCH_TRIPS], 1);
        check_int("told once", bus_count(&bus, WIRE_WATCH), 1);
    }
}

/* A parameter, also of the value that it has; with a FIRE; a sample at its frame; noise. */
TEST(watch_changes_kinds)
{
    double mass = hertz_rig.parameter[RIG_MASS].initial;
    start_changes(false);
    bus_set(&bus, RIG_MASS, mass);
    check_next_frame("a parameter", now() + 1);
    start_changes(false);
    struct staged set = {{0}, {0}};
    uint64_t tick = now() + BUS_TICKS + 7;
    staged_put(&set, RIG_MASS, mass);
    bus_write(&bus, RIG_MASS, mass);
    bus_commit(&bus, &set, COMMIT_WITH_FIRE);
    bus_fire(&bus, 0, true, tick, 64);
    bus_run(&bus, 1);
    check_next_frame("a parameter with a FIRE", tick + 1);
    start_changes(false);
    tick = now() + 2 * BUS_TICKS;
    bus_stream(&bus, RIG_FORCE, tick / BUS_TICKS, 1.0);
    bus_run(&bus, 2);
    check_next_frame("a sample", tick + 1);
    start_changes(false);
    tick = now() + 3;
    bus_arm(&bus, RIG_FORCE, ARM_NOISE, 0.1);
    bus_fire(&bus, 1u << RIG_FORCE, false, tick, 1);
    check_next_frame("noise", tick + 1);
}

/* Plant time stands after a stop: seen with the first tick
 * after the next start. Without a drive it ends nothing. */
TEST(watch_changes_stop)
{
    for (int driven = 0; driven < 2; driven++)
        for (int by_enable = 0; by_enable < 2; by_enable++) {
            start_changes(driven);
            uint64_t tick = now();
            if (by_enable)
                bus_enable(&bus, false);
            else
                bus_order(&bus, CONTROL_STOP);
            bus_silent(&bus, 1);
            bus_next_session(&bus);
            bus_run(&bus, 3);
            bus_order(&bus, CONTROL_START);
            if (driven)
                check_next_frame("a stop of a drive", tick + 1);
            bus_run(&bus, 10);
            check_int("changes", bus.app.plant.counts.changes, driven);
            check_int("trips", bus.app.count[DIAG_WATCH_TRIPS], driven);
        }
}

/* The count goes on over a reset, which clears the flag:
 * with its own first tick the plant is outside again. */
TEST(watch_changes_reset)
{
    start_changes(false);
    bus_order(&bus, CONTROL_PAUSE);
    bus_run(&bus, 2);
    bus_order(&bus, CONTROL_RESET);
    bus_run(&bus, 2);
    uint64_t tick = now();
    bus_order(&bus, CONTROL_START);
    check_next_frame("a reset", tick + 1);
    bus_order_now(&bus, CONTROL_PAUSE);
    bus_order_now(&bus, CONTROL_RESET);
    check_near("STATUS: cleared by a reset", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 0, 0);
    tick = now();
    bus_order_now(&bus, CONTROL_START);
    check_int("outside as before", (int64_t)bus.app.watch.tick, (int64_t)tick + 1);
    check_near("by the second change", bus.app.watch.value, 2.0, 0.0);
}

/* No heartbeat for timeout_frames: what the reaction does to drives counts, and nothing else of it. */
TEST(watch_changes_timeout)
{
    static const enum reaction reactions[] = {REACTION_RAMP, REACTION_ZERO, REACTION_HOLD};
    for (int k = 0; k < 6; k++) {
        bool driven = k % 2 == 0, ended = driven && reactions[k / 2] != REACTION_HOLD;
        start_changes(driven);
        bus_set(&bus, SETTING_FIRST + SET_TIMEOUT_FRAMES, 10.0);
        bus_set(&bus, SETTING_FIRST + SET_REACTION, reactions[k / 2]);
        bus_set_now(&bus, SETTING_FIRST + SET_REACTION_RAMP_S, 0.002);
        while (bus.app.count[DIAG_TIMEOUTS] == 0 && !bus.app.watch.tripped)
            bus_silent(&bus, 1);
        check_int("a time-out, trips", bus.app.count[DIAG_WATCH_TRIPS], ended);
        if (ended) /* the frame in which it was found has run on */
            check_int("  at the first tick of its frame", (int64_t)bus.app.watch.tick,
                      (int64_t)now() - BUS_TICKS + 1);
        bus_silent(&bus, 20);
        check_int("  changes", bus.app.plant.counts.changes, ended);
    }
}

/* Commands that are refused, only ask, or touch neither drives nor parameters nor state: no trip. */
TEST(watch_changes_none)
{
    start_changes(true);
    bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 3.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, now() - 3, 0);    /* late */
    bus_fire(&bus, 1u << RIG_BASE, false, now() + 3, 0);     /* nothing armed */
    bus_stream(&bus, RIG_FORCE, now() / BUS_TICKS - 1, 1.0); /* late */
    bus_write(&bus, RIG_MASS, 3.0);                          /* staged only */
    bus_set(&bus, RIG_MASS, -1.0);                           /* out of range */
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_FRAMES, 10.0);
    bus_set(&bus, SETTING_FIRST + SET_SENSOR_STUCK, 1.0);
    bus_command(&bus, WIRE_PARAM_READ, (double[WIRE_FIELDS]){0, RIG_MASS});
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM});
    bus_order(&bus, CONTROL_RESET); /* not while it runs */
    bus_run(&bus, 2);
    check_above("some of it was refused: late", bus.app.count[DIAG_LATE], 1);
    check_above("out of range", bus.app.count[DIAG_RANGE], 0);
    check_above("not in this state", bus.app.count[DIAG_STATE], 0);
    bus_order(&bus, CONTROL_PAUSE);
    bus_run(&bus, 3);
    bus_control(&bus, CONTROL_STEP, 2);
    bus_run(&bus, 5);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 300);
    check_int("no change", bus.app.plant.counts.changes, 0);
    check_int("no trip", bus.app.count[DIAG_WATCH_TRIPS], 0);
    check_near("STATUS", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 0, 0);
}

/* It climbs at the tick of the change, as a plant alone
 * that is told the same; the climb is no change itself. */
TEST(watch_changes_climb)
{
    static double own[METHOD_SCRATCH];
    struct app_config c = bus_config();
    c.model = &hertz_rig_linear;
    c.method = &auto_method;
    c.tol = 1e-6;
    c.scratch = scratch;
    c.watch = &any_change;
    c.promote = &hertz_rig;
    bus_start_running(&bus, &c);
    plant_set_state(&bus.app.plant, (double[]){1.2, 0.0});
    bus_run(&bus, 5);
    struct plant alone = bus.app.plant;
    memcpy(own, scratch, sizeof own);
    alone.scratch = own;
    uint64_t tick = now() + 2 * BUS_TICKS + 9;
    bus_drive(&bus, RIG_FORCE, 2.0, 50.0, 0.0, 0.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, tick, 0);
    bus_run(&bus, 2);
    check_string("not before", bus.app.plant.model->name, hertz_rig_linear.name);
    bus_run(&bus, 30);
    check_true("alone: to the fire", plant_run(&alone, tick - alone.now.tick));
    plant_drive(&alone, RIG_FORCE, 2.0, 50.0, 0.0, 0.0);
    check_no_error("alone: climbs", plant_promote(&alone, &hertz_rig));
    check_true("alone: goes on", plant_run(&alone, now() - tick));
    check_string("it is the full model", bus.app.plant.model->name, hertz_rig.name);
    check_hex("and the same plant", plant_hash(&bus.app.plant), plant_hash(&alone));
    check_int("changes", bus.app.plant.counts.changes, 1);
}

/* The start of a scene is no change, and a scene that is left alone does not trip. */
TEST(watch_changes_scene)
{
    struct scene s = scenes_find("rig")->scene;
    struct watch_limits l;
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    s.drive[RIG_BASE] = (struct scene_drive){.noise = 1e-9};
    s.watch = (struct scene_watch){1.0, MODEL_CHANGES, 0.0, -SCENE_UNBOUNDED, NULL};
    scenes_resolve(&s, si, drive);
    check_near("at the start", scenes_watched(&s, si, drive), 0.0, 0.0);
    check_true("watched", plant_scene_watch(&s, 1000.0, &l));
    check_near("a number, whatever the dilation", l.high, 0.0, 0.0);
    struct app_config c = bus_config();
    c.si = si;
    c.watch = &l;
    bus_start(&bus, &c);
    plant_scene_begin(&bus.app.plant, &s, si, drive);
    bus_run(&bus, 1);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 500);
    check_above("it moves", fabs(plant_read(&bus.app.plant, "velocity")), 0.0);
    check_int("no trip", bus.app.count[DIAG_WATCH_TRIPS], 0);
}

/* ---- drive_frequency ---- */

static void rig_alone(struct plant *pl)
{
    struct plant_config c = {.model = &hertz_rig, .method = &rk4, .tick_s = 1e-3 / 64.0, .dilation = 2.0};
    check_no_error("a rig", plant_init(pl, &c));
}

/* Ticks until the watch trips, up to `most`. */
static uint64_t ticks_to_trip(struct plant *pl, struct watch *w, uint64_t most)
{
    uint64_t n = 0;
    while (n < most && !w->tripped) {
        if (!plant_run(pl, 1))
            check_true("finite", 0);
        watch_tick(w, pl);
        n++;
    }
    return n;
}

/* From f0 to f1 over a ramp of n ticks the frequency is
 * linear in time: at tick k it is f0 + (f1 - f0) k/n. */
TEST(watch_drive_frequency)
{
    const double f0 = 100.0, f1 = 300.0, limit = 217.3;
    const int n = 640;
    struct plant pl;
    struct watch w;
    double worst = 0.0;
    rig_alone(&pl);
    check_near("silence", watch_read(&pl, MODEL_DRIVE_FREQUENCY), 0.0, 0.0);
    plant_drive_start(&pl, RIG_FORCE, 1.0, f0, 0.0);
    check_near("Hz of the bus", watch_read(&pl, MODEL_DRIVE_FREQUENCY), f0, 1e-9);
    check_no_error("watched",
                   watch_start(&w, &(struct watch_limits){MODEL_DRIVE_FREQUENCY, 0.0, limit}, pl.model));
    check_int("steady: no trip", (int64_t)ticks_to_trip(&pl, &w, 100), 100);
    plant_drive(&pl, RIG_FORCE, 1.0, f1, 0.0, n * pl.tick_s);
    int64_t expected = (int64_t)ceil((limit - f0) / (f1 - f0) * n);
    check_int("up: the first tick above", (int64_t)ticks_to_trip(&pl, &w, 1000), expected);
    check_near("its value", w.value, f0 + (f1 - f0) * (double)expected / n, 1e-9);
    for (int k = (int)expected + 1; k <= n; k++) {
        check_true("finite", plant_run(&pl, 1));
        worst = fmax(worst, fabs(watch_read(&pl, MODEL_DRIVE_FREQUENCY) - (f0 + (f1 - f0) * k / n)));
    }
    check_below("along the ramp, Hz", worst, 1e-9);
    check_true("beyond", plant_run(&pl, 50));
    check_near("at its end", watch_read(&pl, MODEL_DRIVE_FREQUENCY), f1, 1e-9);
    plant_drive(&pl, RIG_FORCE, 0.0, f1, 0.0, 4 * pl.tick_s);
    check_true("down", plant_run(&pl, 3));
    check_near("still sounding", watch_read(&pl, MODEL_DRIVE_FREQUENCY), f1, 1e-9);
    check_true("down", plant_run(&pl, 1));
    check_near("silent", watch_read(&pl, MODEL_DRIVE_FREQUENCY), 0.0, 0.0);
}

/* With several drives the highest frequency counts, whichever input it is at; a sample and noise have
 * none. */
TEST(watch_drive_frequency_most)
{
    struct plant pl;
    rig_alone(&pl);
    plant_drive_start(&pl, RIG_FORCE, 1.0, 40.0, 0.0);
    plant_drive_start(&pl, RIG_STIFFNESS, 1e-3, 90.0, 0.0);
    plant_drive_start(&pl, RIG_BASE, 1e-9, 70.0, 0.0);
    plant_sample(&pl, RIG_FAST_FORCE, 1.0, 0);
    check_near("the second", watch_read(&pl, MODEL_DRIVE_FREQUENCY), 90.0, 1e-9);
    plant_drive(&pl, RIG_STIFFNESS, 0.0, 400.0, 0.0, 0.0);
    check_true("runs", plant_run(&pl, 2));
    check_near("the third, when that has ended", watch_read(&pl, MODEL_DRIVE_FREQUENCY), 70.0, 1e-9);
    plant_reset(&pl);
    plant_noise(&pl, RIG_FORCE, 0.1, 4, 1, 0.0);
    check_true("runs", plant_run(&pl, 10));
    check_near("noise", watch_read(&pl, MODEL_DRIVE_FREQUENCY), 0.0, 0.0);
}

/* A silent drive sounds from the tick after its FIRE's on; below the limit it does not trip. */
TEST(watch_drive_frequency_bus)
{
    const struct watch_limits l = {MODEL_DRIVE_FREQUENCY, -(double)INFINITY, 80.0};
    struct app_config c = bus_config();
    c.watch = &l;
    bus_start_running(&bus, &c);
    bus_drive(&bus, RIG_FORCE, 2.0, 79.0, 0.0, 0.0);
    bus_fire(&bus, 1u << RIG_FORCE, false, 2 * BUS_TICKS, 0);
    bus_run(&bus, 10);
    check_int("below: no trip", bus.app.count[DIAG_WATCH_TRIPS], 0);
    uint64_t tick = now() + BUS_TICKS + 4;
    bus_drive(&bus, RIG_BASE, 1e-9, 81.0, 0.0, 0.0);
    bus_fire(&bus, 1u << RIG_BASE, false, tick, 0);
    bus_run(&bus, 2);
    check_int("above: at the first tick of its sound", (int64_t)bus.app.watch.tick, (int64_t)tick + 1);
    check_near("WATCH names it", bus_value(&bus, WIRE_WATCH, WATCH_OBSERVABLE), MODEL_DRIVE_FREQUENCY, 0);
    check_near("and its Hz", bus_value(&bus, WIRE_WATCH, WATCH_VALUE), 81.0, 1e-5);
}

/* At a scene's start, and its limits: Hz of the real plant, angular in a dimensionless scene. */
TEST(watch_drive_frequency_scene)
{
    struct scene s = scenes_find("rig")->scene;
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    struct watch_limits l;
    s.drive[RIG_FORCE].frequency_Hz = 150.0;
    s.drive[RIG_BASE] = (struct scene_drive){.amplitude = -1e-9, .frequency_Hz = 170.0};
    s.drive[RIG_STIFFNESS] = (struct scene_drive){.amplitude = 0.0, .frequency_Hz = 900.0};
    s.watch = (struct scene_watch){1.0, MODEL_DRIVE_FREQUENCY, 300.0, -SCENE_UNBOUNDED, NULL};
    scenes_resolve(&s, si, drive);
    check_near("the highest that sounds, Hz", scenes_watched(&s, si, drive), 170.0, 1e-10);
    check_true("watched", plant_scene_watch(&s, 10.0, &l));
    check_near("slower on the bus", l.high, 30.0, 1e-12);
    s = scenes_find("kb-fig16")->scene;
    s.watch = (struct scene_watch){1.0, MODEL_DRIVE_FREQUENCY, 2.0 * PI, -SCENE_UNBOUNDED, NULL};
    scenes_resolve(&s, si, drive);
    double omega = 0.0;
    for (int i = 0; i < s.model->n_inputs; i++)
        omega = drive[i].amplitude != 0.0 ? fmax(omega, drive[i].omega) : omega;
    check_near("without a unit, angular", scenes_watched(&s, si, drive), omega, 1e-12);
    check_above("which it has", omega, 0.0);
    check_true("watched", plant_scene_watch(&s, 0.001, &l));
    check_near("once per unit of time, a thousand in a second", l.high, 1000.0, 1e-10);
}
