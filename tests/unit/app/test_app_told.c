/* test_app_told.c - edge cases of the plant's reports.
 *
 * They are a STATUS for the reaction alone, the ledger's items and the last instant of a tick. Others are
 * the energy that swings, the rest of a ramp, and the age of a heartbeat. */
#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "models/afm_tip.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { TIMEOUT = 20 };
static struct bus bus;

static void told_start(enum reaction reaction)
{
    bus_start_rig(&bus);
    bus_set(&bus, SETTING_FIRST + SET_REACTION, reaction);
    bus_set(&bus, SETTING_FIRST + SET_TIMEOUT_FRAMES, TIMEOUT);
    bus_set(&bus, SETTING_FIRST + SET_AGE_LIMIT_FRAMES, 10000.0);
    bus_set(&bus, SETTING_FIRST + SET_STATUS_EVERY, 9000.0);
    bus_run(&bus, 4);
}

/* At a second time-out fault and state are what they
 * were: only REACTION changes, and that is told at once. */
TEST(app_told_reaction)
{
    told_start(REACTION_HOLD);
    bus_silent(&bus, TIMEOUT + 5);
    bus.session = 2;
    for (int i = 0; i < 3; i++)
        bus_run(&bus, 1);
    check_near("in session again, no reaction", bus_value(&bus, WIRE_STATUS, STATUS_REACTION), REACTION_NONE,
               0);
    check_true("the fault of the first time-out stays", bus.app.faults & FAULT_TIMEOUT);
    bus_forget(&bus);
    bus_silent(&bus, TIMEOUT + 5);
    check_int("STATUS at the second time-out", bus_count(&bus, WIRE_STATUS), 1);
    check_near("its reaction", bus_value(&bus, WIRE_STATUS, STATUS_REACTION), REACTION_HOLD, 0);
}

/* Each item that a tip has is told in turn, and none that only other models have. */
TEST(app_told_ledger)
{
    enum { ROUNDS = 3 };
    struct app_config c = bus_config();
    int n = LEDGER_WORK + afm_tip.n_inputs, told[LEDGER_WORK + MODEL_INPUTS] = {0}, foreign = 0;
    c.model = &afm_tip;
    c.substeps = 64;
    c.dilation = 1e5;
    bus_start_running(&bus, &c);
    bus_set(&bus, SETTING_FIRST + SET_LEDGER_EVERY, 1.0);
    bus_run(&bus, 2);
    bus_forget(&bus);
    bus_run(&bus, ROUNDS * n);
    for (int i = 0; i < bus.n_seen; i++) {
        int item = (int)bus.seen[i].value[0];
        if (bus.seen[i].kind != WIRE_LEDGER)
            continue;
        foreign += item >= n;
        told[item < n ? item : 0] += item < n;
    }
    check_is("a tip has fewer inputs than others", afm_tip.n_inputs, <, MODEL_INPUTS);
    check_int("items of inputs that it lacks", foreign, 0);
    for (int i = 0; i < n; i++)
        check_int("times that an item was told", told[i], ROUNDS);
}

/* A switch in the last 1/131072 of a tick is told as the begin of the next one. */
TEST(app_told_carry)
{
    static const double fraction[] = {1.0, 1.0 - 0x1p-18, 1.0 - 0x1p-15};
    told_start(REACTION_HOLD);
    for (int i = 0; i < 3; i++) {
        struct plant *pl = &bus.app.plant;
        bus_order(&bus, CONTROL_PAUSE);
        bus_run(&bus, 2);
        bus_forget(&bus);
        pl->event_head = 0;
        pl->n_event = 1;
        pl->event[0] = (struct event){.tick = 1000, .fraction = fraction[i], .speed = 1.0, .touch = true};
        bus_run(&bus, 1);
        check_near("EVENT_TIME: tick and fraction",
                   bus_value(&bus, WIRE_EVENT_TIME, EVENT_TIME_TICK) +
                       bus_value(&bus, WIRE_EVENT_TIME, EVENT_TIME_FRACTION),
                   1000.0 + fraction[i], 0x1p-17);
        check_near("EVENT_TIME: tick", bus_value(&bus, WIRE_EVENT_TIME, EVENT_TIME_TICK), i < 2 ? 1001 : 1000,
                   0);
    }
}

/* Where a plant swings, in model units: its rest is at 1 beyond the base. */
struct swing {
    double preload_N, base, speed;
    double energy; /* above the rest of a plant without inputs */
};

/* Runs a paused plant to one frame before the next look
 * at its balance, which comes in each 100th plant frame. */
static void approach_look(void)
{
    enum { LOOK = 100 };
    uint64_t frame = bus.app.plant.now.tick / BUS_TICKS;
    uint64_t left = LOOK - 1 - frame % LOOK;
    if (left == 0)
        return;
    bus_control(&bus, CONTROL_STEP, (double)left);
    bus_run(&bus, (int)left + 1);
}

static void step_once(void)
{
    bus_control(&bus, CONTROL_STEP, 1.0);
    bus_run(&bus, 2);
}

/* Does the ledger sound when the mass has gained this share of its energy from nowhere? The plant rests until
 * the frame of a look, so that nothing else flows. */
