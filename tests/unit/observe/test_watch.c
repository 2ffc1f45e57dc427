/* test_watch.c - the monitor of a choice of model: the tick at which it trips, by closed form, and its
 * messages on the bus.
 *
 * After the climb to the full model the state is equal to the last bit, the ledger balances, and the
 * motion is the full model's. */
#include <math.h>
#include <string.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/models.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { PENETRATION = 2 };
#define AMPLITUDE 0.4 /* in static compressions */
#define PI        3.14159265358979324

static struct bus bus;
static double scratch[METHOD_SCRATCH], other_scratch[METHOD_SCRATCH];

/* ---- the tick ---- */

/* The linear rig, undamped, let go at y = 1 + AMPLITUDE: y = 1 + AMPLITUDE cos(tick h). */
static void let_go(struct plant *pl)
{
    double si[RIG_PARAMETERS];
    for (int i = 0; i < RIG_PARAMETERS; i++)
        si[i] = hertz_rig_linear.parameter[i].initial;
    si[RIG_DAMPING] = 0.0;
    struct plant_config c = {.model = &hertz_rig_linear,
                             .si = si,
                             .method = &exact,
                             .tick_s = 1e-3 / 64.0,
                             .dilation = 2.0,
                             .scratch = scratch};
    check_no_error("linear rig", plant_init(pl, &c));
    plant_set_state(pl, (double[]){1.0 + AMPLITUDE, 0.0});
}

/* First tick at which cos(tick h) < level, and how far the crossing is from a tick. */
static uint64_t first_below(const struct plant *pl, double level)
{
    double at = acos(level) / pl->h;
    check_above("the crossing lies between two ticks", fabs(at - round(at)), 0.01);
    return (uint64_t)ceil(at);
}

static void run_watched(struct plant *pl, struct watch *w, uint64_t ticks, int *trips)
{
    for (uint64_t i = 0; i < ticks; i++) {
        if (!plant_run(pl, 1))
            check_true("finite", 0);
        *trips += watch_tick(w, pl);
    }
}

/* Observable `which`, whose closed form is base + size
 * cos(tick h), watched from below at level of the cosine. */
static void check_trip(int which, double base, double size, double level)
{
    struct plant pl;
    struct watch w;
    int trips = 0;
    let_go(&pl);
    const struct watch_limits l = {which, base + size * level, base + 2.0 * size};
    uint64_t tick = first_below(&pl, level), period = (uint64_t)ceil(2.0 * PI / pl.h);
    check_no_error("limits are taken", watch_start(&w, &l, pl.model));
    run_watched(&pl, &w, tick - 1, &trips);
    check_int("not before", trips, 0);
    check_true("not before", !w.tripped);
    check_true("not before", !w.outside);
    run_watched(&pl, &w, 1, &trips);
    check_int("at this tick", trips, 1);
    check_true("at this tick", w.tripped);
    check_true("at this tick", w.outside);
    check_int("at this tick", w.number, 1);
    check_int("tick", (int64_t)w.tick, (int64_t)tick);
    check_near("value over the amplitude", (w.value - base) / size, cos((double)tick * pl.h), 1e-10);
    run_watched(&pl, &w, 10 * period, &trips);
    check_int("ways out after ten more periods", trips, 11);
    check_int("the first one is kept", (int64_t)w.tick, (int64_t)tick);
    watch_clear(&w);
    check_true("cleared", !w.tripped && w.active);
}

TEST(watch_tick)
{
    struct plant pl;
    struct watch w;
    int trips = 0;
    let_go(&pl);
    double length = pl.scale.length_m, velocity = length / pl.scale.time_s;
    int n = pl.model->n_outputs;
    check_trip(0, length, AMPLITUDE * length, 0.3);
    check_trip(PENETRATION, length, AMPLITUDE * length, -0.7);
    check_trip(n, length, AMPLITUDE * length, -0.2); /* the state `position` */
    /* velocity = -amplitude sin: above a level, in bus seconds */
    const struct watch_limits l = {1, -2.0 * velocity, AMPLITUDE * velocity * 0.5};
    uint64_t tick = (uint64_t)ceil((PI + PI / 6.0) / pl.h);
    check_no_error("limits are taken", watch_start(&w, &l, pl.model));
    run_watched(&pl, &w, tick - 1, &trips);
    check_int("velocity: not before", trips, 0);
    run_watched(&pl, &w, 1, &trips);
    check_int("velocity: above its limit at this tick", (int64_t)w.tick, (int64_t)tick);
    /* inside by a billionth, a hundred periods */
    double size = AMPLITUDE * length * (1.0 + 1e-9);
    let_go(&pl);
    trips = 0;
    check_no_error("just around the motion",
                   watch_start(&w, &(struct watch_limits){0, length - size, length + size}, pl.model));
    run_watched(&pl, &w, (uint64_t)(200.0 * PI / pl.h), &trips);
    check_int("never trips", trips, 0);
    check_true("never trips", !w.tripped);
    check_true("never trips", !w.outside);
}

