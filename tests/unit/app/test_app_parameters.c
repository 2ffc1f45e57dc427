/* test_app_parameters.c - sets of parameters and settings
 * over the wire: whole or not at all, now or with a fire. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

static struct bus bus;

static void parameters_start(void)
{
    bus_start_rig(&bus);
    bus_run(&bus, 1);
    bus_forget(&bus);
}

static struct staged two(unsigned i, double a, unsigned j, double b)
{
    struct staged set = {{0}, {0}};
    staged_put(&set, i, a);
    staged_put(&set, j, b);
    return set;
}

TEST(app_parameters_now)
{
    parameters_start();
    struct staged set = two(RIG_MASS, 4.0, RIG_PRELOAD, 32.0);
    bus_write(&bus, RIG_MASS, 4.0);
    bus_write(&bus, RIG_PRELOAD, 32.0);
    bus_run(&bus, 3);
    check_near("written, not committed: mass in force, kg", bus.app.plant.si[RIG_MASS], 6.5, 0.0);
    bus_commit(&bus, &set, COMMIT_NOW);
    bus_run(&bus, 1);
    check_int("commit", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    check_near("mass in force, kg", bus.app.plant.si[RIG_MASS], 4.0, 0.0);
    check_near("preload in force, N", bus.app.plant.si[RIG_PRELOAD], 32.0, 0.0);
    check_near("PARAM_ECHO of the mass", bus_item(&bus, WIRE_PARAM_ECHO, RIG_MASS), 4.0, 0.0);
    check_near("PARAM_ECHO of the preload", bus_item(&bus, WIRE_PARAM_ECHO, RIG_PRELOAD), 32.0, 0.0);
    check_int("and of nothing else", bus_count(&bus, WIRE_PARAM_ECHO), 2);
    bus_commit(&bus, &set, COMMIT_NOW);
    bus_run(&bus, 1);
    check_int("the same set twice: nothing is staged any more", bus_cause(&bus, WIRE_PARAM_COMMIT),
              CAUSE_INCOMPLETE);
    /* f0 of the new rig from the paper's formula: 1/(2 pi) sqrt(3 N / (2 m zs)). */
    double zs = pow(32.0 / 3.4e9, 2.0 / 3.0);
    bus_run(&bus, 800);
    check_near("INFO f0, Hz, relative",
               bus_item(&bus, WIRE_INFO, INFO_F0_BUS_HZ) /
                   (sqrt(1.5 * 32.0 / (4.0 * zs)) / 6.283185307179586),
               1.0, 1e-7);
}

