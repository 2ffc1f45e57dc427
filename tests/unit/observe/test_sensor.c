/* test_sensor.c - faults of the sensors over the bus.
 *
 * Each is compared with its closed form, computed from the plant's true outputs and rounded to the wire's
 * LSB. Other tests are signals that they must not touch, and values that are refused. */
#include <math.h>
#include <string.h>
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_report.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { FRAMES = 300, SEED = 4711, NONE = -8388608 /* the wire's number for not available */ };

static struct bus bus;
static double truth[SENSOR_SIGNALS][FRAMES + 1]; /* by plant frame */

/* A setting committed now, of one signal; what the wire's float32 makes of it. */
static double set(int kind, int signal, double value)
{
    bus_set(&bus, SETTING_FIRST + (unsigned)(kind + signal), value);
    return (double)(float)value;
}

/* Running, with the mass driven so hard that contact is lost. */
static void start_sensed(void)
{
    bus_start_rig(&bus);
    bus_drive(&bus, RIG_FORCE, 40.0, 215.0, 0.0, 0.01);
    bus_fire(&bus, 1u << RIG_FORCE, false, 20, 0);
}

static uint64_t plant_frame(void)
{
    return bus.app.plant.now.tick / bus.app.config.substeps;
}

/* One frame more; its true outputs. */
static void run_one(void)
{
    double output[MODEL_OUTPUTS];
    bus_forget(&bus);
    bus_run(&bus, 1);
    plant_output(&bus.app.plant, output);
    for (int i = 0; i < SENSOR_SIGNALS && plant_frame() <= FRAMES; i++)
        truth[i][plant_frame()] = output[i];
}

/* The number that stands for a value on the wire. */
static int64_t number(int i, double value)
{
    double n = value / bus.scene.lsb[i];
    return fabs(n) < 8388607.5 ? llround(n) : NONE;
}

/* The number that MOTION or CONTACT told last. */
static int64_t told(int i)
{
    return number(i, bus_value(&bus, i < 2 ? WIRE_MOTION : WIRE_CONTACT, 1 + i % 2));
}

/* Frames of n in which signal i did not say `form(i, plant frame)`. */
static int differences(int n, int i, double (*form)(int i, uint64_t k))
{
    int wrong = 0;
    for (int f = 0; f < n; f++) {
        run_one();
        for (int k = 0; k < SENSOR_SIGNALS; k++) {
            double expected = k == i ? form(i, plant_frame()) : truth[k][plant_frame()];
            wrong += told(k) != number(k, expected);
        }
    }
    return wrong;
}

static double plain(int i, uint64_t k)
{
    return truth[i][k];
}

TEST(sensor_none)
{
    start_sensed();
    check_int("no fault: numbers that are not the truth in 250 frames", differences(250, 0, plain), 0);
    check_above("contact was lost, times", bus.app.plant.counts.switches, 10);
    bus_run(&bus, 5 * DIAG_COUNTERS);
    check_near("HEALTH: sensor_faults", bus_item(&bus, WIRE_HEALTH, DIAG_SENSOR_FAULTS), 0, 0);
}

static double by; /* setting of the fault tested */

static double shifted(int i, uint64_t k)
{
    return truth[i][k] + by;
}

TEST(sensor_offset)
{
    for (int i = 0; i < SENSOR_SIGNALS; i++) {
        start_sensed();
        run_one();
        by = set(SET_SENSOR_OFFSET, i, (i % 2 ? -1000 : 1000) * bus.scene.lsb[i]);
        check_int(setting_table[SET_SENSOR_OFFSET + i].name, differences(100, i, shifted), 0);
        check_near("in LSB", (double)(told(i) - number(i, truth[i][plant_frame()])), i % 2 ? -1000 : 1000,
                   0.0);
        set(SET_SENSOR_OFFSET, i, 0.0);
        check_int("and 0 ends it", differences(20, 0, plain), 0);
    }
}

/* Word k of sequence 2^32 (4 + signal) + seed, as docs/reference/messages.md says. */
static double noisy(int i, uint64_t k)
{
    return truth[i][k] + by * noise_deviate(noise_word(((uint64_t)(4 + i) << 32) + SEED, k));
}

