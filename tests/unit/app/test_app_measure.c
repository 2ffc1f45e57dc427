/* test_app_measure.c - burst capture and lock-in over
 * the wire, against a plant run alone and closed forms. */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { OUTPUTS = 5, LONG = 4000 };
#define TWO_PI 6.283185307179586477
#define J      ((double complex)I) /* I is a complex float */

static struct bus bus;

static void set_all(const double (*pair)[2], int n)
{
    for (int i = 0; i < n; i++)
        bus_set_now(&bus, SETTING_FIRST + (unsigned)pair[i][0], pair[i][1]);
}

/* Reads the whole burst over the bus; returns the number of values that differ from `expected`. */
static int read_burst(int samples, float (*expected)[OUTPUTS])
{
    bus_forget(&bus);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_READ, 0, samples});
    bus_run(&bus, samples * OUTPUTS / 8 + 3);
    int i = 0, wrong = 0;
    for (int k = 0; k < bus.n_seen; k++) {
        const struct message *m = &bus.seen[k];
        if (m->kind != WIRE_CAPTURE_DATA)
            continue;
        wrong += m->value[CAPTURE_DATA_SAMPLE] != i / OUTPUTS || m->value[CAPTURE_DATA_SIGNAL] != i % OUTPUTS;
        wrong += i < samples * OUTPUTS &&
                 m->value[CAPTURE_DATA_VALUE] != (double)expected[i / OUTPUTS][i % OUTPUTS];
        i++;
    }
    check_int("values told", i, samples * OUTPUTS);
    return wrong;
}

/* A plant alone, from here on tick by tick: outputs, and the tick in which its first lift-off falls. */
static uint64_t record_alone(struct plant *alone, int ticks, float (*output)[OUTPUTS])
{
    uint64_t first = UINT64_MAX;
    for (int i = 0; i < ticks; i++) {
        double now[MODEL_OUTPUTS];
        struct event e;
        if (!plant_run(alone, 1))
            check_true("alone: finite", 0);
        plant_output(alone, now);
        for (int k = 0; k < OUTPUTS; k++)
            output[i][k] = (float)now[k];
        while (plant_take_event(alone, &e)) {
            if (!e.touch && first == UINT64_MAX)
                first = e.tick;
        }
    }
    return first;
}

TEST(app_capture_liftoff)
{
    static float alone[LONG][OUTPUTS];
    bus_start_rig(&bus);
    set_all((const double[][2]){{SET_CAPTURE_SAMPLES, 200},
                                {SET_CAPTURE_PRETRIGGER, 60},
                                {SET_CAPTURE_TRIGGER, TRIGGER_LIFTOFF}},
            3);
    bus_drive(&bus, RIG_FORCE, 16.0, 215.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, 6 * BUS_TICKS, 0);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0});
    bus_run(&bus, 5);
    struct plant plant = bus.app.plant; /* the drive sounds already */
    int64_t start = (int64_t)plant.now.tick;
    int64_t liftoff = (int64_t)record_alone(&plant, LONG, alone);
    bus_run(&bus, 250);
    check_near("HEALTH: capture full", bus_item(&bus, WIRE_HEALTH, DIAG_CAPTURE_STATE), CAPTURE_FULL, 0);
    check_near("HEALTH: tick of the trigger", bus_item(&bus, WIRE_HEALTH, DIAG_CAPTURE_TICK), (double)liftoff,
               0);
    check_near("HEALTH: samples before it", bus_item(&bus, WIRE_HEALTH, DIAG_CAPTURE_PRETRIGGER), 60, 0);
    /* Sample 60 is the first tick behind the lift-off; alone[i] is the plant at tick start + 1 + i. */
    int wrong = read_burst(200, &alone[liftoff + 1 - 60 - start - 1]);
    check_int("values other than those of the plant alone around its lift-off", wrong, 0);
    const struct message *m = bus_last(&bus, WIRE_CAPTURE_DATA);
    check_near("last value: contact flag", m ? m->value[CAPTURE_DATA_VALUE] : (double)NAN,
               (double)alone[liftoff - 60 - start + 199][4], 0);
    check_near("one sample before the trigger: in contact", (double)alone[liftoff - 60 - start + 59][4], 1.0,
               0.0);
    check_near("first one after: apart", (double)alone[liftoff - 60 - start + 60][4], 0.0, 0.0);
}