/* Penetration is position less the base's, both of this instant: base A cos(2 pi f t). */
TEST(watch_inputs)
{
    const double size = 1e-6, Hz = 300.0;
    struct plant pl;
    double worst = 0.0;
    let_go(&pl);
    plant_drive(&pl, RIG_BASE, size, Hz, 0.0, 0.0);
    for (int i = 1; i <= 200; i++) {
        if (!plant_run(&pl, 1))
            check_true("finite", 0);
        double base = watch_read(&pl, 0) - watch_read(&pl, PENETRATION);
        worst = fmax(worst, fabs(base / size - cos(2.0 * PI * Hz * i * 1e-3 / 64.0)));
    }
    check_below("the base's motion in penetration, over its amplitude", worst, 1e-8);
}

TEST(watch_limits)
{
    struct watch w;
    const struct model *m = &hertz_rig_linear;
    check_error("no such output",
                watch_start(&w, &(struct watch_limits){m->n_outputs + m->n_states, 0, 1}, m));
    check_error("no negative one", watch_start(&w, &(struct watch_limits){-1, 0, 1}, m));
    check_error("a state that an output names", watch_start(&w, &(struct watch_limits){5, 0, 1}, m));
    check_error("limits crossed", watch_start(&w, &(struct watch_limits){0, 1, 0}, m));
    check_error("limits equal", watch_start(&w, &(struct watch_limits){0, 1, 1}, m));
    check_error("not a number", watch_start(&w, &(struct watch_limits){0, (double)NAN, 1}, m));
    check_true("nothing is watched then", !w.active);
    check_no_error("one side", watch_start(&w, &(struct watch_limits){0, -(double)INFINITY, 1}, m));
}

static int named(const struct model *m, const char *name)
{
    int n = 0;
    for (int i = 0; i < 2 * MODEL_EIGENFREQUENCY; i++)
        n += model_observable(m, i) && !strcmp(model_observable(m, i)->name, name);
    return n;
}

/* Each name is one number, and the four bits of WATCH
 * hold it. States beyond the numbers are not observable. */
TEST(watch_numbers)
{
    for (int k = 0; k < MODELS; k++) {
        const struct model *m = model_table[k];
        int bad = (named(m, "eigenfrequency") != 1) + (named(m, "time") != 1) +
                  (named(m, "drive_frequency") != 1) + (named(m, "changes") != 1);
        for (int i = 0; i < m->n_outputs; i++)
            bad += named(m, m->output_signal[i].name) != 1;
        int numbers = m->n_outputs;
        for (int i = 0; i < m->n_states; i++) {
            bool fits = named(m, m->state_signal[i].name) == 1;
            bad += !fits && numbers < MODEL_DRIVE_FREQUENCY;
            numbers++;
        }
        for (int i = -16; i < 256; i++)
            bad += model_observable(m, i) && (i < 0 || i > 15);
        check_int(m->name, bad, 0);
    }
}

/* ---- the bus ---- */

/* Hz of the dilated rig: (3/2 k^(2/3) N^(1/3)/mass)^(1/2)/(2 pi). */
static double rig_Hz(double mass, double dilation)
{
    double k = hertz_rig.parameter[RIG_CONTACT_STIFFNESS].initial,
           N = hertz_rig.parameter[RIG_PRELOAD].initial;
    return sqrt(1.5 * cbrt(k * k * N) / mass) / (2.0 * PI * dilation);
}

