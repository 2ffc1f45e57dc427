/* test_faults.c - each fault of hal/link/faults.h alone, against what it says it does. */
#include <math.h>
#include <string.h>
#include "firmware/bus/wire.h"
#include "hal/link/faults.h"
#include "hal/link/loopback.h"
#include "host_sim/live/fault_list.h"
#include "tests/unit/test.h"

enum { NEAR, FAR, PORTS, FRAMES = 20000, PER_FRAME = 4 };

static struct loopback_bus wires;
static struct faults faults;

static void begin_alone(const char *list, uint64_t seed)
{
    char why[FAULT_LIST_REASON] = "";
    loopback_init(&wires, PORTS, LOOPBACK_RING);
    faults_init(&faults, &wires.port[NEAR].hal, seed);
    check_true(*list ? list : "no faults", !*list || fault_list_read(&faults, list, 1e-3, why));
}

/* Frame number n as the sender numbered it. */
static struct frame numbered(uint32_t n)
{
    struct frame f = {.id = 0x201, .length = 8};
    memcpy(f.data, &n, sizeof n);
    return f;
}

static uint32_t number_of(const struct frame *f)
{
    uint32_t n;
    memcpy(&n, f->data, sizeof n);
    return n;
}

/* One frame to the near side, then what it gets in this plant frame: numbers and how many. */
static int exchange(uint32_t n, uint32_t got[64])
{
    const struct hal *far = &wires.port[FAR].hal;
    struct frame f = numbered(n), r;
    int n_got = 0;
    if (far->send(far->context, &f) != 1)
        check_true("the bus takes the frame", 0);
    while (n_got < 64 && faults.hal.recv(&faults, &r) == 1)
        got[n_got++] = number_of(&r);
    faults.hal.flush(&faults);
    return n_got;
}

TEST(faults_none)
{
    uint32_t got[64];
    int wrong = 0;
    begin_alone("", 1);
    for (uint32_t n = 0; n < 1000; n++)
        wrong += exchange(n, got) != 1 || got[0] != n;
    check_int("frames in: not as they came", wrong, 0);
    const struct hal *far = &wires.port[FAR].hal;
    for (uint32_t n = 0; n < 200; n++) {
        struct frame f = numbered(n), r = numbered(0);
        wrong += faults.hal.send(&faults, &f) != 1;
        wrong += far->recv(far->context, &r) != 1 || number_of(&r) != n;
    }
    check_int("frames out: not as they went", wrong, 0);
    wires.port[NEAR].fault = HAL_DOWN;
    struct frame r;
    check_int("a fault of the device comes through", faults.hal.recv(&faults, &r), -HAL_DOWN);
    faults.hal.healthy(&faults);
    wires.now_us = 77;
    check_int("so does the clock", faults.hal.now_us(&faults), 77);
    check_int("and the watchdog's feed", wires.port[NEAR].healthy, 1);
}

/* Frames received of FRAMES sent. */
static int received(void)
{
    uint32_t got[64];
    int n = 0;
    for (uint32_t i = 0; i < FRAMES; i++)
        n += exchange(i, got);
    return n;
}

/* Within five standard deviations of a binomial count. */
static void check_binomial(const char *name, double count, double p)
{
    check_near(name, count, FRAMES * p, 5.0 * sqrt(FRAMES * p * (1.0 - p)));
}

TEST(faults_chances)
{
    begin_alone("drop=0.25", 1);
    int n = received();
    check_binomial("drop=0.25: frames lost", FRAMES - n, 0.25);
    check_int("and counted", (int64_t)faults.count[FAULTS_DROP], FRAMES - n);
    begin_alone("duplicate=0.1", 2);
    check_binomial("duplicate=0.1: frames more", received() - FRAMES, 0.1);
    begin_alone("repeat=0.1", 3);
    check_binomial("repeat=0.1: frames more", received() - FRAMES, 0.1);
    begin_alone("out.drop=1", 4);
    check_int("out.drop=1 lets everything in", received(), FRAMES);
    begin_alone("in.drop=1", 4);
    check_int("in.drop=1 lets nothing in", received(), 0);
}