/* Moments of what all four say beyond the truth, in standard
 * deviations, and of neighbours in time and in signal. */
static void check_moments(int n)
{
    double mean = 0.0, square = 0.0, next = 0.0, beside = 0.0, last[SENSOR_SIGNALS] = {0.0};
    for (int f = 0; f < n; f++) {
        double output[MODEL_OUTPUTS], x[SENSOR_SIGNALS];
        run_one();
        plant_output(&bus.app.plant, output);
        for (int i = 0; i < SENSOR_SIGNALS; i++) {
            x[i] = ((double)told(i) - output[i] / bus.scene.lsb[i]) / 1000.0;
            mean += x[i];
            square += x[i] * x[i];
            next += x[i] * last[i];
            last[i] = x[i];
        }
        beside += x[0] * x[1] + x[2] * x[3] + x[0] * x[2];
    }
    double all = 4.0 * n, sigma = 1.0 / sqrt(all);
    check_near("mean, 5 sigma", mean / all, 0.0, 5.0 * sigma);
    check_near("variance, 5 sigma", square / all, 1.0, 5.0 * sqrt(2.0) * sigma);
    check_near("from frame to frame, 5 sigma", next / all, 0.0, 5.0 * sigma);
    check_near("from signal to signal, 5 sigma", beside / (3.0 * n), 0.0, 5.0 / sqrt(3.0 * n));
}

TEST(sensor_noise)
{
    for (int i = 0; i < SENSOR_SIGNALS; i++) {
        start_sensed();
        run_one();
        set(SET_SENSOR_SEED, 0, SEED);
        by = set(SET_SENSOR_NOISE, i, 300 * bus.scene.lsb[i]);
        check_int(setting_table[SET_SENSOR_NOISE + i].name, differences(100, i, noisy), 0);
    }
    start_sensed();
    for (int i = 0; i < SENSOR_SIGNALS; i++)
        set(SET_SENSOR_NOISE, i, 1000 * bus.scene.lsb[i]);
    check_moments(20000);
}

static int64_t stuck_at;

static double stuck_value(int i, uint64_t k)
{
    (void)k;
    return (double)stuck_at * bus.scene.lsb[i];
}

TEST(sensor_stuck)
{
    for (int i = 0; i < SENSOR_SIGNALS; i++) {
        start_sensed();
        for (int f = 0; f < 40; f++)
            run_one();
        stuck_at = told(i);
        set(SET_SENSOR_STUCK, i, 1);
        check_int(setting_table[SET_SENSOR_STUCK + i].name, differences(60, i, stuck_value), 0);
        set(SET_SENSOR_OFFSET, i, 5000 * bus.scene.lsb[i]);
        check_int("an offset does not move it", differences(30, i, stuck_value), 0);
        set(SET_SENSOR_OFFSET, i, 0.0);
        set(SET_SENSOR_STUCK, i, 0);
        check_int("and 0 frees it", differences(30, 0, plain), 0);
    }
    double setting[SETTINGS];
    struct app_config c = bus_config();
    for (int i = 0; i < SETTINGS; i++)
        setting[i] = setting_initial(i, c.model, c.frame_s);
    setting[SET_SENSOR_STUCK] = 1.0;
    c.setting = setting;
    bus_start_running(&bus, &c);
    run_one();
    stuck_at = told(0);
    check_near("stuck from the start: its first value", (double)stuck_at, (double)number(0, truth[0][1]),
               0.0);
    bus_drive(&bus, RIG_FORCE, 40.0, 215.0, 0.0, 0.01);
    bus_fire(&bus, 1u << RIG_FORCE, false, 40, 0);
    check_int("for ever", differences(100, 0, stuck_value), 0);
}

static double held(int i, uint64_t k)
{
    return fmax(-by, fmin(by, truth[i][k]));
}

