/* test_app_fault.c - trouble in the plant: a state that
 * overflows, a method that loses energy, switches without end. */
#include <math.h>
#include <stdio.h>
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

static struct bus bus;

static void fault_start(double force_N)
{
    bus_start_rig(&bus);
    bus_drive(&bus, RIG_FORCE, force_N, 215.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, BUS_TICKS, 0);
    bus_run(&bus, 10);
}

/* Floats of the telemetry that are not finite, and int24 fields that say "not available". */
static void count_not_finite(int *floats, int *not_available)
{
    *floats = *not_available = 0;
    for (int i = 0; i < bus.n_seen; i++) {
        const struct message_layout *l = wire_layout(bus.seen[i].kind);
        for (int k = 0; k < l->n_fields; k++) {
            *floats += l->field[k].kind == FIELD_FLOAT && !isfinite(bus.seen[i].value[k]);
            *not_available += l->field[k].kind == FIELD_SIGNED && isnan(bus.seen[i].value[k]);
        }
    }
}

static void check_fault_and_reset(int telemetry_is_finite)
{
    int floats, not_available;
    check_int("state", bus.app.state, STATE_FAULT);
    check_int("fault bit", bus.app.faults, FAULT_NOT_FINITE);
    bus_forget(&bus);
    uint32_t healthy = bus.wires.port[0].healthy;
    int64_t tick = (int64_t)bus.app.plant.now.tick;
    bus_run(&bus, 250);
    check_near("STATUS: state", bus_value(&bus, WIRE_STATUS, STATUS_STATE), STATE_FAULT, 0);
    check_int("plant time stands", (int64_t)bus.app.plant.now.tick, tick);
    check_int("the program answers: the watchdog is fed", bus.wires.port[0].healthy - healthy, 250);
    check_near("HEALTH: not_finite", bus_item(&bus, WIRE_HEALTH, DIAG_NOT_FINITE), 1, 0);
    check_is("drives at zero or on their way", drive_target(&bus.app.plant.drive[0]).amplitude, ==, 0.0);
    count_not_finite(&floats, &not_available);
    if (telemetry_is_finite)
        check_int("values of the telemetry that are not finite", floats + not_available, 0);
    bus_order_now(&bus, CONTROL_START);
    check_int("START in fault", bus_cause(&bus, WIRE_CONTROL), CAUSE_STATE);
    bus_order(&bus, CONTROL_RESET);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 2);
    check_int("after a reset: state", bus.app.state, STATE_RUNNING);
    check_int("faults", bus.app.faults, 0);
    bus_forget(&bus);
    bus_run(&bus, 200);
    check_near("at rest again: displacement over the compression",
               bus_value(&bus, WIRE_MOTION, MOTION_DISPLACEMENT) / bus.app.plant.scale.length_m, 1.0, 1e-4);
    count_not_finite(&floats, &not_available);
    check_int("values not available after the reset", floats + not_available, 0);
    check_int("no fault follows from the reset", bus.app.faults, 0);
    check_int("plant ticks are whole frames again", (int64_t)(bus.app.plant.now.tick % BUS_TICKS), 0);
    int64_t now = (int64_t)bus.app.plant.now.tick;
    bus_order(&bus, CONTROL_PAUSE);
    bus_control(&bus, CONTROL_RUN_UNTIL, (double)(now + 10 * BUS_TICKS));
    bus_run(&bus, 15);
    check_int("RUN_UNTIL ends where it should", (int64_t)bus.app.plant.now.tick, now + 10 * BUS_TICKS);
}

TEST(app_not_finite)
{
    fault_start(16.0);
    const double huge[] = {1.0, 1.7e308};
    int64_t tick = (int64_t)bus.app.plant.now.tick;
    plant_set_state(&bus.app.plant, huge);
    bus_run(&bus, 1);
    check_near("last good state is kept: position", bus.app.plant.x[0], 1.0, 0.0);
    check_near("velocity", bus.app.plant.x[1], 1.7e308, 0.0);
    check_int("plant time did not move", (int64_t)bus.app.plant.now.tick, tick);
    check_fault_and_reset(0); /* the energy of this state has no number */
}

/* A method that fails at its n-th step, in the middle of a frame. */
static int steps_left;
static enum step_status failing(const struct model *m, const double *p, double *scratch,
                                const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    if (steps_left-- == 0)
        return STEP_NOT_FINITE;
    return rk4.bind(m)(m, p, scratch, e, regime, x, c);
}

