/* test_app_beside.c - apps side by side send and compute what each does alone. */
#include "tests/unit/test.h"

#include <string.h>
#include "host_sim/beside/beside.h"
#include "models/models.h"
#include "tests/fixture/any_motion.h"
#include "tests/fixture/bus.h"

enum { FARMS = 40, TURNS = 120 };

static struct bus alone[SIDES], beside[SIDES];
static double scratch[2][SIDES][METHOD_SCRATCH];

/* Mostly rigs, with frames of their own. */
static void begin_both(uint32_t i)
{
    struct app_config c = bus_config();
    bool other = any_pick(8) == 0;
    c.model = other ? model_table[any_pick(MODELS)] : &hertz_rig;
    c.method = other || any_pick(2) ? &auto_method : &rk4;
    c.substeps = any_pick(2) ? 64 : 8 + any_pick(90);
    c.dilation = c.frame_s / (any_tick_s(c.model) * c.substeps);
    c.scratch = scratch[0][i];
    bus_start(&alone[i], &c);
    c.scratch = scratch[1][i];
    bus_start(&beside[i], &c);
}

/* A random command; a and b are in 0..1. */
static void command(struct bus *b, uint32_t kind, uint32_t which, double a, double c)
{
    static const unsigned setting[] = {SET_TIMEOUT_FRAMES, SET_REACTION,      SET_OVERRUN_POLICY,
                                       SET_LOCKIN_CHANNEL, SET_LOCKIN_FRAMES, SET_STREAM_LINEAR,
                                       SET_SENSOR_NOISE,   SET_SENSOR_DELAY};
    const struct plant *pl = &b->app.plant;
    int channel = (int)(which % (uint32_t)pl->model->n_inputs);
    double unit = scale_of(&pl->scale, pl->model->input_signal[channel].quantity);
    switch (kind) {
    case 0:
        bus_drive(b, channel, (c < 0.1 ? 1e14 : 2.0) * a * unit, (0.002 + 0.05 * c) / pl->tick_s, 6.0 * a,
                  0.0);
        bus_fire(b, 1u << channel, false, pl->now.tick + (uint64_t)(300.0 * c), which);
        break;
    case 1:
        bus_set(b, setting[which % 8], a < 0.5 ? (double)(uint32_t)(8.0 * c) : c);
        break;
    case 2:
        bus_set(b, SETTINGS, pl->si[0] * (1.0 + 0.01 * a));
        break;
    case 3:
        bus_control(b, CONTROL_START + which % 5, c < 0.5 ? (double)(uint32_t)b->app.frame : 3.0);
        break;
    case 4:
        bus_order(b, CONTROL_START);
        break;
    default:
        bus_stream(b, channel, b->app.frame, (a - 0.5) * (c < 0.1 ? 1e3 : 2.0) * unit);
    }
}

/* The controllers of both speak alike; some frames are missed. Returns what app_overrun told differently. */
static int speak(uint32_t i, int turn)
{
    uint32_t kind = any_pick(9), which = any_pick(256), missed = any_pick(40) == 0 ? 1 + any_pick(3) : 0;
    double a = any_between(0.0, 1.0), b = any_between(0.0, 1.0);
    bool enables = any_pick(20) > 0, resets = any_pick(4) == 0, commands = any_pick(2) == 0;
    uint32_t due[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        struct bus *bus = k ? &beside[i] : &alone[i];
        if (turn > 1 && bus->app.state != STATE_RUNNING && resets) {
            bus_order(bus, CONTROL_RESET);
            bus_next_session(bus);
        }
        if (enables)
            bus_enable(bus, true);
        if (turn == 1 || resets)
            bus_order(bus, CONTROL_START);
        if (turn > 1 && commands)
            command(bus, kind, which, a, b);
        if (missed)
            due[k] = app_overrun(&bus->app, missed);
    }
    return due[0] != due[1];
}

/* In their words of this frame, or in what they are. */
static bool differ(const struct bus *a, const struct bus *b)
{
    bool good = a->n_seen == b->n_seen && any_same(&a->app.plant, &b->app.plant);
    good = good && a->app.state == b->app.state && a->app.faults == b->app.faults;
    good = good && memcmp(a->app.count, b->app.count, sizeof a->app.count) == 0;
    for (int i = 0; i < a->n_seen && good; i++)
        good = a->seen[i].kind == b->seen[i].kind && a->seen[i].counter == b->seen[i].counter &&
               memcmp(a->seen[i].value, b->seen[i].value, sizeof a->seen[i].value) == 0;
    return !good;
}

/* Plants that run, pause, stop, lose their client, leave the finite numbers and miss frames at instants of
 * their own. */
TEST(app_beside)
{
    int n_differ = 0, running = 0, faulty = 0, said = 0;
    any_seed = 11;
    for (int farm = 0; farm < FARMS; farm++) {
        uint32_t n = 1 + any_pick(SIDES);
        struct app *app[SIDES] = {NULL};
        for (uint32_t i = 0; i < n; i++) {
            begin_both(i);
            app[i] = &beside[i].app;
        }
        for (int turn = 0; turn < TURNS; turn++) {
            for (uint32_t i = 0; i < n; i++)
                n_differ += speak(i, turn);
            app_frames(app, n, beside_bind);
            for (uint32_t i = 0; i < n; i++) {
                bus_silent(&alone[i], 1);
                bus_collect(&beside[i]);
                n_differ += differ(&alone[i], &beside[i]);
                running += beside[i].app.state == STATE_RUNNING;
                faulty += beside[i].app.faults != 0;
                said += beside[i].n_seen;
                bus_forget(&alone[i]);
                bus_forget(&beside[i]);
            }
        }
    }
    check_int("frames that differ from those alone", n_differ, 0);
    check_above("frames of plants that ran", running, 5000);
    check_above("of plants with a fault", faulty, 300);
    check_above("messages", said, 50000);
}

static uint32_t five_later(void *context)
{
    static uint32_t us;
    (void)context;
    return us += 5;
}

/* Three plants whose frame takes 5 us count 5 us. */
TEST(app_beside_time)
{
    struct app_config c = bus_config();
    struct app *app[3];
    int sum_us = 0;
    c.method = &rk4;
    for (int i = 0; i < 3; i++) {
        bus_start(&beside[i], &c);
        app[i] = &beside[i].app;
    }
    struct hal watched = *app[0]->hal;
    watched.now_us = five_later;
    app[0]->hal = &watched;
    app_frames(app, 3, beside_bind);
    for (int i = 0; i < 3; i++)
        sum_us += (int)app[i]->timing.compute.max_us;
    check_int("microseconds of all three", sum_us, 5);
}