TEST(sensor_saturation)
{
    for (int i = 0; i < SENSOR_SIGNALS; i++) {
        int high = 0, low = 0, within = 0;
        start_sensed();
        for (int f = 0; f < 60; f++)
            run_one();
        by = set(SET_SENSOR_SATURATION, i, 0.3 * fabs(truth[i][60]) + 0.3 * fabs(truth[i][59]));
        check_int(setting_table[SET_SENSOR_SATURATION + i].name, differences(200, i, held), 0);
        for (int f = 61; f <= 260; f++) {
            high += truth[i][f] > by;
            low += truth[i][f] < -by;
            within += fabs(truth[i][f]) < by;
        }
        check_above("frames above the limit", high, 5);
        check_above("within", within, 5);
        check_above("below", low, i < 2 ? 5 : 0);
    }
}

static double stepped(int i, uint64_t k)
{
    return by * rint(truth[i][k] / by);
}

TEST(sensor_quantum)
{
    for (int i = 0; i < SENSOR_SIGNALS; i++) {
        start_sensed();
        run_one();
        by = set(SET_SENSOR_QUANTUM, i, 512 * bus.scene.lsb[i]);
        check_int(setting_table[SET_SENSOR_QUANTUM + i].name, differences(200, i, stepped), 0);
        check_int("a multiple of 512 LSB", told(i) % 512, 0);
    }
}

static int late[SENSOR_SIGNALS]; /* frames, of each signal */

static int late_differences(int n)
{
    int wrong = 0;
    for (int f = 0; f < n; f++) {
        run_one();
        for (int i = 0; i < SENSOR_SIGNALS; i++) {
            int64_t then = (int64_t)plant_frame() - late[i];
            wrong += bus_count(&bus, WIRE_MOTION) > 0 &&
                     told(i) != (then > 0 ? number(i, truth[i][then]) : (int64_t)NONE);
        }
    }
    return wrong;
}

/* Before there was a value so old none is available. */
TEST(sensor_delay)
{
    double setting[SETTINGS];
    struct app_config c = bus_config();
    for (int i = 0; i < SETTINGS; i++)
        setting[i] = setting_initial(i, c.model, c.frame_s);
    for (int i = 0; i < SENSOR_SIGNALS; i++)
        setting[SET_SENSOR_DELAY + i] = late[i] = 8 * i + 1;
    c.setting = setting;
    bus_start_running(&bus, &c);
    bus_drive(&bus, RIG_FORCE, 40.0, 215.0, 0.0, 0.01);
    bus_fire(&bus, 1u << RIG_FORCE, false, 20, 0);
    check_int("from the first frame on: numbers that are not so old", late_differences(120), 0);
    for (int i = 0; i < SENSOR_SIGNALS; i++)
        set(SET_SENSOR_DELAY, i, late[i] = i ? SENSOR_DELAY_MAX - i + 1 : 7);
    check_int("changed on the way", late_differences(100), 0);
    bus_set(&bus, SETTING_FIRST + SET_MOTION_EVERY, 3);
    bus_set(&bus, SETTING_FIRST + SET_CONTACT_EVERY, 3);
    check_int("in frames, not messages", late_differences(60), 0);
}

/* Three frames pass without their messages: what comes 10 frames after them is theirs all the same. */
TEST(sensor_skipped)
{
    double before[SENSOR_SIGNALS][FRAMES + 1];
    start_sensed();
    for (int f = 0; f < 100; f++)
        run_one();
    memcpy(before, truth, sizeof before);
    start_sensed();
    bus_set(&bus, SETTING_FIRST + SET_OVERRUN_POLICY, OVERRUN_SKIP);
    for (int i = 0; i < SENSOR_SIGNALS; i++)
        set(SET_SENSOR_DELAY, i, late[i] = 10);
    for (int f = 0; f < 50; f++)
        run_one();
    check_int("calls due", app_overrun(&bus.app, 3), 1);
    run_one();
    check_int("plant frame", (int64_t)plant_frame(), 54);
    memcpy(truth, before, sizeof truth);
    check_int("numbers that are not 10 frames old", late_differences(40), 0);
}

static double chain(int i, uint64_t k)
{
    double lsb = bus.scene.lsb[i];
    double x = truth[i][k - 5] + (double)(float)(3000.0 * lsb);
    x += (double)(float)(500.0 * lsb) * noise_deviate(noise_word((uint64_t)(4 + i) << 32, k));
    double limit = (double)(float)(6000.5 * lsb), quantum = (double)(float)(700.0 * lsb);
    return quantum * rint(fmax(-limit, fmin(limit, x)) / quantum);
}