TEST(app_parameters_refused)
{
    static const char *const what[] = {"count one too many", "CRC wrong",       "one of two lost",
                                       "one value other",    "nothing written", "no such time"};
    for (int how = 0; how < 6; how++) {
        parameters_start();
        struct staged set = two(RIG_MASS, 4.0, SETTING_FIRST + SET_TIMEOUT_FRAMES, 77.0);
        double count = 2, when = how == 5 ? 2 : COMMIT_NOW, crc = staged_crc(&set) ^ (how == 1 ? 1u : 0u);
        if (how == 0)
            count = 3;
        if (how != 2 && how != 4)
            bus_write(&bus, RIG_MASS, how == 3 ? 4.5 : 4.0);
        if (how != 4)
            bus_write(&bus, SETTING_FIRST + SET_TIMEOUT_FRAMES, 77.0);
        bus_command(&bus, WIRE_PARAM_COMMIT, (double[WIRE_FIELDS]){0, count, when, crc});
        bus_run(&bus, 2);
        printf("      %s\n", what[how]);
        check_int("cause", bus_cause(&bus, WIRE_PARAM_COMMIT), how == 5 ? CAUSE_UNKNOWN : CAUSE_INCOMPLETE);
        check_near("mass unchanged, kg", bus.app.plant.si[RIG_MASS], 6.5, 0.0);
        check_near("time-out unchanged, frames", bus.app.setting[SET_TIMEOUT_FRAMES], 100, 0.0);
        check_int("no echo", bus_count(&bus, WIRE_PARAM_ECHO), 0);
        check_int("a torn set is forgotten", staged_count(&bus.app.mailbox.staged), 0);
    }
    const struct {
        unsigned index;
        double value;
        int cause;
    } bad[] = {{RIG_MASS, 1e7, CAUSE_RANGE},
               {RIG_MASS, 0.0, CAUSE_RANGE},
               {RIG_MASS, -1.0, CAUSE_RANGE},
               {RIG_MASS, (double)NAN, CAUSE_RANGE},
               {RIG_DAMPING, (double)INFINITY, CAUSE_RANGE},
               {4, 1.0, CAUSE_UNKNOWN},
               {63, 1.0, CAUSE_UNKNOWN},
               {SETTING_FIRST + SETTINGS, 1.0, CAUSE_UNKNOWN},
               {255, 1.0, CAUSE_UNKNOWN},
               {SETTING_FIRST + SET_TIMEOUT_FRAMES, 0.0, CAUSE_RANGE},
               {SETTING_FIRST + SET_TIMEOUT_FRAMES, 1.5, CAUSE_RANGE},
               {SETTING_FIRST + SET_REACTION, 4.0, CAUSE_RANGE},
               {SETTING_FIRST + SET_SYNC_EVERY, 0.0, CAUSE_RANGE}};
    parameters_start();
    for (int i = 0; i < (int)(sizeof bad / sizeof bad[0]); i++) {
        bus_forget(&bus);
        bus_write(&bus, bad[i].index, bad[i].value);
        bus_run(&bus, 1);
        check_int("refused at the write", bus_cause(&bus, WIRE_PARAM_WRITE), bad[i].cause);
        check_near("naming its index", bus_value(&bus, WIRE_REPLY, REPLY_INDEX), bad[i].index, 0);
    }
    check_int("none of them is staged", staged_count(&bus.app.mailbox.staged), 0);
    bus_forget(&bus);
    bus_command(&bus, WIRE_PARAM_COMMIT,
                (double[WIRE_FIELDS]){0, 0, COMMIT_NOW, staged_crc(&bus.app.mailbox.staged)});
    bus_run(&bus, 1);
    check_int("a set of nothing", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_INCOMPLETE);
    bus_command(&bus, WIRE_PARAM_READ, (double[WIRE_FIELDS]){0, 5});
    bus_run(&bus, 1);
    check_int("read of what does not exist", bus_cause(&bus, WIRE_PARAM_READ), CAUSE_UNKNOWN);
}

/* Values that are each in range, but the step is too coarse,
 * the rig overdamped or an output missing: refused whole. */
TEST(app_parameters_guard)
{
    const struct {
        const char *what;
        unsigned index;
        double value;
    } bad[] = {{"step guard: mass 1 mg", RIG_MASS, 1e-6},
               {"overdamped", RIG_DAMPING, 1e6},
               {"compression of more than a metre", RIG_CONTACT_STIFFNESS, 1e-3},
               {"lock-in on an output that the rig has not", SETTING_FIRST + SET_LOCKIN_OUTPUT, 5}};
    for (int i = 0; i < 4; i++) {
        for (int when = COMMIT_NOW; when <= COMMIT_WITH_FIRE; when++) {
            parameters_start();
            struct app before = bus.app;
            struct staged set = two(bad[i].index, bad[i].value, SETTING_FIRST + SET_HASH_EVERY, 3);
            bus_write(&bus, bad[i].index, bad[i].value);
            bus_write(&bus, SETTING_FIRST + SET_HASH_EVERY, 3);
            bus_commit(&bus, &set, (enum commit_when)when);
            bus_run(&bus, 1);
            printf("      %s, %s\n", bad[i].what, when ? "with fire" : "now");
            check_int("cause", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_RANGE);
            check_bytes("parameters unchanged", before.plant.si, bus.app.plant.si, sizeof before.plant.si);
            check_bytes("settings unchanged", before.setting, bus.app.setting, sizeof before.setting);
            check_true("nothing waits for a fire", !bus.app.mailbox.commit_with_fire);
        }
    }
}