static bool alarmed(const struct swing *w, double share)
{
    struct plant *pl = &bus.app.plant;
    told_start(REACTION_HOLD);
    bus_set(&bus, SETTING_FIRST + SET_LEDGER_ALARM, 0.1);
    bus_set_now(&bus, RIG_PRELOAD, w->preload_N);
    bus_stream(&bus, RIG_BASE, pl->now.tick / BUS_TICKS + 2, w->base * pl->scale.length_m);
    bus_run(&bus, 5);
    bus_order(&bus, CONTROL_PAUSE);
    for (int i = 0; i < 2; i++) { /* the first look is at what the base has moved */
        plant_set_state(pl, (double[MODEL_STATES]){1.0 + w->base, 0.0});
        approach_look();
        plant_set_state(pl, (double[MODEL_STATES]){1.0 + w->base, i * w->speed});
        if (i == 1)
            pl->x[1] = sqrt(w->speed * w->speed + 2.0 * share * w->energy);
        step_once();
    }
    return (bus.app.faults & FAULT_LEDGER) != 0;
}

/* The energy that swings is the kinetic energy where the preload has moved the rest. Where the base has
 * moved it, it is the preload's work (2/3 in model units). An alarm of 10 % sounds between 9 and 11 % of
 * it. The residual counts against the energy that is there now. */
TEST(app_told_swing)
{
    static const struct swing w[] = {
        {20.0, 0.0, 0.5, 0.125}, {150.0, 0.0, 0.5, 0.125}, {20.0, -0.5, 0.0, 1.0 / 3.0}};
    for (int i = 0; i < 3; i++) {
        check_true("9 % of what swings: no alarm", !alarmed(&w[i], 0.09 / (1.0 - 0.09)));
        check_true("11 % of what swings: an alarm", alarmed(&w[i], 0.11 / (1.0 - 0.11)));
    }
}

/* The energy that has flowed is joule: a change of
 * parameters, and with them of its unit, leaves it as it is. */
TEST(app_told_gross)
{
    struct plant *pl = &bus.app.plant;
    double si[MODEL_PARAMETERS];
    told_start(REACTION_HOLD);
    bus_set(&bus, SETTING_FIRST + SET_SUMMARY_EVERY, 0.0);
    bus_drive(&bus, RIG_FORCE, 4.0, 150.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 10 * BUS_TICKS, 0);
    bus_run(&bus, 50);
    double unit_J = pl->scale.energy_J, flowed_J = pl->ledger.gross * unit_J;
    memcpy(si, pl->si, sizeof si);
    si[RIG_PRELOAD] *= 3.0;
    check_no_error("three times the preload is taken", plant_change(pl, si));
    check_near("the unit of energy, 3^(5/3) times", pl->scale.energy_J / unit_J, pow(3.0, 5.0 / 3.0), 1e-12);
    check_near("the energy that flowed, in parts of itself", pl->ledger.gross * pl->scale.energy_J / flowed_J,
               1.0, 1e-12);
}

/* The balance is judged after each hundredth plant frame, and not again after the next one: what has
 * flowed since then stays. */
TEST(app_told_judged)
{
    const struct ledger *l = &bus.app.plant.ledger;
    told_start(REACTION_HOLD);
    bus_drive(&bus, RIG_FORCE, 4.0, 150.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 10 * BUS_TICKS, 0);
    bus_run(&bus, 99 - (int)(bus.app.plant.now.tick / BUS_TICKS));
    check_int("plant frames", (int64_t)bus.app.plant.now.tick, 99 * BUS_TICKS);
    check_is("flowed in 89 frames", l->gross, >, 0.0);
    bus_run(&bus, 1);
    check_near("after the hundredth", l->gross, 0.0, 0.0);
    bus_run(&bus, 1);
    check_is("after the next one", l->gross, >, 0.0);
}

/* An amplitude fired inside a ramp takes what is left of it, whole ticks upwards: of 10 ticks from 8 + 1/2
 * on, 6 + 1/4 are left at 12 + 1/4; they become 7, until 19 + 1/4. */
TEST(app_told_ramp_left)
{
    const double tick_s = 1e-3 / BUS_TICKS;
    const uint64_t at = 20 * BUS_TICKS;
    told_start(REACTION_HOLD);
    bus_drive(&bus, RIG_FORCE, 4.0, 150.0, 0.0, 10.0 * tick_s);
    bus_fire(&bus, 1, false, at + 8, 128);
    bus_run(&bus, 1);
    bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 2.0);
    bus_fire(&bus, 1, false, at + 12, 64);
    while (bus.app.plant.now.tick < at + BUS_TICKS && bus.app.state == STATE_RUNNING)
        bus_run(&bus, 1);
    check_int("left of them at 16, in parts of a tick", (int64_t)bus.app.plant.drive[RIG_FORCE].ramp_left,
              3 * TICK_FRACTIONS + TICK_FRACTIONS / 4);
}

/* The last good heartbeat counts from the frame in which it
 * came: what it echoes may be old, and its sender is alive. */
TEST(app_told_heartbeat)
{
    told_start(REACTION_HOLD);
    bus_run(&bus, 20);
    bus_silent(&bus, 5); /* else the one before would do */
    const double old[WIRE_FIELDS] = {[ENABLE_REQUEST] = 1.0, [ENABLE_FRAME] = (double)(bus.app.frame - 15)};
    bus_command(&bus, WIRE_ENABLE, old);
    bus_silent(&bus, TIMEOUT);
    check_true("still in session after as many silent frames as the time-out has, less one", bus.app.enabled);
    bus_silent(&bus, 2);
    check_true("and then no longer", !bus.app.enabled);
}