/* Every third tick from the arming on; the trigger is a fire, and fewer samples were there than asked for. */
TEST(app_capture_fire)
{
    static float alone[LONG][OUTPUTS], every[100][OUTPUTS];
    bus_start_rig(&bus);
    set_all((const double[][2]){{SET_CAPTURE_SAMPLES, 100},
                                {SET_CAPTURE_PRETRIGGER, 90},
                                {SET_CAPTURE_TRIGGER, TRIGGER_FIRE},
                                {SET_CAPTURE_EVERY_TICKS, 3}},
            4);
    struct plant plant = bus.app.plant;
    int64_t start = (int64_t)plant.now.tick;
    const struct instant at = {(uint64_t)start + 100, 128 * 256};
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0});
    bus_drive(&bus, RIG_FORCE, 16.0, 215.0, 0.0, 0.0);
    bus_fire(&bus, 1, false, at.tick, 128);
    record_alone(&plant, 100, alone);
    if (!plant_advance(&plant, at))
        check_true("alone: finite", 0);
    plant_drive(&plant, RIG_FORCE, 16.0, 215.0, 0.0, 0.0);
    if (!plant_advance(&plant, (struct instant){at.tick + 1, 0}))
        check_true("alone: finite", 0);
    double now[MODEL_OUTPUTS];
    plant_output(&plant, now);
    for (int k = 0; k < OUTPUTS; k++)
        alone[100][k] = (float)now[k];
    record_alone(&plant, LONG - 101, alone + 101);
    for (int i = 0; i < 100; i++)
        memcpy(every[i], alone[3 * i], sizeof every[i]);
    bus_run(&bus, 250);
    check_near("HEALTH: tick of the trigger", bus_item(&bus, WIRE_HEALTH, DIAG_CAPTURE_TICK), (double)at.tick,
               0);
    /* Ticks start+1, +4, .. +100 lie before start+100.5: 34 samples. */
    check_near("HEALTH: samples before it", bus_item(&bus, WIRE_HEALTH, DIAG_CAPTURE_PRETRIGGER), 34, 0);
    check_int("values other than those of the plant alone, every third tick", read_burst(100, every), 0);
}

/* Memory that is handed in when a burst needs more. */
static struct {
    float *there; /* NULL: none */
    uint32_t asked, calls;
} store;

static float *grow_capture(void *owner, uint32_t n)
{
    store.asked = n;
    store.calls++;
    return owner == &store ? store.there : NULL;
}

static int arm_burst(double samples, double pretrigger)
{
    set_all((const double[][2]){{SET_CAPTURE_SAMPLES, samples}, {SET_CAPTURE_PRETRIGGER, pretrigger}}, 2);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0});
    bus_run(&bus, 1);
    return bus_cause(&bus, WIRE_CAPTURE);
}

TEST(app_capture_memory)
{
    static float more[1639 * OUTPUTS];
    struct app_config c = bus_config();
    c.grow_capture = grow_capture;
    c.capture_owner = &store;
    memset(&store, 0, sizeof store);
    bus_start_running(&bus, &c);
    check_int("a burst that fits", arm_burst(10, 4), CAUSE_OK);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_TRIGGER, 0, 0});
    bus_run(&bus, 4);
    check_int("is full", bus.app.capture.state, CAPTURE_FULL);
    check_int("it asks for no memory", store.calls, 0);
    check_int("1639 samples of 5 in 8192 floats, and no memory", arm_burst(1639, 4), CAUSE_FULL);
    check_int("floats asked for", store.asked, sizeof more / sizeof more[0]);
    check_int("counted", bus.app.count[DIAG_FULL], 1);
    check_int("the burst of before is still there", bus.app.capture.state, CAPTURE_FULL);
    check_int("samples of it", bus.app.capture.n_samples, 10);
    check_true("its memory, too", bus.app.config.capture == bus.capture);
    store.there = more;
    check_int("with memory", arm_burst(1639, 4), CAUSE_OK);
    check_true("it is taken", bus.app.config.capture == more);
    check_int("armed", bus.app.capture.state, CAPTURE_ARMED);
    bus_run(&bus, 4);
    check_near("and written to: the contact flag of its second sample", (double)more[OUTPUTS + 4], 1.0, 0.0);
    check_int("a shorter burst fits into it", arm_burst(1638, 4), CAUSE_OK);
    check_int("calls", store.calls, 2);
}