/* A rig at half its speed on the bus, at rest and running, watched up to 1.5 times its eigenfrequency. */
static double start_rig(void)
{
    double mass = hertz_rig.parameter[RIG_MASS].initial;
    const struct watch_limits l = {MODEL_EIGENFREQUENCY, -(double)INFINITY, 1.5 * rig_Hz(mass, 2.0)};
    struct app_config c = bus_config();
    c.dilation = 2.0;
    c.watch = &l;
    bus_start_running(&bus, &c);
    bus_run(&bus, 5);
    check_near("eigenfrequency, Hz", watch_read(&bus.app.plant, MODEL_EIGENFREQUENCY), rig_Hz(mass, 2.0),
               1e-10);
    return mass;
}

TEST(watch_eigenfrequency)
{
    double mass = start_rig();
    bus_set(&bus, RIG_MASS, mass / 2.0);
    bus_run(&bus, 3);
    check_int("1.41 times: no trip", bus.app.count[DIAG_WATCH_TRIPS], 0);
    check_near("STATUS: not yet", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 0, 0);
    uint64_t tick = bus.app.plant.now.tick;
    bus_set_now(&bus, RIG_MASS, mass / 4.0);
    check_near("STATUS: twice is beyond", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 1, 0);
    check_near("no fault", bus_value(&bus, WIRE_STATUS, STATUS_FAULTS), 0, 0);
    check_near("WATCH names it", bus_value(&bus, WIRE_WATCH, WATCH_OBSERVABLE), MODEL_EIGENFREQUENCY, 0);
    check_near("WATCH: the frame's first tick", bus_value(&bus, WIRE_WATCH, WATCH_TICK), (double)tick + 1.0,
               0);
    check_near("WATCH: Hz of the bus, over it",
               bus_value(&bus, WIRE_WATCH, WATCH_VALUE) / rig_Hz(mass / 4.0, 2.0), 1.0, 1e-7);
    bus_set(&bus, RIG_MASS, mass);
    bus_run(&bus, 2);
    bus_set(&bus, RIG_MASS, mass / 4.0);
    bus_run(&bus, 2);
    check_int("there and back and there: two trips", bus.app.count[DIAG_WATCH_TRIPS], 2);
    check_int("told once", bus_count(&bus, WIRE_WATCH), 1);
}

/* Parameters with a FIRE inside a tick: the trip is that tick's, and not the one's before. */
TEST(watch_eigenfrequency_fire)
{
    for (unsigned fraction = 0; fraction < 256; fraction += 128) {
        double mass = start_rig();
        struct staged set = {{0}, {0}};
        float written = (float)(mass / 4.0);
        uint64_t tick = bus.app.plant.now.tick + 3 * BUS_TICKS + 5;
        staged_put(&set, RIG_MASS, (double)written);
        bus_write(&bus, RIG_MASS, (double)written);
        bus_commit(&bus, &set, COMMIT_WITH_FIRE);
        bus_fire(&bus, 0, true, tick, fraction);
        bus_run(&bus, 3);
        check_int("not before", bus_count(&bus, WIRE_WATCH), 0);
        bus_run(&bus, 1);
        check_int("applied", bus.app.count[DIAG_FIRE_APPLIED], 1);
        check_near("WATCH: the end of its tick", bus_value(&bus, WIRE_WATCH, WATCH_TICK),
                   (double)tick + (fraction > 0), 0);
        check_int("HEALTH's", bus.app.count[DIAG_WATCH_TICK], (int64_t)tick + (fraction > 0));
    }
}