/* The set and a drive take effect at one instant: as a plant alone that is changed there by hand. */
TEST(app_parameters_fire)
{
    parameters_start();
    struct staged set = two(RIG_MASS, 5.0, RIG_PRELOAD, 48.0);
    bus_drive(&bus, RIG_FORCE, 20.0, 150.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 2 * BUS_TICKS, 0);
    bus_run(&bus, 10);
    struct plant alone = bus.app.plant;
    const struct instant at = {20 * BUS_TICKS + 7, 51 * 256};
    double si[MODEL_PARAMETERS];
    memcpy(si, alone.si, sizeof si);
    si[RIG_MASS] = 5.0;
    si[RIG_PRELOAD] = 48.0;
    bus_write(&bus, RIG_MASS, 5.0);
    bus_write(&bus, RIG_PRELOAD, 48.0);
    bus_commit(&bus, &set, COMMIT_WITH_FIRE);
    bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 30.0);
    bus_run(&bus, 2);
    check_int("committed for a fire: accepted", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    check_int("no echo yet", bus_count(&bus, WIRE_PARAM_ECHO), 0);
    bus_fire(&bus, 1, true, at.tick, 51);
    bus_run(&bus, 7);
    check_near("one frame before: mass, kg", bus.app.plant.si[RIG_MASS], 6.5, 0.0);
    check_int("tick", (int64_t)bus.app.plant.now.tick, 20 * BUS_TICKS);
    if (!plant_advance(&alone, at))
        check_true("alone: finite", 0);
    double z = alone.x[0] * alone.scale.length_m, v = alone.x[1] * alone.scale.length_m / alone.scale.time_s;
    plant_drive(&alone, RIG_FORCE, 30.0, 150.0, 0.0, 0.0);
    if (plant_change(&alone, si))
        check_true("alone: accepted", 0);
    check_near("position goes on, m", alone.x[0] * alone.scale.length_m, z, 1e-20);
    check_near("velocity goes on, m/s", alone.x[1] * alone.scale.length_m / alone.scale.time_s, v, 1e-16);
    if (!plant_run(&alone, 0) || !plant_advance(&alone, (struct instant){25 * BUS_TICKS, 0}))
        check_true("alone: finite", 0);
    bus_run(&bus, 5);
    check_near("after: mass, kg", bus.app.plant.si[RIG_MASS], 5.0, 0.0);
    check_near("position as alone", bus.app.plant.x[0], alone.x[0], 1e-13);
    check_near("velocity as alone", bus.app.plant.x[1], alone.x[1], 1e-13);
    check_near("echo after the fire", bus_item(&bus, WIRE_PARAM_ECHO, RIG_PRELOAD), 48.0, 0.0);
    bus_fire(&bus, 0, true, bus.app.plant.now.tick + 5, 0);
    bus_run(&bus, 1);
    check_int("the set is used up", bus_cause(&bus, WIRE_FIRE), CAUSE_INCOMPLETE);
}

