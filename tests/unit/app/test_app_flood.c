/* test_app_flood.c - floods from a queue in memory: STOP and heartbeats get through, all else is dropped and
 * counted, and nothing from before a STOP acts after it. */
#include <string.h>
#include "tests/fixture/bus.h"
#include "tests/fixture/silent_bus.h"
#include "tests/unit/test.h"

enum { QUEUE = 1 << 18, BEHIND = 100000, KINDS = 15 };

/* A hal with one queue, as that of a kernel or a controller. */
static struct queue {
    struct frame frame[QUEUE];
    int first, n;
    uint64_t given;
} queue;

static int take(void *context, struct frame *f)
{
    struct queue *q = context;
    if (q->first == q->n)
        return 0;
    *f = q->frame[q->first++];
    return 1;
}

static const struct hal hal = {&queue, take, silent_send, silent_nothing, silent_clock, silent_nothing};
static struct bus bus; /* its controller's counters and encoder; its wires are not used after the start */

static void put(const struct frame *f)
{
    if (queue.first == queue.n)
        queue.first = queue.n = 0;
    if (queue.n < QUEUE)
        queue.frame[queue.n++] = *f;
    queue.given++;
}

static void put_command(unsigned kind, const double value[WIRE_FIELDS])
{
    struct frame f;
    bus_encode(&bus, kind, value, &f);
    put(&f);
}

static void put_control(enum control_operation operation)
{
    put_command(WIRE_CONTROL,
                (double[WIRE_FIELDS]){0, operation, 255 - (int)operation, (double)(uint32_t)bus.app.frame});
}

static void put_heartbeat(void)
{
    put_command(WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, (double)(uint32_t)bus.app.frame});
}

/* Commands of all kinds whose checksum is wrong: the costliest that are refused. */
static void put_flood(int n)
{
    for (int i = 0; i < n; i++) {
        struct message m = {.kind = (uint8_t)(i % KINDS), .counter = (uint8_t)(i % WIRE_COUNTER_STATES)};
        struct frame f;
        wire_encode(&bus.scene, &m, &f);
        f.data[0] ^= 0x55;
        put(&f);
    }
}

static void flood_start(void)
{
    bus_start_rig(&bus);
    bus_run(&bus, 2);
    queue.first = queue.n = 0;
    queue.given = bus.app.count[DIAG_FRAMES_RECEIVED];
    bus.app.hal = &hal;
}

static int frames_until_stopped(void)
{
    int n = 0;
    while (bus.app.state != STATE_STOPPED && n < 1000) {
        app_frame(&bus.app);
        n++;
    }
    return n;
}

static void check_account(void)
{
    check_int("received + dropped in the flood, of all that was given",
              (int64_t)bus.app.count[DIAG_FRAMES_RECEIVED] + bus.app.count[DIAG_RX_FLOOD],
              (int64_t)queue.given - (queue.n - queue.first));
}

/* A STOP behind a hundred thousand frames, and behind the flood of each frame. */
TEST(app_flood_stop)
{
    flood_start();
    put_flood(BEHIND);
    put_control(CONTROL_STOP);
    check_below("frames until a STOP behind 100000 others acts", frames_until_stopped(), 2);
    check_int("what waits then", queue.n - queue.first, 0);
    check_account();
    flood_start();
    int latest = 0;
    for (int i = 0; i < 50; i++) {
        put_flood(2000);
        put_heartbeat();
        app_frame(&bus.app);
        put_flood(100 * i);
        put_control(CONTROL_STOP);
        put_flood(2000);
        int n = frames_until_stopped();
        latest = n > latest ? n : latest;
        put_control(CONTROL_START);
        app_frame(&bus.app);
        app_frame(&bus.app);
        queue.given -= (uint64_t)(queue.n - queue.first);
        queue.first = queue.n = 0;
    }
    check_below("frames until each of 50 STOPs amid a flood acts", latest, 2);
    check_account();
}

/* Whatever stands before a STOP that overtakes it is dropped; frames of the queue's head act before it. */
TEST(app_flood_order)
{
    int acted = 0;
    for (int before = 0; before < 3000; before += 61) {
        flood_start();
        put_flood(1000);
        app_frame(&bus.app); /* crowded */
        put_flood(before);
        put_command(WIRE_ARM, (double[WIRE_FIELDS]){0, ARM_AMPLITUDE, 5.0});
        put_control(CONTROL_START);
        put_control(CONTROL_STOP);
        put_flood(1000);
        for (int i = 0; i < 5; i++)
            app_frame(&bus.app);
        acted += bus.app.state != STATE_STOPPED || queue.n != queue.first;
        acted += bus.app.mailbox.armed[0].given != 0;
    }
    check_int("queues after which the plant ran on, or something was armed or still waited", acted, 0);
}

/* A STOP in the other frame format is no message of this plant: amid a flood it does not act, either. */
TEST(app_flood_other_format)
{
    struct frame f;
    flood_start();
    put_flood(2000);
    bus_encode(&bus, WIRE_CONTROL,
               (double[WIRE_FIELDS]){0, CONTROL_STOP, 255 - CONTROL_STOP, (double)(uint32_t)bus.app.frame},
               &f);
    f.flags |= FRAME_EXTENDED;
    put(&f);
    put_flood(1000);
    for (int i = 0; i < 20; i++)
        app_frame(&bus.app);
    check_int("still runs", bus.app.state, STATE_RUNNING);
    put_control(CONTROL_STOP);
    check_below("frames until a STOP in this plant's format acts", frames_until_stopped(), 2);
}