/* delay, offset, noise, saturation, quantum, stuck: the limit is no multiple of the quantum, so that 9 of
 * them are sent where 8.57 is the limit. */
TEST(sensor_order)
{
    for (int i = 0; i < SENSOR_SIGNALS; i++) {
        start_sensed();
        double lsb = bus.scene.lsb[i];
        for (int f = 0; f < 40; f++)
            run_one();
        const struct {
            int kind;
            double value;
        } fault[] = {{SET_SENSOR_DELAY, 5},
                     {SET_SENSOR_OFFSET, 3000.0 * lsb},
                     {SET_SENSOR_NOISE, 500.0 * lsb},
                     {SET_SENSOR_SATURATION, 6000.5 * lsb},
                     {SET_SENSOR_QUANTUM, 700.0 * lsb}};
        for (int k = 0; k < 5; k++)
            set(fault[k].kind, i, fault[k].value);
        check_int("one after the other: numbers that differ", differences(150, i, chain), 0);
        stuck_at = told(i);
        set(SET_SENSOR_STUCK, i, 1);
        check_int("stuck is the last", differences(50, i, stuck_value), 0);
        bus_run(&bus, 5 * DIAG_COUNTERS);
        check_near("HEALTH: sensor_faults, every kind of one signal",
                   bus_item(&bus, WIRE_HEALTH, DIAG_SENSOR_FAULTS), 0x111111 << i, 0);
    }
}

/* By hand: no model has such an output today. */
TEST(sensor_not_available)
{
    static struct sensor s;
    double setting[SETTINGS], output[SENSOR_SIGNALS] = {(double)NAN, 1.0, (double)NAN, 3.0};
    double said[2] = {(double)NAN, (double)NAN};
    for (int i = 0; i < SETTINGS; i++)
        setting[i] = setting_initial(i, &hertz_rig, 1e-3);
    for (int k = 0; k < SENSOR_FAULTS; k++)
        setting[SET_SENSOR_OFFSET + k] = 1.0;
    sensor_init(&s);
    sensor_change(&s, setting);
    for (uint64_t frame = 1; frame <= 3; frame++) {
        sensor_record(&s, frame, output);
        check_nan("not available stays so under all faults", sensor_read(&s, setting, 0, &said[0]));
        check_true("another one not", frame == 1 || !isnan(sensor_read(&s, setting, 3, &said[1])));
    }
    start_sensed();
    set(SET_SENSOR_OFFSET, 0, 1e6);
    run_one();
    check_int("what no longer fits the wire is not available", told(0), NONE);
    set(SET_SENSOR_SATURATION, 0, 1e6 * bus.scene.lsb[0]);
    run_one();
    check_int("and fits again within a limit", told(0), 1000000);
}

static uint32_t add_message(uint32_t crc, const struct message *m)
{
    crc = wire_crc32(crc, &m->kind, 1);
    return wire_crc32(crc, (const uint8_t *)m->value, wire_layout(m->kind)->n_fields * (int)sizeof *m->value);
}

/* CRCs of what 300 frames say: [0] MOTION and CONTACT, [1] events, lock-in, ledger, capture and
 * everything else, but what a setting or its echo counts. */
static uint64_t session(double on, double seed, uint32_t crc[2])
{
    crc[0] = crc[1] = 0;
    start_sensed();
    set(SET_SENSOR_SEED, 0, seed);
    bus_set(&bus, SETTING_FIRST + SET_HASH_EVERY, 1);
    bus_set(&bus, SETTING_FIRST + SET_CAPTURE_TRIGGER, TRIGGER_LIFTOFF);
    bus_set(&bus, SETTING_FIRST + SET_CAPTURE_PRETRIGGER, 20);
    bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_ARM});
    for (int k = 0; k < SENSOR_FAULTS; k++) {
        int kind = SET_SENSOR_OFFSET + k / SENSOR_SIGNALS * SENSOR_SIGNALS, i = k % SENSOR_SIGNALS;
        double value = kind < SET_SENSOR_DELAY ? 1000 * bus.scene.lsb[i] : kind == SET_SENSOR_DELAY ? 4 : 0;
        set(kind, i, on * value);
    }
    for (int f = 0; f < FRAMES; f++) {
        run_one();
        if (f == 200)
            bus_command(&bus, WIRE_CAPTURE, (double[WIRE_FIELDS]){0, CAPTURE_READ, 0, 150});
        for (int i = 0; i < bus.n_seen; i++) {
            const struct message *m = &bus.seen[i];
            bool sensed = m->kind == WIRE_MOTION || m->kind == WIRE_CONTACT;
            if (m->kind != WIRE_PARAM_ECHO && m->kind != WIRE_HEALTH)
                crc[!sensed] = add_message(crc[!sensed], m);
        }
    }
    return plant_hash(&bus.app.plant);
}