/* Plant time on the bus: it stands in a pause, and a reset does not set it back. */
TEST(watch_time)
{
    const struct watch_limits l = {MODEL_TIME, -(double)INFINITY, 10.5e-3};
    const uint64_t last = 10 * BUS_TICKS + BUS_TICKS / 2; /* 10.5 frames of 1 ms: inside yet */
    struct app_config c = bus_config();
    c.dilation = 2.0;
    c.watch = &l;
    bus_start_running(&bus, &c);
    bus_run(&bus, 5);
    bus_order(&bus, CONTROL_PAUSE);
    bus_run(&bus, 20);
    bus_order(&bus, CONTROL_START);
    while (bus.app.plant.now.tick < 10 * BUS_TICKS)
        bus_run(&bus, 1);
    check_int("not before", bus_count(&bus, WIRE_WATCH), 0);
    bus_run(&bus, 1);
    check_near("WATCH names it", bus_value(&bus, WIRE_WATCH, WATCH_OBSERVABLE), MODEL_TIME, 0);
    check_near("WATCH: the first tick beyond", bus_value(&bus, WIRE_WATCH, WATCH_TICK), (double)last + 1.0,
               0);
    check_near("WATCH: bus seconds", bus_value(&bus, WIRE_WATCH, WATCH_VALUE),
               ((double)last + 1.0) * 1e-3 / BUS_TICKS, 1e-9);
    check_near("no fault", bus_value(&bus, WIRE_STATUS, STATUS_FAULTS), 0, 0);
    bus_run(&bus, 50);
    check_int("once", bus.app.count[DIAG_WATCH_TRIPS], 1);
    bus_order_now(&bus, CONTROL_PAUSE);
    bus_order_now(&bus, CONTROL_RESET);
    check_near("STATUS: cleared by a reset", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 0, 0);
    bus_order(&bus, CONTROL_START);
    bus_run(&bus, 2);
    check_int("and time is beyond as before", bus.app.count[DIAG_WATCH_TRIPS], 2);
}

/* A linear rig on the bus, running, that swings by `swing`
 * around rest; watched where penetration would end. */
static struct app_config swinging(const struct model *promote)
{
    static const struct watch_limits l = {PENETRATION, 0.0, 1.0};
    struct app_config c = bus_config();
    c.model = &hertz_rig_linear;
    c.method = &auto_method;
    c.tol = 1e-6;
    c.scratch = scratch;
    c.watch = &l;
    c.promote = promote;
    return c;
}

static void start_swinging(const struct app_config *c, double swing)
{
    bus_start_running(&bus, c);
    plant_set_state(&bus.app.plant, (double[]){1.0 + swing, 0.0});
    bus_forget(&bus);
}

TEST(watch_bus)
{
    const struct app_config c = swinging(NULL);
    start_swinging(&c, 1.5);
    struct plant alone = bus.app.plant;
    static double own[METHOD_SCRATCH];
    memcpy(own, scratch, sizeof own);
    alone.scratch = own;
    uint64_t trip = 0;
    int trips = 0;
    bool inside = true;
    for (uint64_t i = 1; i <= 1000 * BUS_TICKS; i++) {
        if (!plant_run(&alone, 1))
            check_true("alone: finite", 0);
        bool in = plant_read(&alone, "penetration") >= 0.0;
        trips += inside && !in;
        trip = trips == 1 && !trip ? alone.now.tick : trip;
        inside = in;
    }
    uint64_t frames = (trip + BUS_TICKS - 1) / BUS_TICKS;
    bus_run(&bus, (int)frames - 1);
    check_int("no WATCH before", bus_count(&bus, WIRE_WATCH), 0);
    check_near("STATUS: not yet", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 0, 0);
    bus_forget(&bus);
    bus_run(&bus, 1);
    check_int("STATUS at once", bus_count(&bus, WIRE_STATUS), 1);
    check_near("STATUS: tripped", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 1, 0);
    check_near("no fault, reaction none", bus_value(&bus, WIRE_STATUS, STATUS_REACTION), REACTION_NONE, 0);
    check_near("WATCH names penetration", bus_value(&bus, WIRE_WATCH, WATCH_OBSERVABLE), PENETRATION, 0);
    check_near("WATCH: tick", bus_value(&bus, WIRE_WATCH, WATCH_TICK), (double)trip, 0);
    double value = bus_value(&bus, WIRE_WATCH, WATCH_VALUE);
    check_is("WATCH: below 0 by less than a tick's way", value, <, 0.0);
    check_is("WATCH: below 0 by less than a tick's way", value, >, -3e-6);
    bus_run(&bus, 1000 - (int)frames);
    check_int("told once", bus_count(&bus, WIRE_WATCH), 1);
    check_int("counted", bus.app.count[DIAG_WATCH_TRIPS], trips);
    check_near("HEALTH: tick", bus_item(&bus, WIRE_HEALTH, DIAG_WATCH_TICK), (double)trip, 0);
    check_near("HEALTH: trips", bus_item(&bus, WIRE_HEALTH, DIAG_WATCH_TRIPS), trips, 0);
    check_hex("the plant is as one that nobody watches", plant_hash(&bus.app.plant), plant_hash(&alone));
    /* another session is told again; a reset clears */
    bus_forget(&bus);
    bus_enable(&bus, false);
    bus_silent(&bus, 2);
    bus.session = 2;
    memset(bus.counter, 0, sizeof bus.counter);
    bus_run(&bus, 2);
    check_int("told again to a new session", bus_count(&bus, WIRE_WATCH), 1);
    bus_order(&bus, CONTROL_RESET);
    bus_run(&bus, 2);
    check_near("STATUS: cleared by a reset", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 0, 0);
    check_int("the count goes on", bus.app.count[DIAG_WATCH_TRIPS], trips);
    bus_forget(&bus);
    bus_order(&bus, CONTROL_START);
    plant_set_state(&bus.app.plant, (double[]){2.5, 0.0});
    bus_run(&bus, 40);
    check_int("and the next trip is a first one", bus_count(&bus, WIRE_WATCH), 1);
}