/* Heartbeats behind the flood keep the session, and a new one can be had amid it. */
TEST(app_flood_session)
{
    flood_start();
    for (int i = 0; i < 1000; i++) {
        put_flood(1500);
        put_heartbeat();
        app_frame(&bus.app);
    }
    check_int("time-outs in 1000 frames of flood", bus.app.count[DIAG_TIMEOUTS], 0);
    check_int("the session is there", bus.app.enabled, 1);
    check_account();
    for (int i = 0; i < 200; i++) {
        put_flood(1500);
        app_frame(&bus.app);
    }
    check_int("without heartbeats it ends", bus.app.enabled, 0);
    bus.session = 2;
    memset(bus.counter, 0, sizeof bus.counter);
    put_flood(1500);
    put_heartbeat();
    app_frame(&bus.app);
    check_int("a new one is opened in the frame of its ENABLE", bus.app.enabled && bus.app.session == 2, 1);
    check_account();
}

/* A flood of good ENABLEs of somebody else's session is not answered frame by frame. */
TEST(app_flood_replies)
{
    flood_start();
    uint8_t ours = bus.session;
    bus.session = 9;
    for (int i = 0; i < 20000; i++)
        put_heartbeat();
    bus.session = ours;
    put_control(CONTROL_STOP);
    check_below("frames until a STOP behind them acts", frames_until_stopped(), 2);
    check_int("refused for their session", bus.app.count[DIAG_SESSION], 2 * APP_RECV_BUDGET);
    check_account();
}

/* A burst within twice the bound is no flood: nothing is dropped, and all of it acts in order. */
TEST(app_flood_burst)
{
    flood_start();
    for (int i = 0; i < 2 * APP_RECV_BUDGET - 1; i++)
        put_command(WIRE_ARM, (double[WIRE_FIELDS]){0, ARM_AMPLITUDE, i});
    app_frame(&bus.app);
    check_near("the last of the first frame", bus.app.mailbox.armed[0].value[0], APP_RECV_BUDGET - 1, 0.0);
    app_frame(&bus.app);
    check_near("the last of all in the second", bus.app.mailbox.armed[0].value[0], 2 * APP_RECV_BUDGET - 2,
               0.0);
    check_int("dropped", bus.app.count[DIAG_RX_FLOOD], 0);
    check_account();
}

/* The head of a flood, which leaves no place for a frame behind it but by overtaking. */
static void crowd(void)
{
    put_flood(APP_RECV_BUDGET);
    app_frame(&bus.app);
    put_flood(APP_RECV_BUDGET);
}

/* Old ENABLEs, told again, do not take the place of the living controller's. */
TEST(app_flood_stale_enable)
{
    flood_start();
    for (int i = 0; i < 200; i++)
        app_frame(&bus.app), put_heartbeat();
    for (int i = 0; i < 300; i++) {
        crowd();
        put_command(WIRE_ENABLE, (double[WIRE_FIELDS]){0, 1, (double)(uint32_t)(bus.app.frame - 150)});
        put_heartbeat();
        app_frame(&bus.app);
    }
    check_int("time-outs in 600 frames", bus.app.count[DIAG_TIMEOUTS], 0);
    check_int("refused as old", bus.app.count[DIAG_STALE], 0);
}

/* The first STOP and the first ENABLE behind the bound are taken, for the work of a frame is bounded. */
TEST(app_flood_first)
{
    flood_start();
    crowd();
    uint32_t before = bus.app.count[DIAG_FRAMES_RECEIVED];
    for (int i = 0; i < 1000; i++)
        put_heartbeat();
    for (int i = 0; i < 1000; i++)
        put_control(CONTROL_STOP);
    app_frame(&bus.app);
    check_int("taken behind the bound", bus.app.count[DIAG_FRAMES_RECEIVED] - before - APP_RECV_BUDGET, 2);
    check_int("stopped", bus.app.state, STATE_STOPPED);
    check_account();
}

/* Frames of the other format are none of this plant's, so a flood of them drops none of its own. */
TEST(app_flood_foreign)
{
    flood_start();
    uint32_t before = bus.app.count[DIAG_FRAMES_RECEIVED];
    for (int i = 0; i < 3000; i++) {
        struct frame f;
        bus_encode(&bus, WIRE_ARM, (double[WIRE_FIELDS]){0, ARM_AMPLITUDE, i}, &f);
        f.flags |= FRAME_EXTENDED;
        put(&f);
    }
    for (int i = 0; i < 4; i++)
        app_frame(&bus.app);
    check_above("frames in which the bound was reached", bus.app.count[DIAG_RX_BUDGET], 1);
    check_int("dropped in the flood", bus.app.count[DIAG_RX_FLOOD], 0);
    check_int("received", bus.app.count[DIAG_FRAMES_RECEIVED] - before, 0);
}