/* A second set must not slip under a fire that waits with the first one. */
TEST(app_parameters_two_fires)
{
    parameters_start();
    struct staged first = two(RIG_MASS, 5.0, RIG_DAMPING, 100.0),
                  second = two(RIG_MASS, 8.0, RIG_DAMPING, 50.0);
    bus_write(&bus, RIG_MASS, 5.0);
    bus_write(&bus, RIG_DAMPING, 100.0);
    bus_commit(&bus, &first, COMMIT_WITH_FIRE);
    bus_fire(&bus, 0, true, 20 * BUS_TICKS, 0);
    bus_run(&bus, 1);
    bus_write(&bus, RIG_MASS, 8.0);
    bus_write(&bus, RIG_DAMPING, 50.0);
    bus_commit(&bus, &second, COMMIT_WITH_FIRE);
    bus_run(&bus, 1);
    check_int("a second set while a fire waits with the first", bus_cause(&bus, WIRE_PARAM_COMMIT),
              CAUSE_FULL);
    bus_run(&bus, 25);
    check_near("the fire brought its own set: mass, kg", bus.app.plant.si[RIG_MASS], 5.0, 0.0);
    bus_write(&bus, RIG_MASS, 8.0);
    bus_write(&bus, RIG_DAMPING, 50.0);
    bus_commit(&bus, &second, COMMIT_WITH_FIRE);
    bus_fire(&bus, 0, true, 40 * BUS_TICKS, 0);
    bus_run(&bus, 30);
    check_near("then the second has its turn: mass, kg", bus.app.plant.si[RIG_MASS], 8.0, 0.0);
}

/* A set that was sound when it was committed and is no
 * longer when its fire comes: refused whole, drives go on. */