static int changed_bits(const struct frame *a, const struct frame *b)
{
    int n = 0;
    for (int i = 0; i < 8 * a->length; i++)
        n += ((a->data[i / 8] ^ b->data[i / 8]) >> i % 8) & 1;
    return n;
}

/* x^8 + x^4 + x^3 + x^2 + 1 is primitive: up to 247 bits every
 * one or two wrong bits are seen, of three all but 1/255. */
TEST(faults_damage)
{
    const struct wire_scene scene = {.base_id = 0x200};
    const struct message heartbeat = {.kind = WIRE_ENABLE, .counter = 3, .value = {1, 1, 4711}};
    const struct hal *far = &wires.port[FAR].hal;
    struct message m;
    struct frame f, r;
    int seen[4] = {0}, taken[4] = {0}, cut[9] = {0};
    wire_encode(&scene, &heartbeat, &f);
    begin_alone("flip=1", 5);
    for (int i = 0; i < FRAMES; i++) {
        far->send(far->context, &f);
        int n = faults.hal.recv(&faults, &r) == 1 ? changed_bits(&f, &r) : 0;
        seen[n < 4 ? n : 0]++;
        taken[n < 4 ? n : 0] += wire_decode(&scene, &r, &m) == WIRE_OK;
    }
    check_int("flip=1: frames with 1 to 3 wrong bits, or bits hit twice",
              seen[0] + seen[1] + seen[2] + seen[3], FRAMES);
    check_binomial("frames with three wrong bits", seen[3], 1.0 / 3.0 * 63.0 / 64.0 * 62.0 / 64.0);
    check_int("one wrong bit, taken", taken[1], 0);
    check_int("two wrong bits, taken", taken[2], 0);
    check_near("three wrong bits, taken", taken[3], seen[3] / 255.0, 5.0 * sqrt(seen[3] / 255.0));
    begin_alone("truncate=1", 6);
    for (int i = 0; i < FRAMES; i++) {
        far->send(far->context, &f);
        if (faults.hal.recv(&faults, &r) == 1 && r.length <= 8)
            cut[r.length]++;
    }
    check_int("truncate=1: frames left whole", cut[8], 0);
    for (int i = 0; i < 8; i++)
        check_binomial("of each shorter length", cut[i], 1.0 / 8.0);
}

TEST(faults_times)
{
    uint32_t got[64];
    int wrong = 0, n;
    begin_alone("delay=1:7", 7);
    for (uint32_t i = 0; i < 500; i++) {
        n = exchange(i, got);
        wrong += i < 7 ? n != 0 : n != 1 || got[0] != i - 7;
    }
    check_int("delay=1:7: frames that are not 7 late", wrong, 0);
    begin_alone("burst=10", 7);
    for (uint32_t i = 0; i < 500; i++) {
        n = exchange(i, got);
        wrong += n != (i % 10 ? 0 : i ? 10 : 1);
        for (int k = 0; k < n; k++)
            wrong += got[k] != i - (uint32_t)n + 1 + (uint32_t)k;
    }
    check_int("burst=10: not ten at a time in their order", wrong, 0);
    begin_alone("freeze@0.02:0.06", 7);
    for (uint32_t i = 0; i < 100; i++) {
        n = exchange(i, got);
        wrong += n != (i < 20 || i > 60 ? 1 : i < 60 ? 0 : 41);
        wrong += i == 60 && (got[0] != 20 || got[40] != 60);
    }
    check_int("freeze@0.02:0.06: not everything at 0.06", wrong, 0);
    begin_alone("reorder=0.2", 7);
    int after = 0;
    uint32_t last = 0;
    for (uint32_t i = 0; i < FRAMES; i++) {
        n = exchange(i, got);
        for (int k = 0; k < n; k++) {
            after += got[k] < last;
            last = got[k] > last ? got[k] : last;
        }
    }
    check_binomial("reorder=0.2: came after their successor, which did not wait too", after, 0.2 * 0.8);
}