/* A driven session with lock-in and a burst; returns the messages. */
static int watched_session(const struct watch_limits *l, struct message *said)
{
    struct app_config c = swinging(NULL);
    c.watch = l;
    bus_start_running(&bus, &c);
    bus_set(&bus, SETTING_FIRST + SET_LOCKIN_FRAMES, 10);
    bus_drive(&bus, RIG_FORCE, 5.0, 200.0, 0.0, 0.01);
    bus_fire(&bus, 1, false, 2 * BUS_TICKS, 0);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM});
    bus_run(&bus, 300);
    memcpy(said, bus.seen, (size_t)bus.n_seen * sizeof *said);
    return bus.n_seen;
}

/* A watch that does not trip changes no message; those on the machine's time are left out. */
TEST(watch_silent)
{
    static struct message with[BUS_SEEN], without[BUS_SEEN];
    const struct watch_limits l = {PENETRATION, 0.0, 1.0};
    int n = watched_session(&l, with), off = 0, lockin = bus_count(&bus, WIRE_LOCKIN);
    check_int("messages without a watch", watched_session(NULL, without), n);
    for (int i = 0; i < n; i++) {
        const struct message *a = &with[i], *b = &without[i];
        bool timing = a->kind == WIRE_HEALTH && a->value[HEALTH_ITEM] >= DIAG_COMPUTE_MAX_US &&
                      a->value[HEALTH_ITEM] <= DIAG_LATENESS_MAX_FRAME;
        off += a->kind != b->kind || (!timing && memcmp(a->value, b->value, sizeof a->value) != 0);
    }
    check_int("messages that differ", off, 0);
    check_above("lock-in windows among them", lockin, 20);
}

/* ---- the climb ---- */

static const struct climber {
    const struct model *reduced, *full;
    double mode; /* the shaft's mode, 0: no such parameter */
} climber[] = {
    {&hertz_rig_linear, &hertz_rig, 0},
    {&hertz_rig_cubic, &hertz_rig, 0},
    {&rolling_contact_linear, &rolling_contact, 0},
    {&afm_tip_linear, &afm_tip, 0},
    {&afm_tip_cubic, &afm_tip, 0},
    {&shaft_bearing_linear, &shaft_bearing, 0},
    {&shaft_bearing_mode, &shaft_bearing, 1},
    {&shaft_bearing_mode, &shaft_bearing, 2},
    {&shaft_bearing_mode, &shaft_bearing, 3},
};

/* The plant of a reduced model, all inputs sounding and one of them in a ramp, some way on. Steps are a
 * fortieth of the full model's fastest radian. */