TEST(app_parameters_overtaken)
{
    struct staged set = {{0}, {0}};
    parameters_start();
    staged_put(&set, RIG_MASS, 2.0);
    bus_write(&bus, RIG_MASS, 2.0);
    bus_commit(&bus, &set, COMMIT_WITH_FIRE);
    bus_arm(&bus, RIG_FORCE, ARM_AMPLITUDE, 1.0);
    bus_run(&bus, 1);
    check_int("mass of 2 kg: accepted for a fire", bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
    bus_set(&bus, RIG_CONTACT_STIFFNESS, 1.2e10); /* f0 h: 0.14; with 2 kg it would be 0.25 */
    bus_fire(&bus, 1, true, 10 * BUS_TICKS, 0);
    bus_run(&bus, 15);
    check_near("a stiffness came before, now the step is too coarse: mass, kg", bus.app.plant.si[RIG_MASS],
               6.5, 0.0);
    check_int("counted as out of range", bus.app.count[DIAG_RANGE], 1);
    check_int("REPLY to the FIRE", bus_cause(&bus, WIRE_FIRE), CAUSE_RANGE);
    check_near("all or nothing: the drive, N", drive_target(&bus.app.plant.drive[0]).amplitude * 64.0, 0.0,
               0);
}

/* Energy that a change brings in: (m' - m) v^2/2, -(N'
 * - N) z, (2/5)(k' - k) z^{5/2}; in the message LEDGER. */
TEST(app_parameters_ledger)
{
    double booked = 0.0;
    struct app_config c = bus_config();
    c.substeps = 128; /* the method's own error stays below what is asked */
    bus_start_running(&bus, &c);
    bus_run(&bus, 1);
    bus_set(&bus, SETTING_FIRST + SET_LEDGER_EVERY, 1);
    bus_drive(&bus, RIG_FORCE, 30.0, 150.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 2 * 128, 0);
    bus_run(&bus, 40);
    const struct {
        unsigned index;
        double value;
    } change[] = {{RIG_MASS, 5.0}, {RIG_PRELOAD, 40.0}, {RIG_CONTACT_STIFFNESS, 5e9}, {RIG_DAMPING, 150.0}};
    for (int i = 0; i < 4; i++) {
        bus_run(&bus, 3);
        const struct plant *pl = &bus.app.plant;
        double z = plant_read(pl, "displacement"), v = plant_read(pl, "velocity"),
               old = pl->si[change[i].index];
        double d = (double)(float)change[i].value - old;
        const double energy[] = {0.5 * d * v * v, -d * z, 0.4 * d * pow(z, 2.5), 0.0};
        booked += energy[i];
        bus_set(&bus, change[i].index, change[i].value);
        bus_run(&bus, 12);
        check_near("booked as change, over its closed form",
                   bus_item(&bus, WIRE_LEDGER, LEDGER_CHANGE) / booked, 1.0, 2e-7);
    }
    double stored = bus_item(&bus, WIRE_LEDGER, LEDGER_STORED);
    check_below("residual over the energy stored",
                fabs(bus_item(&bus, WIRE_LEDGER, LEDGER_RESIDUAL) / stored), 1e-6);
}

/* Every rate of a message is a setting that takes effect; and the window of the lock-in. */
TEST(app_parameters_settings)
{
    const struct {
        int setting;
        unsigned kind;
    } rate[] = {{SET_MOTION_EVERY, WIRE_MOTION}, {SET_CONTACT_EVERY, WIRE_CONTACT},
                {SET_STATUS_EVERY, WIRE_STATUS}, {SET_LEDGER_EVERY, WIRE_LEDGER},
                {SET_HEALTH_EVERY, WIRE_HEALTH}, {SET_SUMMARY_EVERY, WIRE_EVENT_SUMMARY},
                {SET_HASH_EVERY, WIRE_HASH},     {SET_STREAM_ECHO_EVERY, WIRE_STREAM_ECHO}};
    const int every[] = {1, 7, 20};
    for (int i = 0; i < 8; i++) {
        for (int k = 0; k < 3; k++) {
            parameters_start();
            bus_set_now(&bus, SETTING_FIRST + (unsigned)rate[i].setting, every[k]);
            bus_forget(&bus);
            bus_run(&bus, 140);
            printf("      %s every %d frames\n", setting_table[rate[i].setting].name, every[k]);
            check_int("messages in 140 frames", bus_count(&bus, rate[i].kind), 140 / every[k]);
        }
        if (rate[i].setting == SET_STATUS_EVERY)
            continue;
        bus_set_now(&bus, SETTING_FIRST + (unsigned)rate[i].setting, 0);
        bus_forget(&bus);
        bus_run(&bus, 140);
        check_int("0: none", bus_count(&bus, rate[i].kind), 0);
    }
    bus_set_now(&bus, SETTING_FIRST + SET_ECHO_EVERY, 1);
    bus_forget(&bus);
    bus_run(&bus, 2 * (4 * ARM_FIELDS + INFO_ITEMS));
    check_int("echo_every 1: DRIVE_ECHO, two turns", bus_count(&bus, WIRE_DRIVE_ECHO), 2 * 4 * ARM_FIELDS);
    int info = 0; /* IDENTITY also comes every 100 frames */
    for (int i = 0; i < bus.n_seen; i++)
        info += bus.seen[i].kind == WIRE_INFO && bus.seen[i].value[INFO_ITEM] != INFO_IDENTITY;
    check_int("and INFO but IDENTITY", info, 2 * (INFO_ITEMS - 1));
}

TEST(app_parameters_echo)
{
    parameters_start();
    for (unsigned i = 0; i < SETTING_FIRST + SETTINGS; i++) {
        if (i < 4 || i >= SETTING_FIRST)
            bus_command(&bus, WIRE_PARAM_READ, (double[WIRE_FIELDS]){0, i});
    }
    bus_run(&bus, 1);
    check_int("all asked for at once: four a frame", bus_count(&bus, WIRE_PARAM_ECHO), 4);
    bus_run(&bus, (4 + SETTINGS) / 4);
    check_int("until all are told", bus_count(&bus, WIRE_PARAM_ECHO), 4 + SETTINGS);
    int wrong = 0;
    for (unsigned i = 0; i < SETTINGS; i++)
        wrong +=
            bus_item(&bus, WIRE_PARAM_ECHO, SETTING_FIRST + i) != (double)(float)setting_table[i].initial;
    for (unsigned i = 0; i < 4; i++)
        wrong += bus_item(&bus, WIRE_PARAM_ECHO, i) != (double)(float)hertz_rig.parameter[i].initial;
    check_int("values other than the table's defaults", wrong, 0);
}