TEST(app_not_finite_frame)
{
    fault_start(1.0);
    struct plant alone = bus.app.plant;
    bus.app.plant.step = failing;
    bus.app.plant.bind_run = NULL;
    steps_left = 5;
    bus_run(&bus, 1);
    check_int("fails in the sixth tick of a frame: tick", (int64_t)bus.app.plant.now.tick,
              11 * BUS_TICKS - 16 + 5);
    if (!plant_run(&alone, 5))
        check_true("alone: finite", 0);
    check_bits("last good position", bus.app.plant.x[0], alone.x[0]);
    check_bits("last good velocity", bus.app.plant.x[1], alone.x[1]);
    bus.app.plant.step = alone.step;
    bus.app.plant.bind_run = NULL;
    check_fault_and_reset(1);
}

/* rk4 with a brake of its own that nobody books. */
static double brake;
static enum step_status leaking(const struct model *m, const double *p, double *scratch,
                                const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    enum step_status s = rk4.bind(m)(m, p, scratch, e, regime, x, c);
    x[1] *= 1.0 - brake * e->length;
    return s;
}

/* The rig's damping is 2 xi; a brake b takes b v^2 where the damper takes 2 xi v^2. */
TEST(app_ledger_alarm)
{
    for (int i = 0; i < 4; i++) {
        fault_start(i == 3 ? 1e-6 : 16.0); /* the last: a motion of some 1e-6 static compressions */
        double damper = bus.app.plant.p[RIG_P_TWO_XI];
        bus_set(&bus, SETTING_FIRST + SET_LEDGER_ALARM, 0.05);
        if (i == 2) /* it is judged, whatever is told */
            bus_set(&bus, SETTING_FIRST + SET_SUMMARY_EVERY, 0.0);
        for (int k = 0; k < 30; k++, bus_forget(&bus))
            bus_run(&bus, 100); /* energy that flowed long ago must not make the alarm deaf */
        check_int("sound method: faults", bus.app.faults, 0);
        bus.app.plant.step = leaking;
        bus.app.plant.bind_run = NULL;
        brake = (i == 0 ? 0.01 : 0.5) * damper; /* 1 % of the damping, far below the alarm; 50 %, above */
        bus_run(&bus, 300);
        printf("      brake of %g of the damping, alarm at 0.05 of what flows\n", i == 0 ? 0.01 : 0.5);
        check_int("fault bit", bus.app.faults, i == 0 ? 0 : FAULT_LEDGER);
        check_int("the plant goes on: it is a warning", bus.app.state, STATE_RUNNING);
    }
    /* Sound again and reset: the alarm must not ring from what was before. */
    bus.app.plant.step = rk4.bind(&hertz_rig);
    bus.app.plant.bind_run = NULL;
    bus_order(&bus, CONTROL_PAUSE);
    bus_order(&bus, CONTROL_RESET);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 300);
    check_int("after a reset: faults", bus.app.faults, 0);
    /* Nor from a change of the units that the energy is counted in. */
    fault_start(16.0);
    bus_set(&bus, SETTING_FIRST + SET_LEDGER_ALARM, 0.3);
    bus.app.plant.step = leaking;
    bus.app.plant.bind_run = NULL;
    brake = 0.1 * bus.app.plant.p[RIG_P_TWO_XI];
    bus_run(&bus, 1000);
    check_int("a small leak over a second: faults", bus.app.faults, 0);
    bus_set(&bus, RIG_PRELOAD, 6.4);
    bus_run(&bus, 150);
    check_int("preload to a tenth: faults", bus.app.faults, 0);
}

/* A method that finds a switch wherever it looks: cut into
 * pieces up to the bound, then run through, told and counted. */
static enum step_status chattering(const struct model *m, const double *p, double *scratch,
                                   const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    if (regime & REGIME_ANY)
        return rk4.bind(m)(m, p, scratch, e, regime, x, c);
    *c = (struct crossing){.done = 0.25 * e->length};
    return STEP_SWITCH;
}

TEST(app_switch_budget)
{
    fault_start(1.0);
    bus.app.plant.step = chattering;
    bus.app.plant.bind_run = NULL;
    bus_run(&bus, 1);
    check_int("fault bit", bus.app.faults, FAULT_BUDGET);
    check_int("the plant goes on", bus.app.state, STATE_RUNNING);
    check_int("tick", (int64_t)bus.app.plant.now.tick, 11 * BUS_TICKS);
    check_int("segments cut up to the bound", bus.app.plant.counts.budget, BUS_TICKS);
    check_int("pieces", bus.app.plant.counts.pieces_max, PLANT_PIECES);
}

