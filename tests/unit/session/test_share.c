/* test_share.c - one bus for many plants: who gets which
 * frame, what a flood does, and plants beside each other. */
#include "firmware/app/app.h"
#include "firmware/plant/plant_report.h"
#include "hal/link/loopback.h"
#include "hal/link/share.h"
#include "host_sim/beside/beside.h"
#include "tests/fixture/bus.h"
#include "tests/unit/test.h"

enum { OURS, THEIRS, PORTS, PLANTS = 8, BASE = 0x200, URGENT = 3 };

static struct loopback_bus wires;
static struct share share;
static struct share_part part[PLANTS];

static void begin_share(uint32_t n, uint8_t flags)
{
    loopback_init(&wires, PORTS, LOOPBACK_RING);
    share_init(&share, &wires.port[OURS].hal, part, n, BASE, flags, URGENT);
}

static void put(uint32_t id, uint8_t flags, uint8_t mark)
{
    const struct frame f = {.id = id, .length = 8, .flags = flags, .data = {mark}};
    const struct hal *hal = &wires.port[THEIRS].hal;
    if (hal->send(hal->context, &f) != 1)
        check_true("the bus takes the frame", 0);
}

/* Empties a plant's queue: how many frames, the first and last mark, and the faults. */
static int take(uint32_t i, int *first, int *last, int *faults)
{
    struct frame f;
    int n = 0, got;
    *faults = 0;
    *first = *last = -1;
    while ((got = part[i].hal.recv(part[i].hal.context, &f)) != 0) {
        *faults |= got < 0 ? -got : 0;
        *first = got > 0 && *first < 0 ? f.data[0] : *first;
        *last = got > 0 ? f.data[0] : *last;
        n += got > 0;
    }
    return n;
}

TEST(share_by_identifier)
{
    int first, last, faults;
    begin_share(PLANTS, 0);
    put(BASE, 0, 1);                          /* the first identifier of plant 0 */
    put(BASE + FRAME_IDS - 1, 0, 2);          /* its last */
    put(BASE + FRAME_IDS, 0, 3);              /* the first of plant 1 */
    put(BASE + PLANTS * FRAME_IDS - 1, 0, 4); /* the last of all */
    put(BASE - 1, 0, 5);                      /* nobody's: below, above, and of 29 bits */
    put(BASE + PLANTS * FRAME_IDS, 0, 6);
    put(BASE + FRAME_IDS, FRAME_EXTENDED, 7);
    share_collect(&share);
    check_int("plant 0: frames", take(0, &first, &last, &faults), 2);
    check_int("plant 0: in order", first * 10 + last, 12);
    check_int("plant 1: frames", take(1, &first, &last, &faults), 1);
    check_int("plant 1: its own", first, 3);
    check_int("plant 7: frames", take(PLANTS - 1, &first, &last, &faults), 1);
    check_int("plant 7: its own", first, 4);
    for (uint32_t i = 2; i < PLANTS - 1; i++)
        check_int("the others: none", take(i, &first, &last, &faults), 0);
    check_int("no fault", faults, 0);
}

TEST(share_faults_reach_all)
{
    int first, last, faults;
    begin_share(PLANTS, 0);
    wires.port[OURS].fault = HAL_BUS_OFF;
    put(BASE + 2 * FRAME_IDS, 0, 1);
    share_collect(&share);
    for (uint32_t i = 0; i < PLANTS; i++) {
        check_int("frames", take(i, &first, &last, &faults), i == 2);
        check_int("the bus's fault", faults, HAL_BUS_OFF);
        (void)take(i, &first, &last, &faults);
        check_int("once", faults, 0);
    }
}