/* Two faults of one frame: neither takes the other back. */
TEST(faults_together)
{
    uint32_t got[64];
    int wrong = 0, n;
    begin_alone("delay=1:7,reorder=1", 7);
    for (uint32_t i = 0; i < 100; i++) {
        n = exchange(i, got);
        wrong += i < 8 ? n != 0 : n != 1 || got[0] != i - 8;
    }
    check_int("delay=1:7,reorder=1: frames that are not 8 late", wrong, 0);
    begin_alone("delay=1:7,duplicate=1", 7);
    for (uint32_t i = 0; i < 100; i++) {
        n = exchange(i, got);
        wrong += i < 7 ? n != 0 : n != 2 || got[0] != i - 7 || got[1] != i - 7;
    }
    check_int("delay=1:7,duplicate=1: frames that are not twice 7 late", wrong, 0);
    begin_alone("delay=1:30,freeze@0.02:0.04", 7);
    for (uint32_t i = 0; i < 100; i++) {
        n = exchange(i, got);
        wrong += i < 30 ? n != 0 : n != 1 || got[0] != i - 30;
    }
    check_int("delay=1:30,freeze@0.02:0.04: frames that are not 30 late", wrong, 0);
    begin_alone("drop=0,drop=0.1@0.01:0.02,drop=1@0.02:0.04,drop=0.1", 7);
    for (uint32_t i = 0; i < 60; i++)
        wrong += exchange(i, got) != 0 && i >= 20 && i < 40;
    check_int("a worse time in a bad link: frames that came in it", wrong, 0);
    begin_alone("freeze@0.02:0.04,freeze@0.03:0.06,burst=5,burst=20", 7);
    static const int every_20[] = {1, 19, 10, 31, 20}; /* frames 0; 1 to 19; 20 to 29; 30 to 60; 61 to 80 */
    for (uint32_t i = 0; i <= 80; i++)
        wrong += exchange(i, got) != (i % 20 ? 0 : every_20[i / 20]);
    check_int("freezes and bursts: not when the longest lets go", wrong, 0);
}

TEST(faults_bus_off)
{
    struct frame f = numbered(1), r;
    uint32_t got[64];
    int n = 0, refused = 0, reports = 0;
    begin_alone("bus-off@0.01:0.02", 8);
    for (uint32_t i = 0; i < 40; i++) {
        int fault = faults.report;
        reports += fault == HAL_BUS_OFF && faults.hal.recv(&faults, &r) == -HAL_BUS_OFF;
        refused += faults.hal.send(&faults, &f) == 0;
        n += exchange(i, got);
    }
    check_int("bus-off told once", reports, 1);
    check_int("sends refused meanwhile", refused, 10);
    check_int("frames in of 40", n, 30);
    check_int("frames in counted as lost", (int64_t)faults.count[FAULTS_BUS_OFF], 10);
}

TEST(faults_refuse)
{
    struct frame f = numbered(1), r;
    const struct hal *far = &wires.port[FAR].hal;
    int taken = 0, arrived = 0;
    begin_alone("refuse=0.5", 9);
    for (int i = 0; i < FRAMES; i++) {
        taken += faults.hal.send(&faults, &f) == 1;
        arrived += far->recv(far->context, &r) == 1;
    }
    check_binomial("refuse=0.5: sends without room", FRAMES - taken, 0.5);
    check_int("what was taken arrives", arrived, taken);
    /* A device without room keeps what was delayed, in order. */
    begin_alone("out.delay=1:2", 9);
    wires.port[NEAR].tx_limit = 1;
    int wrong = 0;
    uint32_t next = 0;
    for (uint32_t i = 0; i < 300; i++) {
        f = numbered(i);
        if (i % 3 == 0)
            wrong += faults.hal.send(&faults, &f) != 1;
        faults.hal.flush(&faults);
        while (far->recv(far->context, &r) == 1) {
            wrong += number_of(&r) != next;
            next += 3;
        }
    }
    check_int("delayed sends: refused, lost or out of order", wrong, 0);
    check_above("delayed sends that arrived", next, 290);
}