/* Ordinary motion with contact loss, of many kinds, for seconds: no false alarm. */
TEST(app_ledger_quiet)
{
    const struct {
        double force_N, hertz, fast_N, base_m;
    } drive[] = {{16.0, 215.0, 0.0, 0.0},
                 {60.0, 180.0, 0.0, 0.0},
                 {6.0, 228.0, 30.0, 0.0},
                 {2.0, 230.0, 0.0, 3e-7},
                 {1e-4, 150.0, 0.0, 0.0}};
    for (int i = 0; i < 5; i++) {
        struct app_config c = bus_config();
        c.substeps = 64;
        bus_start_running(&bus, &c);
        bus_drive(&bus, RIG_FORCE, drive[i].force_N, drive[i].hertz, 0.0, 0.1);
        bus_drive(&bus, RIG_FAST_FORCE, drive[i].fast_N, 1840.0, 0.0, 0.1);
        bus_drive(&bus, RIG_BASE, drive[i].base_m, 1840.0, 0.0, 0.1);
        bus_fire(&bus, 7, false, 64, 0);
        for (int k = 0; k < 30; k++) {
            bus_forget(&bus);
            bus_run(&bus, 100);
            if (k == 20) /* and the decay after it */
                bus_drive(&bus, RIG_FORCE, 0.0, drive[i].hertz, 0.0, 0.1),
                    bus_fire(&bus, 1, false, bus.app.plant.now.tick + 1, 0);
        }
        printf("      force %g N at %g Hz, fast force %g N, base %g m\n", drive[i].force_N, drive[i].hertz,
               drive[i].fast_N, drive[i].base_m);
        check_int("faults after 3 s", bus.app.faults, 0);
    }
}

/* A capture that waits for a fault keeps what led to it. */
TEST(app_fault_capture)
{
    fault_start(1.0);
    bus_set(&bus, SETTING_FIRST + SET_CAPTURE_TRIGGER, TRIGGER_FAULT);
    bus_set(&bus, SETTING_FIRST + SET_CAPTURE_SAMPLES, 40);
    bus_set(&bus, SETTING_FIRST + SET_CAPTURE_PRETRIGGER, 40);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0});
    bus_run(&bus, 5);
    struct plant alone = bus.app.plant;
    bus.app.plant.step = failing;
    bus.app.plant.bind_run = NULL;
    steps_left = 5;
    bus_run(&bus, 1);
    check_int("capture full with the fault", bus.app.capture.state, CAPTURE_FULL);
    check_int("tick of the trigger", (int64_t)bus.app.capture.trigger_tick, (int64_t)alone.now.tick + 5);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_READ, 0, 40});
    bus_forget(&bus);
    bus_run(&bus, 40);
    if (!plant_run(&alone, 5))
        check_true("alone: finite", 0);
    double last = (double)NAN;
    for (int i = 0; i < bus.n_seen; i++) {
        const double *v = bus.seen[i].value;
        if (bus.seen[i].kind == WIRE_CAPTURE_DATA && v[CAPTURE_DATA_SIGNAL] == 0 &&
            v[CAPTURE_DATA_SAMPLE] == 39)
            last = v[CAPTURE_DATA_VALUE];
    }
    check_near("the last sample is the last good tick: displacement, m", last,
               (double)(float)plant_read(&alone, "displacement"), 0.0);
}

/* After a restart: the plant stands and says why until a reset command, and it is not taken for hung. */
TEST(app_last_run)
{
    enum { WATCHDOG = 5, FRAMES = 300 };
    fault_start(1.0);
    app_take_last_run(&bus.app, WATCHDOG);
    uint32_t healthy = bus.wires.port[0].healthy;
    bus_forget(&bus);
    bus_run(&bus, FRAMES);
    check_near("STATUS: state", bus_value(&bus, WIRE_STATUS, STATUS_STATE), STATE_FAULT, 0);
    check_near("STATUS: faults", bus_value(&bus, WIRE_STATUS, STATUS_FAULTS), FAULT_ASSERT, 0);
    check_near("HEALTH: last_run", bus_item(&bus, WIRE_HEALTH, DIAG_LAST_RUN), WATCHDOG, 0);
    check_is("drives at zero or on their way", drive_target(&bus.app.plant.drive[0]).amplitude, ==, 0.0);
    check_int("the watchdog is fed, or nobody could read this", bus.wires.port[0].healthy - healthy, FRAMES);
    bus_order_now(&bus, CONTROL_RESET);
    check_int("a reset acknowledges it", bus.app.faults, 0);
}