/* A flood for plant 1: it alone loses frames, the newest ones, and a late STOP is there. */
TEST(share_flood)
{
    enum { FLOOD = SHARE_QUEUE + 40, STOP_ID = 2, STREAM_ID = 4, STOP_MARK = 99 };
    int first, last, faults;
    begin_share(PLANTS, 0);
    for (int i = 0; i < FLOOD; i++)
        put(BASE + FRAME_IDS + STREAM_ID, 0, 1);
    put(BASE + FRAME_IDS + STOP_ID, 0, STOP_MARK);
    put(BASE + 2 * FRAME_IDS + STREAM_ID, 0, 2);
    share_collect(&share);
    check_int("the flooded plant: frames", take(1, &first, &last, &faults), SHARE_QUEUE + 1);
    check_int("with the urgent one at the end", last, STOP_MARK);
    check_int("it hears that frames were lost", faults, HAL_DROPPED);
    check_int("its neighbour: frames", take(2, &first, &last, &faults), 1);
    check_int("and lost nothing", faults, 0);
    for (int i = 0; i < SHARE_URGENT + 1; i++)
        put(BASE + FRAME_IDS + STOP_ID, 0, (uint8_t)i);
    share_collect(&share);
    check_int("room again: frames", take(1, &first, &last, &faults), SHARE_URGENT + 1);
    for (int i = 0; i < SHARE_QUEUE + SHARE_URGENT + 1; i++)
        put(BASE + FRAME_IDS + STOP_ID, 0, 0);
    share_collect(&share);
    check_int("the urgent places are bounded", take(1, &first, &last, &faults), SHARE_QUEUE + SHARE_URGENT);
    check_int("which is heard, too", faults, HAL_DROPPED);
}

/* Sends a command of plant i in session 1, as a good controller would. */
static void share_command(uint32_t i, unsigned kind, uint8_t counter, double first, double second,
                          double third)
{
    const struct wire_scene scene = {.base_id = BASE + i * FRAME_IDS};
    const struct message m = {.kind = (uint8_t)kind, .counter = counter, .value = {1, first, second, third}};
    const struct hal *hal = &wires.port[THEIRS].hal;
    struct frame f;
    wire_encode(&scene, &m, &f);
    if (hal->send(hal->context, &f) != 1)
        check_true("the bus takes the command", 0);
}

/* One frame of the first n plants; the far side reads its ring empty. */
static void frame_of_shares(struct app *app, uint32_t n)
{
    struct frame f;
    share_collect(&share);
    struct app *together[PLANTS] = {NULL};
    for (uint32_t i = 0; i < n; i++)
        together[i] = &app[i];
    app_frames(together, n, beside_bind);
    share_flush(&share);
    while (wires.port[THEIRS].hal.recv(wires.port[THEIRS].hal.context, &f))
        continue;
}

enum { SHARE_FRAMES = 60, STOP_AT = 30 };

/* n plants, each in a session of its own with a sample in each frame; one is told to stop. */
static void run(struct app *app, uint32_t n, uint32_t stopped)
{
    struct app_config c = bus_config();
    begin_share(n, 0);
    for (uint32_t i = 0; i < n; i++) {
        c.base_id = BASE + i * FRAME_IDS;
        check_no_error("a plant begins", app_init(&app[i], &c, &part[i].hal));
    }
    for (uint8_t now = 0; now < SHARE_FRAMES; now++) {
        for (uint32_t i = 0; i < n; i++) {
            if (i == stopped && now > STOP_AT)
                continue;
            share_command(i, WIRE_ENABLE, now % WIRE_COUNTER_STATES, 1.0, now, 0.0);
            if (now == 1)
                share_command(i, WIRE_CONTROL, 0, CONTROL_START, 0xFF - CONTROL_START, now);
            if (now > 1)
                share_command(i, WIRE_STREAM, now % WIRE_COUNTER_STATES, now, now % 7 - 3.0, 0.0);
            if (now == STOP_AT && i == stopped)
                share_command(i, WIRE_CONTROL, 1, CONTROL_STOP, 0xFF - CONTROL_STOP, 0.0);
        }
        frame_of_shares(app, n);
    }
}

/* Eight apps on one bus: the stop of one leaves the others
 * as they are. They have the bits of a plant that is alone. */
TEST(share_plants)
{
    enum { STOPPED = 3, NOBODY = PLANTS };
    static struct app app[PLANTS], alone;
    run(&alone, 1, NOBODY);
    check_int("alone it runs", alone.state, STATE_RUNNING);
    check_int("with each sample", (int64_t)alone.count[DIAG_LATE], 0);
    run(app, PLANTS, STOPPED);
    check_int("the watchdog is fed once a frame", (int)wires.port[OURS].healthy, SHARE_FRAMES);
    check_int("the stopped one", app[STOPPED].state, STATE_STOPPED);
    for (uint32_t i = 0; i < PLANTS; i++) {
        bool equal = plant_hash(&app[i].plant) == plant_hash(&alone.plant);
        check_true(i == STOPPED ? "the stopped one's bits differ" : "the bits of one that is alone",
                   equal == (i != STOPPED));
        if (i != STOPPED)
            check_int("runs on", app[i].state, STATE_RUNNING);
    }
}