TEST(app_capture_refused)
{
    const double read[][2] = {{0, 10}, {0, 11}, {10, 1}, {9, 1}};
    bus_start_rig(&bus);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_READ, 0, 1});
    bus_run(&bus, 1);
    check_int("read of nothing", bus_cause(&bus, WIRE_CAPTURE), CAUSE_STATE);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_TRIGGER, 0, 0});
    bus_run(&bus, 1);
    check_int("trigger of nothing", bus_cause(&bus, WIRE_CAPTURE), CAUSE_STATE);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, 4, 0, 0});
    bus_run(&bus, 1);
    check_int("no such operation", bus_cause(&bus, WIRE_CAPTURE), CAUSE_UNKNOWN);
    set_all((const double[][2]){{SET_CAPTURE_SAMPLES, 1639}}, 1);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0});
    bus_run(&bus, 1);
    check_int("1639 samples of 5 in 8192 floats", bus_cause(&bus, WIRE_CAPTURE), CAUSE_RANGE);
    /* It waits for a lift-off that never comes: the command triggers it all the same. */
    set_all((const double[][2]){{SET_CAPTURE_SAMPLES, 10},
                                {SET_CAPTURE_PRETRIGGER, 4},
                                {SET_CAPTURE_TRIGGER, TRIGGER_LIFTOFF}},
            3);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM, 0, 0});
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_TRIGGER, 0, 0});
    bus_run(&bus, 2);
    for (int i = 0; i < 4; i++) {
        bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_READ, read[i][0], read[i][1]});
        bus_run(&bus, 10);
        check_int("read of 10 samples, by first and count", bus_cause(&bus, WIRE_CAPTURE),
                  i == 0 || i == 3 ? CAUSE_OK : CAUSE_RANGE);
    }
}

/* Slots 0 (harmonic 1), 2 (harmonic 2) and 3 (mean of the
 * contact force) over two windows against sums of our own. */
TEST(app_lockin_sum)
{
    enum { WINDOW = 20 * BUS_TICKS, FIRED = 6 * BUS_TICKS };
    const double hertz = 250.0, phase = 0.5; /* 5 periods a window: the mean force over one is the preload */
    bus_start_rig(&bus);
    set_all((const double[][2]){{SET_LOCKIN_FRAMES, 20},
                                {SET_LOCKIN_HARMONIC + 3, 0},
                                {SET_LOCKIN_OUTPUT + 3, 3}},
            3);
    bus_drive(&bus, RIG_FORCE, 8.0, hertz, phase, 0.0);
    bus_run(&bus, 6 - (int)(bus.app.plant.now.tick / BUS_TICKS));
    struct plant plant = bus.app.plant;
    check_int("tick of the fire", (int64_t)plant.now.tick, FIRED);
    bus_fire(&bus, 1, false, FIRED, 0);
    plant_drive(&plant, RIG_FORCE, 8.0, hertz, phase, 0.0);
    /* The slots that follow the drive begin with the first whole frame in which it sounds. */
    bus_run(&bus, 1);
    if (!plant_run(&plant, BUS_TICKS))
        check_true("alone: finite", 0);
    for (int window = 0; window < 2; window++) {
        double complex first = 0.0, second = 0.0;
        double weight = 0.0;
        for (int k = 0; k < WINDOW; k++) {
            if (!plant_run(&plant, 1))
                check_true("alone: finite", 0);
            double theta = TWO_PI * hertz * (double)(plant.now.tick - FIRED) * 1e-3 / BUS_TICKS + phase;
            double w = 1.0 - cos(TWO_PI * (k + 0.5) / WINDOW), y = plant_read(&plant, "displacement");
            first += w * y * cexp(-J * theta);
            second += w * y * cexp(-2.0 * J * theta);
            weight += w;
        }
        bus_forget(&bus);
        bus_run(&bus, 20);
        for (int i = 0; i < bus.n_seen; i++) {
            const struct message *m = &bus.seen[i];
            double complex z = 2.0 / weight * (m->value[LOCKIN_SLOT] == 0 ? first : second);
            if (m->kind != WIRE_LOCKIN || (m->value[LOCKIN_SLOT] != 0 && m->value[LOCKIN_SLOT] != 2))
                continue;
            printf("      window %d, harmonic %d\n", window, m->value[LOCKIN_SLOT] == 0 ? 1 : 2);
            check_near("amplitude over the sum's", m->value[LOCKIN_AMPLITUDE] / cabs(z), 1.0, 1e-7);
            check_near("phase, rad", m->value[LOCKIN_PHASE], carg(z), 5e-5);
        }
        check_int("LOCKIN in 20 frames, of slots 0, 2 and the mean", bus_count(&bus, WIRE_LOCKIN), 3);
    }
    bus_run(&bus, 3000);
    for (int i = bus.n_seen; i > 0; i--) {
        const struct message *m = &bus.seen[i - 1];
        if (m->kind != WIRE_LOCKIN || m->value[LOCKIN_SLOT] != 3)
            continue;
        check_near("mean contact force over whole periods is the preload, N", m->value[LOCKIN_AMPLITUDE],
                   64.0, 1e-3);
        break;
    }
}