static void start_climber(const struct climber *k, const struct method *method, struct plant *pl)
{
    double si[MODEL_PARAMETERS] = {0}, p[MODEL_DERIVED];
    struct scale scale;
    for (int i = 0; i < k->reduced->n_parameters; i++)
        si[i] = k->reduced->parameter[i].initial;
    if (k->mode > 0.0)
        si[k->reduced->n_parameters - 1] = k->mode;
    k->full->prepare(si, p, &scale);
    struct plant_config c = {
        .model = k->reduced, .si = si, .method = method, .dilation = 3.0, .scratch = scratch};
    c.tick_s = 0.025 * scale.time_s * c.dilation / k->full->eigenfrequency(p);
    c.tol = 1e-6;
    const char *why = plant_init(pl, &c);
    check_string(k->reduced->name, why ? why : "runs", "runs");
    for (int i = 0; i < k->reduced->n_inputs; i++) {
        double unit = scale_of(&pl->scale, k->reduced->input_signal[i].quantity);
        plant_drive(pl, i, 0.1 * unit, 0.01 * (i + 1) / pl->tick_s, 0.3 * i, i ? 0.0 : 900.0 * pl->tick_s);
    }
    check_true("runs", plant_run(pl, 777));
}

/* A full model's plant, put into the state of `pl` with its drives. */
static void start_like(const struct plant *pl, const struct model *full, struct plant *fresh)
{
    struct plant_config c = {.model = full,
                             .si = pl->si,
                             .method = pl->method,
                             .tick_s = pl->tick_s,
                             .dilation = pl->dilation,
                             .tol = pl->tol,
                             .scratch = other_scratch};
    check_no_error("a full model alone", plant_init(fresh, &c));
    fresh->now = pl->now;
    memcpy(fresh->drive, pl->drive, sizeof fresh->drive);
    memcpy(fresh->segment.at, pl->segment.at, sizeof fresh->segment.at);
    plant_set_state(fresh, pl->x);
}

static int differing(const double *a, const double *b, int n)
{
    int count = 0;
    for (int i = 0; i < n; i++)
        count += memcmp(&a[i], &b[i], sizeof *a) != 0;
    return count;
}

static void check_climb(const struct climber *k, const struct method *method)
{
    static struct plant pl, fresh;
    double before[MODEL_OUTPUTS], after[MODEL_OUTPUTS], worst = 0.0, gross;
    start_climber(k, method, &pl);
    plant_output(&pl, before);
    double residual = plant_residual(&pl), stored = plant_energy(&pl);
    double rate = pl.segment.at[2][0].rate, change = sum_of(&pl.ledger.change) * pl.scale.energy_J;
    uint64_t carrier = pl.drive[0].carrier;
    const char *why = plant_promote(&pl, k->full);
    check_string("climbs", why ? why : "climbs", "climbs");
    check_string("it is the full model", pl.model->name, k->full->name);
    plant_output(&pl, after);
    check_int("displacement and velocity with another bit", differing(before, after, 2), 0);
    if (k->reduced->n_states == 6 || k->mode > 0.0)
        check_int("the bearings' outputs with another bit", differing(&before[4], &after[4], 4), 0);
    check_is("input and phase go on", rate, ==, pl.segment.at[2][0].rate);
    check_is("input and phase go on", carrier, ==, pl.drive[0].carrier);
    check_near("energy booked over the unit",
               (sum_of(&pl.ledger.change) * pl.scale.energy_J - change - (plant_energy(&pl) - stored)) /
                   pl.scale.energy_J,
               0.0, 1e-15);
    check_near("residual over the unit", (plant_residual(&pl) - residual) / pl.scale.energy_J, 0.0, 1e-14);
    start_like(&pl, k->full, &fresh);
    check_int("regime from the gaps", pl.regime, fresh.regime);
    int off = 0;
    residual = plant_residual(&pl);
    for (int i = 0; i < 4000; i++) {
        if (!plant_run(&pl, 1) || !plant_run(&fresh, 1))
            check_true("finite", 0);
        off += differing(pl.x, fresh.x, k->full->n_states);
        worst = fmax(worst, fabs(plant_residual(&pl) - residual));
    }
    gross = pl.ledger.gross * pl.scale.energy_J;
    check_int("states with another bit than the full model's from there", off, 0);
    check_below("residual from there over the energy that flowed", worst / gross, 1e-6);
}

TEST(watch_climb)
{
    for (size_t i = 0; i < sizeof climber / sizeof climber[0]; i++) {
        check_climb(&climber[i], &auto_method);
        check_climb(&climber[i], &rk4);
    }
}