/* Everything received over `list`, as one number. */
static uint32_t digest(const char *list, uint64_t seed)
{
    uint32_t got[64], crc = 0;
    begin_alone(list, seed);
    for (uint32_t i = 0; i < 2000; i++) {
        int n = exchange(i, got);
        crc = wire_crc32(crc, (const uint8_t *)got, n * (int)sizeof got[0]);
        crc = wire_crc32(crc, (const uint8_t *)&n, sizeof n);
    }
    return crc;
}

TEST(faults_seed)
{
    static const char all[] =
        "drop=0.1,duplicate=0.1,repeat=0.1,reorder=0.1,delay=0.1:5,truncate=0.1,flip=0.1,freeze@0.5:0.6";
    uint32_t a = digest(all, 42), b = digest(all, 42), c = digest(all, 43);
    check_hex("the same seed hits the same frames", b, a);
    check_is("another seed hits others", a, !=, c);
}

TEST(faults_queue)
{
    uint32_t got[64];
    begin_alone("freeze@0:60", 10);
    for (uint32_t i = 0; i < FAULTS_QUEUE + 100; i++)
        (void)exchange(i, got);
    struct frame r;
    check_int("frames that found the queue full", (int64_t)faults.lost, 100);
    begin_alone("freeze@0:60", 10);
    for (uint32_t i = 0; i < FAULTS_QUEUE; i++)
        (void)exchange(i, got);
    struct frame f = numbered(0);
    wires.port[FAR].hal.send(&wires.port[FAR], &f);
    check_int("the loss is reported", faults.hal.recv(&faults, &r), -HAL_DROPPED);
}

TEST(faults_list)
{
    static const char *const wrong[] = {"drp=1",
                                        "drop",
                                        "drop=",
                                        "drop=2",
                                        "drop=-1",
                                        "drop=nan",
                                        "drop=0.1:3",
                                        "delay=1",
                                        "delay=1:0",
                                        "delay=1:x",
                                        "burst=0",
                                        "burst=1.5",
                                        "burst",
                                        "freeze",
                                        "freeze=1@0:1",
                                        "bus-off",
                                        "freeze@1",
                                        "freeze@2:1",
                                        "freeze@1:1",
                                        "freeze@x:1",
                                        "freeze@0:1e300",
                                        "in.",
                                        "in.out.drop=1",
                                        "in.bus-off@1:2",
                                        "out.bus-off@1:2",
                                        "in.refuse=1",
                                        ",",
                                        "drop=0.1@0:0.0001",
                                        "=1",
                                        "@0:1"};
    char why[FAULT_LIST_REASON];
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        faults_init(&faults, &wires.port[NEAR].hal, 1);
        check_true(wrong[i], !fault_list_read(&faults, wrong[i], 1e-3, why));
    }
    (void)fault_list_read(&faults, "drop=0.1,dely=1:2", 1e-3, why);
    check_string("the nearest name is told", why, "\"dely=1:2\": no such fault; did you mean delay?");
    faults_init(&faults, &wires.port[NEAR].hal, 1);
    check_true("sixteen faults", fault_list_read(&faults,
                                                 "drop=0,drop=0,drop=0,drop=0,drop=0,drop=0,drop=0,drop=0,"
                                                 "drop=0,drop=0,drop=0,drop=0,drop=0,drop=0,drop=0,drop=0",
                                                 1e-3, why));
    check_true("are all there can be", !fault_list_read(&faults, "drop=0", 1e-3, why));
}