/* So small a force that the rig is linear: amplitude and phase of its transfer function. */
TEST(app_lockin_linear)
{
    const double hertz[] = {100.0, 230.0, 400.0};
    for (int i = 0; i < 3; i++) {
        bus_start_rig(&bus);
        bus_drive(&bus, RIG_FORCE, 64e-5, hertz[i], 0.0, 0.0);
        bus_fire(&bus, 1, false, 4 * BUS_TICKS, 0);
        for (int k = 0; k < 20; k++) {
            bus_run(&bus, 100);
            bus_forget(&bus);
        }
        bus_run(&bus, 200);
        const double *si = bus.app.plant.si;
        double zs = pow(si[RIG_PRELOAD] / si[RIG_CONTACT_STIFFNESS], 2.0 / 3.0);
        double nu = sqrt(1.5 * si[RIG_PRELOAD] / (si[RIG_MASS] * zs)), r = TWO_PI * hertz[i] / nu;
        double xi = si[RIG_DAMPING] / (2.0 * si[RIG_MASS] * nu);
        double complex h = 2.0 / 3.0 * 1e-5 * zs / (1.0 - r * r + 2.0 * J * xi * r);
        printf("      %g Hz\n", hertz[i]);
        for (int k = bus.n_seen; k > 0; k--) {
            const struct message *m = &bus.seen[k - 1];
            if (m->kind != WIRE_LOCKIN || m->value[LOCKIN_SLOT] != 0)
                continue;
            check_near("amplitude over |H|", m->value[LOCKIN_AMPLITUDE] / cabs(h), 1.0, 3e-5);
            check_near("phase, rad", m->value[LOCKIN_PHASE], carg(h), 3e-4);
            break;
        }
    }
}

/* A fault stops the plant inside a frame: the window begins anew. So it does for all slots when a drive
 * begins to sound or falls silent, for a tone that lasts half a window is none. */
TEST(app_lockin_window)
{
    const struct lockin_window *w = &bus.app.lockin.window;
    bus_start_rig(&bus);
    set_all((const double[][2]){{SET_LOCKIN_FRAMES, 20}, {SET_LOCKIN_HARMONIC + 3, 0}}, 2);
    bus_run(&bus, 3);
    check_int("ticks of whole frames", w->i_tick % BUS_TICKS, 0);
    check_above("of more than one", w->i_tick, BUS_TICKS);
    bus.app.lockin.window.i_tick -= 5;
    bus_run(&bus, 1);
    check_int("anew with the frame after the fault", w->i_tick, BUS_TICKS);
    bus_forget(&bus);
    bus_run(&bus, 18);
    check_int("no LOCKIN after 19 frames", bus_count(&bus, WIRE_LOCKIN), 0);
    bus_run(&bus, 1);
    check_int("one after 20", bus_count(&bus, WIRE_LOCKIN), 1);
    for (int input = RIG_FORCE; input <= RIG_BASE; input += RIG_BASE - RIG_FORCE) {
        bus_run(&bus, 7);
        plant_drive_start(&bus.app.plant, input, 1e-9, 250.0, 0.0);
        bus_forget(&bus);
        bus_run(&bus, 19);
        check_int("no LOCKIN in 19 frames of a drive", bus_count(&bus, WIRE_LOCKIN), 0);
        bus_run(&bus, 1);
        check_int("in 20: the mean, and the slots of the drives", bus_count(&bus, WIRE_LOCKIN),
                  input == RIG_FORCE ? 3 : 4);
    }
    bus_run(&bus, 7);
    plant_drive_start(&bus.app.plant, RIG_BASE, 0.0, 250.0, 0.0);
    bus_forget(&bus);
    bus_run(&bus, 19);
    check_int("no LOCKIN in 19 frames after one fell silent", bus_count(&bus, WIRE_LOCKIN), 0);
    bus_run(&bus, 1);
    check_int("in 20", bus_count(&bus, WIRE_LOCKIN), 3);
}