/* Against the SI formulas of both energies, y = 1.3, y' = 0.2. */
TEST(watch_climb_energy)
{
    struct plant pl;
    let_go(&pl);
    pl.method = &rk4;
    pl.step = rk4.bind(pl.model);
    pl.bind_run = NULL;
    plant_set_state(&pl, (double[]){1.3, 0.2});
    check_no_error("climbs", plant_promote(&pl, &hertz_rig));
    double linear = 0.5 * 1.3 * 1.3 - 1.3, full = (2.0 / 3.0) * (0.4 * pow(1.3, 2.5) - 1.3);
    check_near("booked", sum_of(&pl.ledger.change), full - linear, 1e-15);
    check_near("residual", plant_residual(&pl) / pl.scale.energy_J, 0.0, 1e-15);
}

static void refused(const struct climber *k, const struct method *method, const char *part)
{
    static struct plant pl, before;
    start_climber(k, method, &pl);
    before = pl;
    const char *why = plant_promote(&pl, k->full);
    check_contains(part, why, part);
    check_bytes("  nothing has changed", &pl, &before, sizeof pl);
}

TEST(watch_climb_refused)
{
    refused(&(struct climber){&hertz_rig_averaged, &hertz_rig, 0}, &taylor, "averaged model cannot climb");
    refused(&(struct climber){&afm_tip_averaged, &afm_tip, 0}, &taylor, "averaged model cannot climb");
    refused(&(struct climber){&hertz_rig, &hertz_rig, 0}, &rk4, "full model already");
    refused(&(struct climber){&hertz_rig_linear, &hertz_rig_cubic, 0}, &taylor, "not the full model");
    refused(&(struct climber){&hertz_rig_linear, &rolling_contact, 0}, &taylor, "not the full model");
    refused(&(struct climber){&hertz_rig_linear, &hertz_rig, 0}, &exact, "exact is for piecewise linear");
}

/* ---- the climb on the bus ---- */

static const char *app_refusal(const struct app_config *c)
{
    static struct app app;
    const char *why = app_init(&app, c, &bus.wires.port[0].hal);
    return why ? why : "";
}

TEST(watch_climb_bus)
{
    const struct app_config c = swinging(&hertz_rig);
    static double own[METHOD_SCRATCH];
    start_swinging(&c, 1.5);
    struct plant alone = bus.app.plant;
    memcpy(own, scratch, sizeof own);
    alone.scratch = own;
    int off = 0;
    for (int frame = 0; frame < 300; frame++) {
        bus_run(&bus, 1);
        for (int i = 0; i < BUS_TICKS; i++) {
            if (!plant_run(&alone, 1))
                check_true("alone: finite", 0);
            if (alone.model == &hertz_rig_linear && plant_read(&alone, "penetration") < 0.0)
                check_no_error("alone: climbs", plant_promote(&alone, &hertz_rig));
        }
        off += plant_hash(&alone) != plant_hash(&bus.app.plant);
    }
    check_int("frames in which the plant is not the one that climbed alone", off, 0);
    check_string("it is the full model", bus.app.plant.model->name, hertz_rig.name);
    check_int("one WATCH", bus_count(&bus, WIRE_WATCH), 1);
    check_int("one trip", bus.app.count[DIAG_WATCH_TRIPS], 1);
    check_near("STATUS: tripped", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 1, 0);
    check_above("the full model leaves the contact", bus_count(&bus, WIRE_EVENT_TIME), 2);
    check_near("no fault", bus_value(&bus, WIRE_STATUS, STATUS_FAULTS), 0, 0);
    bus_run(&bus, 20 * (4 * ARM_FIELDS + INFO_ITEMS));
    check_near("INFO: promoted", bus_item(&bus, WIRE_INFO, INFO_PROMOTED), 1, 0);
    bus_order_now(&bus, CONTROL_PAUSE);
    bus_order_now(&bus, CONTROL_RESET);
    check_near("a reset clears the flag", bus_value(&bus, WIRE_STATUS, STATUS_WATCH), 0, 0);
    check_string("and stays on the full model", bus.app.plant.model->name, hertz_rig.name);
}

/* The kept mode's own parameter ends with the climb, and a
 * change that the full model could not take is refused before. */