/* A setting of 0 commanded is as none; the plant and everything else that is told of it never see a fault. */
TEST(sensor_truth)
{
    uint32_t without[2], with[2], again[2], other[2];
    uint64_t hash = session(0.0, 1, without);
    check_hex("state of the plant under faults", session(1.0, 1, with), hash);
    check_int("the burst was taken", bus.app.capture.state, CAPTURE_FULL);
    check_hex("events, lock-in, ledger, capture, hashes", with[1], without[1]);
    check_is("MOTION and CONTACT differ", with[0], !=, without[0]);
    (void)session(1.0, 1, again);
    check_hex("the same seed: the same numbers", again[0], with[0]);
    (void)session(1.0, 2, other);
    check_is("another seed: others", other[0], !=, with[0]);
}

TEST(sensor_reset)
{
    start_sensed();
    by = set(SET_SENSOR_OFFSET, 0, 1000 * bus.scene.lsb[0]);
    check_int("offset", differences(30, 0, shifted), 0);
    bus_order(&bus, CONTROL_PAUSE);
    run_one();
    bus_order(&bus, CONTROL_RESET);
    run_one();
    check_int("reset is taken", bus_cause(&bus, WIRE_CONTROL), CAUSE_OK);
    bus_enable(&bus, false);
    bus_silent(&bus, 3);
    bus.session = 2;
    bus_run(&bus, 1);
    bus_order(&bus, CONTROL_START);
    check_int("still there after a reset and in the next session", differences(30, 0, shifted), 0);
}

TEST(sensor_refused)
{
    const struct {
        int setting;
        double good, bad;
    } edge[] = {{SET_SENSOR_OFFSET, -1e6, -1.1e6},
                {SET_SENSOR_OFFSET + 3, 1e6, (double)INFINITY},
                {SET_SENSOR_NOISE, 1e-9, -1e-9},
                {SET_SENSOR_NOISE + 1, 1e6, (double)NAN},
                {SET_SENSOR_SATURATION + 2, 0.0, -1},
                {SET_SENSOR_SATURATION, 1e6, 1e7},
                {SET_SENSOR_QUANTUM + 3, 0.25, -0.25},
                {SET_SENSOR_DELAY, 32, 33},
                {SET_SENSOR_DELAY + 1, 0, -1},
                {SET_SENSOR_DELAY + 3, 2, 1.5},
                {SET_SENSOR_STUCK, 1, 2},
                {SET_SENSOR_STUCK + 2, 0, 0.5},
                {SET_SENSOR_SEED, 65535, 65536},
                {SET_SENSOR_SEED, 0, 0.5}};
    start_sensed();
    for (unsigned i = 0; i < sizeof edge / sizeof edge[0]; i++) {
        unsigned index = SETTING_FIRST + (unsigned)edge[i].setting;
        bus_set(&bus, index, edge[i].good);
        run_one();
        check_int(setting_table[edge[i].setting].name, bus_cause(&bus, WIRE_PARAM_COMMIT), CAUSE_OK);
        bus_write(&bus, index, edge[i].bad);
        run_one();
        check_int("refused beyond", bus_cause(&bus, WIRE_PARAM_WRITE), CAUSE_RANGE);
        check_near("the value before stays", bus.app.setting[edge[i].setting], (double)(float)edge[i].good,
                   0.0);
    }
}