/* Settings of the lock-in that come with a FIRE inside a frame act on windows from the next frame on. A slot
 * that is switched off gives no result. A slot that moves to another output has no sample of the output
 * before. Both hold wherever in its frame the FIRE falls. */
static void fire_settings(const double (*pair)[2], int n, uint64_t tick, unsigned fraction)
{
    struct staged set = {{0}, {0.0}};
    for (int i = 0; i < n; i++) {
        unsigned index = SETTING_FIRST + (unsigned)pair[i][0];
        bus_write(&bus, index, pair[i][1]);
        staged_put(&set, index, pair[i][1]);
    }
    bus_commit(&bus, &set, COMMIT_WITH_FIRE);
    bus_fire(&bus, 0, true, tick, fraction);
}

/* The rig at rest, and the mean of outputs in windows of 2 frames. */
static void start_means(void)
{
    bus_start_rig(&bus);
    set_all(
        (const double[][2]){{SET_LOCKIN_FRAMES, 2}, {SET_LOCKIN_HARMONIC + 3, 0}, {SET_LOCKIN_OUTPUT + 3, 3}},
        3);
    bus_run(&bus, 4);
    bus_forget(&bus);
}

TEST(app_lockin_fire)
{
    for (int tick = 0; tick < BUS_TICKS; tick++) {
        start_means();
        uint64_t next = bus.app.plant.now.tick + (uint64_t)tick;
        fire_settings((const double[][2]){{SET_LOCKIN_FRAMES, 0}}, 1, next, 128);
        bus_run(&bus, 1);
        check_int("the set is in force", bus.app.lockin.window.n_ticks, 0);
        bus_forget(&bus);
        bus_run(&bus, 4);
        check_int("LOCKIN of slots that are off", bus_count(&bus, WIRE_LOCKIN), 0);
        start_means();
        next = bus.app.plant.now.tick + (uint64_t)tick;
        fire_settings((const double[][2]){{SET_LOCKIN_OUTPUT + 3, 1}}, 1, next, 128);
        bus_run(&bus, 1);
        bus_forget(&bus);
        bus_run(&bus, 4);
        check_int("LOCKIN in 4 frames from the next one on", bus_count(&bus, WIRE_LOCKIN), 2);
        double most = 0.0;
        for (int i = 0; i < bus.n_seen; i++)
            if (bus.seen[i].kind == WIRE_LOCKIN)
                most = fmax(most, fabs(bus.seen[i].value[LOCKIN_AMPLITUDE]));
        check_near("the largest mean of the velocity at rest, m/s", most, 0.0, 1e-12);
    }
}

/* Each slot follows the input that its own setting names: of four slots on four inputs one speaks, the one
 * whose input sounds. */
TEST(app_lockin_slots)
{
    static const double amplitude[] = {1.0, 1.0, 1e-9, 1e-3};
    for (int input = 0; input < MODEL_INPUTS; input++) {
        bus_start_rig(&bus);
        set_all((const double[][2]){{SET_LOCKIN_FRAMES, 2},
                                    {SET_LOCKIN_CHANNEL, 2},
                                    {SET_LOCKIN_CHANNEL + 1, 3},
                                    {SET_LOCKIN_CHANNEL + 2, 0},
                                    {SET_LOCKIN_CHANNEL + 3, 1}},
                5);
        plant_drive_start(&bus.app.plant, input, amplitude[input], 250.0, 0.0);
        bus_forget(&bus);
        bus_run(&bus, 8);
        check_int("LOCKIN in 8 frames", bus_count(&bus, WIRE_LOCKIN), 4);
        check_near("its slot", bus_value(&bus, WIRE_LOCKIN, LOCKIN_SLOT), (input + 2) % 4, 0);
    }
}