TEST(watch_climb_parameters)
{
    static const struct watch_limits l = {0, -1e-3, 1e-3};
    struct app_config c = bus_config();
    c.model = &shaft_bearing_mode;
    c.method = &rk4;
    c.substeps = 64;
    c.promote = &shaft_bearing;
    check_contains("a model to climb to, but no watch", app_refusal(&c), "needs a watch");
    c.watch = &l;
    unsigned mode = SHAFT_PARAMETERS;
    c.substeps = 32;
    check_contains("a step too coarse for the full model", app_refusal(&c), "step too coarse");
    c.promote = NULL;
    check_string("which the mode alone takes", app_refusal(&c), "");
    c.promote = &shaft_bearing;
    c.substeps = 64;
    bus_start_running(&bus, &c);
    bus_set_now(&bus, SHAFT_M1, 0.01);
    check_int("a mass too light for the full model's step", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
    bus_set_now(&bus, mode, 1.0);
    check_int("the mode", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    struct staged set = {{0}, {0}};
    staged_put(&set, mode, 1.0);
    bus_write(&bus, mode, 1.0); /* staged before the climb, committed after it */
    bus_run(&bus, 1);
    plant_set_state(&bus.app.plant, (double[]){-5.0, 0.0});
    bus_run(&bus, 1);
    check_string("climbed", bus.app.plant.model->name, shaft_bearing.name);
    bus_commit(&bus, &set, COMMIT_NOW);
    bus_run(&bus, 1);
    check_int("a parameter that is gone, staged before", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
    bus_write(&bus, mode, 1.0);
    bus_run(&bus, 1);
    check_int("and written now", bus_cause(&bus, WIRE_PARAM_WRITE), CAUSE_UNKNOWN);
    bus_set_now(&bus, SHAFT_M1, 0.5);
    check_int("the others are as before", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
}

/* A scene compiled in, in slow motion: its lengths are real, velocities are the bus's. */
TEST(watch_scene)
{
    struct scene s;
    struct watch_limits l;
    scenes_default(&s, &afm_tip_linear);
    check_true("a scene that watches nothing", !plant_scene_watch(&s, 1000.0, &l));
    s.watch = (struct scene_watch){1.0, 0.0, SCENE_UNBOUNDED, 1e-9, &afm_tip};
    check_true("a length", plant_scene_watch(&s, 1000.0, &l));
    check_is("  as it is, and no upper limit", l.observable, ==, 0);
    check_is("  as it is, and no upper limit", l.low, ==, 1e-9);
    check_is("  as it is, and no upper limit", l.high, >=, 1e300);
    s.watch = (struct scene_watch){1.0, 1.0, 2e-6, -1e-6, NULL};
    check_true("a velocity", plant_scene_watch(&s, 1000.0, &l));
    check_near("  lower, a thousandth", l.low, -1e-9, 1e-24);
    check_near("  upper", l.high, 2e-9, 1e-24);
    s.watch = (struct scene_watch){1.0, MODEL_EIGENFREQUENCY, 20e3, 10e3, NULL};
    check_true("a frequency", plant_scene_watch(&s, 1000.0, &l));
    check_near("  lower, a thousandth", l.low, 10.0, 1e-13);
    check_near("  upper", l.high, 20.0, 1e-13);
    s.watch = (struct scene_watch){1.0, MODEL_TIME, 2e-3, -SCENE_UNBOUNDED, NULL};
    check_true("a time", plant_scene_watch(&s, 1000.0, &l));
    check_near("  a thousand times as long", l.high, 2.0, 1e-15);
}

/* Without a unit a frequency is angular: of fig. 16's tip
 * sqrt(1 + beta) or sqrt(1 - beta), as its contact pulls. */
TEST(watch_scene_angular)
{
    struct scene s = scenes_find("kb-fig16")->scene;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic drive[MODEL_INPUTS];
    struct watch_limits l;
    struct scale scale;
    scenes_resolve(&s, si, drive);
    s.model->prepare(si, p, &scale);
    s.watch = (struct scene_watch){1.0, MODEL_EIGENFREQUENCY, 2.0 * PI, 0.0, NULL};
    check_near("its start", scenes_watched(&s, si, drive), s.model->eigenfrequency(p), 1e-15);
    check_true("a frequency without unit", plant_scene_watch(&s, 0.001, &l));
    check_near("  once per unit of time, a thousand in a second", l.high, 1000.0, 1e-10);
}
