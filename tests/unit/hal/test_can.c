/* test_can.c - the contract of hal.h and can.h, for each CAN driver on a model of its controller: order,
 * bounds, filters, error states, bus-off and recovery. */
#include <string.h>
#include "tests/device/can_device.h"
#include "tests/device/fdcan_model.h"
#include "tests/unit/test.h"

enum { EXTENDED_BASE = 0x18DAF140, MANY = 500 };

static const struct can_device *const devices[] = {&xilinx_device, &sja1000_device, &stm32_fdcan_device};
enum { DEVICES = sizeof devices / sizeof devices[0] };
static const struct can_device *tested;

/* ---- a driver and its wire ---- */

static void begin(int i, bool extended)
{
    struct can_config c = can_device_config;
    c.extended = extended;
    c.base_id = extended ? EXTENDED_BASE : CAN_DEVICE_BASE;
    tested = devices[i];
    *tested->stuck = *tested->promiscuous = false;
    can_device_us = 0xFFFF0000u; /* wraps within the test */
    can_device_check(tested->name, tested->open(&c));
}

static void end(void)
{
    check_int("accesses that the data sheet forbids", *tested->illegal, 0);
}

static int give(uint32_t id, uint8_t first)
{
    struct frame f = {.id = id, .length = 8, .data = {first, 2, 3, 4, 5, 6, 7, 8}};
    f.flags = tested->can->config.extended ? FRAME_EXTENDED : 0;
    return tested->hal->send(tested->hal->context, &f);
}

static int take(struct frame *f)
{
    return tested->hal->recv(tested->hal->context, f);
}

/* Returns the result of recv and drops the frame. */
static int hear(void)
{
    struct frame f;
    return take(&f);
}

static void arrive(uint32_t id, uint8_t first)
{
    struct wire_frame f = {.id = id, .extended = tested->can->config.extended, .dlc = 8, .data = {first}};
    tested->arrive(&f);
}

static uint32_t drain(void)
{
    struct wire_frame f;
    uint32_t n = 0;
    while (n < MANY && tested->leave(&f))
        n++;
    return n;
}

/* ---- frames ---- */

static void check_round_trip(bool extended)
{
    uint32_t base = extended ? EXTENDED_BASE : CAN_DEVICE_BASE;
    struct wire_frame in = {base + 0x2A, extended, false, 5, {1, 2, 3, 4, 0xFE}}, out = {0};
    struct frame got = {0}, answer = {.id = base + 0x15, .length = 3, .data = {0xA0, 0xB1, 0xC2}};
    answer.flags = extended ? FRAME_EXTENDED : 0;
    tested->arrive(&in);
    check_int("a frame arrives", take(&got), 1);
    check_hex("its identifier", got.id, in.id);
    check_int("its format", got.flags, extended ? FRAME_EXTENDED : 0);
    check_int("its length", got.length, 5);
    check_int("its bytes differ in", memcmp(got.data, in.data, 5), 0);
    check_int("then none", take(&got), 0);
    check_int("an answer is taken", tested->hal->send(tested->hal->context, &answer), 1);
    check_int("and leaves", tested->leave(&out), 1);
    check_hex("its identifier on the wire", out.id, answer.id);
    check_int("its format on the wire", out.extended, extended);
    check_int("a data frame", out.remote, false);
    check_int("its length on the wire", out.dlc, 3);
    check_int("its bytes differ in", memcmp(out.data, answer.data, 3), 0);
    check_int("and no second", tested->leave(&out), 0);
}

static int64_t count_disorder(void)
{
    int64_t wrong = 0;
    struct frame f;
    struct wire_frame w;
    for (uint32_t i = 0; i < MANY; i++) { /* many times around every ring */
        arrive(CAN_DEVICE_BASE + i % 16, (uint8_t)i);
        wrong += give(CAN_DEVICE_BASE + 0x10 + i % 16, (uint8_t)i) != 1;
        if (i % 3 < 2)
            wrong += !tested->leave(&w);
        while (i % 3 == 2 && tested->leave(&w))
            wrong += w.data[0] > (uint8_t)i && i > 255;
        wrong += take(&f) != 1 || f.data[0] != (uint8_t)i;
    }
    return wrong;
}

/* After a flush nothing that was taken waits in the driver: each
 * time the wire takes a frame, the next one is in the controller. */
TEST(can_flush)
{
    for (int i = 0; i < DEVICES; i++) {
        struct wire_frame w;
        uint32_t taken = 0, left = 0;
        begin(i, false);
        while (taken < tested->tx_depth && give(CAN_DEVICE_BASE + 0x10, (uint8_t)taken) == 1)
            taken++;
        check_is("frames wait to be sent", taken, >, 1);
        for (tested->hal->flush(tested->hal->context); left < MANY && tested->leave(&w);
             tested->hal->flush(tested->hal->context)) {
            check_int("in their order", w.data[0], (uint8_t)left);
            left++;
        }
        check_int("all leave, and no other", left, taken);
        end();
    }
}

TEST(can_frames)
{
    for (int i = 0; i < DEVICES; i++) {
        begin(i, false);
        check_round_trip(false);
        check_int("frames wrong or out of order", count_disorder(), 0);
        check_int("received", tested->can->received, 1 + MANY);
        check_int("nothing passed over", tested->can->passed_over, 0);
        end();
        begin(i, true);
        check_round_trip(true);
        end();
    }
}

/* ---- filters ---- */

/* Counts the 11-bit identifiers that come through to the hal, as data and remote frames. */
static void sweep(uint32_t *ours, uint32_t *others, bool extended)
{
    *ours = *others = 0;
    for (uint32_t id = 0; id < 0x800; id++)
        for (int remote = 0; remote < 2; remote++) {
            struct wire_frame f = {extended ? EXTENDED_BASE - 0x400 + id : id, extended, remote, 8, {0x55}};
            bool ok = !remote && f.id - tested->can->config.base_id < 64;
            tested->arrive(&f);
            *(ok ? ours : others) += hear() == 1;
        }
}

TEST(can_filter)
{
    uint32_t ours, others;
    for (int i = 0; i < 2 * DEVICES; i++) {
        bool extended = i >= DEVICES;
        begin(i % DEVICES, extended);
        sweep(&ours, &others, extended);
        check_int("identifiers of the plant that come through", ours, 64);
        check_int("others, and remote frames", others, 0);
        check_int("and none was left to the driver", tested->can->passed_over, 0);
        sweep(&ours, &others, !extended);
        check_int("frames of the other format that come through", ours + others, 0);
        *tested->promiscuous = true;
        sweep(&ours, &others, extended);
        check_int("without a filter the driver finds ours", ours, 64);
        check_int("and passes over the rest", others, 0);
        check_above("which it counts", tested->can->passed_over, 2 * 0x800 - 64);
        tested->arrive(
            &(struct wire_frame){.id = tested->can->config.base_id, .extended = !extended, .dlc = 8});
        check_int("the same number in the other format is none of ours", hear(), 0);
        end();
    }
}

/* ---- bounds ---- */

TEST(can_transmit_full)
{
    for (int i = 0; i < DEVICES; i++) {
        struct wire_frame w = {0};
        uint32_t taken = 0, wrong = 0, n = 0;
        begin(i, false);
        for (uint32_t k = 0; k < MANY; k++)
            taken += give(CAN_DEVICE_BASE + 0x10, (uint8_t)taken) == 1;
        check_int("frames taken while none goes out", taken, tested->tx_depth);
        check_int("the others are refused", tested->can->refused, MANY - taken);
        while (n < MANY && tested->leave(&w))
            wrong += w.data[0] != (uint8_t)n++;
        check_int("those taken go out", n, taken);
        check_int("in order: wrong ones", wrong, 0);
        check_int("then there is room again", give(CAN_DEVICE_BASE, 1), 1);
        check_int("sent", tested->can->sent, taken + 1);
        end();
    }
}

TEST(can_receive_overrun)
{
    for (int i = 0; i < DEVICES; i++) {
        uint32_t got = 0;
        int said;
        begin(i, false);
        for (uint32_t k = 0; k < tested->rx_depth + 3; k++)
            arrive(CAN_DEVICE_BASE + 1, (uint8_t)k);
        while ((said = hear()) == 1)
            got++;
        check_int("the oldest are kept", got, tested->rx_depth);
        check_int("then the loss is reported", said, -HAL_DROPPED);
        check_int("and counted", tested->can->dropped, 1);
        check_int("once", hear(), 0);
        arrive(CAN_DEVICE_BASE + 1, 9);
        check_int("reception goes on", hear(), 1);
        end();
    }
}

TEST(can_hostile_frames)
{
    for (int i = 0; i < DEVICES; i++) {
        begin(i, false);
        for (uint8_t dlc = 9; dlc < 16; dlc++) {
            struct wire_frame f = {CAN_DEVICE_BASE + 2, false, false, dlc, {1, 2, 3, 4, 5, 6, 7, 8}};
            struct frame got = {0};
            tested->arrive(&f);
            check_int("a data length above 8 arrives", take(&got), 1);
            check_int("and means 8", got.length, 8);
            check_int("its bytes differ in", memcmp(got.data, f.data, 8), 0);
        }
        struct wire_frame empty = {CAN_DEVICE_BASE + 3, false, false, 0, {0}};
        struct frame got = {.length = 7};
        tested->arrive(&empty);
        check_int("an empty frame arrives", take(&got), 1);
        check_int("with its length", got.length, 0);
        *tested->promiscuous = true;
        for (int k = 0; k < 200; k++) {
            struct wire_frame remote = {CAN_DEVICE_BASE + 4, false, true, 8, {0}};
            tested->arrive(&remote);
            if (k % 3 == 0)
                check_int("remote frames in between", hear(), 0);
        }
        arrive(CAN_DEVICE_BASE + 5, 0);
        hear();
        end();
    }
}

/* ---- error states ---- */

TEST(can_error_states)
{
    for (int i = 0; i < DEVICES; i++) {
        begin(i, false);
        tested->errors(95, 0);
        check_int("95 errors are nothing", hear(), 0);
        tested->errors(96, 0);
        check_int("96 are reported", hear(), -HAL_ERROR_PASSIVE);
        check_int("as warning", tested->can->state, CAN_WARNING);
        check_int("with the count", tested->can->transmit_errors, 96);
        check_int("once", hear(), 0);
        arrive(CAN_DEVICE_BASE, 1);
        tested->errors(97, 128);
        check_int("frames come first", hear(), 1);
        check_int("128 are reported", hear(), -HAL_ERROR_PASSIVE);
        check_int("as passive", tested->can->state, CAN_PASSIVE);
        check_int("with the count", tested->can->receive_errors, 128);
        check_int("sending goes on", give(CAN_DEVICE_BASE + 0x10, 1), 1);
        tested->errors(128, 0);
        check_int("the other counter alone keeps it so", hear(), 0);
        check_int("passive", tested->can->state, CAN_PASSIVE);
        tested->errors(0, 0);
        check_int("recovery is silent", hear(), 0);
        check_int("active", tested->can->state, CAN_ACTIVE);
        tested->errors(0, 100);
        check_int("and the next rise is reported", hear(), -HAL_ERROR_PASSIVE);
        check_int("rises", tested->can->passive, 3);
        end();
    }
}

static void check_outage(int fault)
{
    for (int k = 0; k < 5; k++)
        check_int("frames wait", give(CAN_DEVICE_BASE + 0x10, (uint8_t)k), 1);
    (fault == HAL_BUS_OFF ? tested->errors(256, 0) : tested->upset());
    give(CAN_DEVICE_BASE + 0x11, 0); /* before anybody has looked */
    check_int("the outage is reported", hear(), -fault);
    check_int("once", hear(), 0);
    check_int("nothing is taken meanwhile", give(CAN_DEVICE_BASE + 0x10, 9), 0);
    can_device_us += CAN_DEVICE_RESTART_US - 1;
    check_int("silence until the restart", hear(), 0);
    check_int("restarts", tested->can->restarted, 0);
    can_device_us += 1;
    check_int("restarting", hear(), 0);
    check_int("restarts", tested->can->restarted, 1);
    tested->idle();
    check_int("back on the bus", hear() + hear() + hear(), 0);
    check_int("active", tested->can->state, CAN_ACTIVE);
    check_int("nothing from before goes out", drain(), 0);
    check_int("what is new does", give(CAN_DEVICE_BASE + 0x12, 7), 1);
    struct wire_frame w = {0};
    check_int("to the wire", tested->leave(&w), 1);
    check_hex("as it is", w.id, CAN_DEVICE_BASE + 0x12);
    arrive(CAN_DEVICE_BASE + 1, 0);
    check_int("and reception too", hear(), 1);
    tested->arrive(&(struct wire_frame){.id = CAN_DEVICE_BASE - 1, .dlc = 8});
    check_int("with its filter", hear(), 0);
    check_int("in the controller", tested->can->passed_over, 0);
}

TEST(can_bus_off)
{
    for (int i = 0; i < DEVICES; i++) {
        begin(i, false);
        check_outage(HAL_BUS_OFF);
        check_int("bus-offs", tested->can->bus_off, 1);
        tested->errors(256, 0);
        check_int("a second one is reported too", hear(), -HAL_BUS_OFF);
        end();
    }
}

TEST(can_stays_off)
{
    struct can_config c = can_device_config;
    c.restart_us = 0;
    for (int i = 0; i < DEVICES; i++) {
        begin(i, false);
        can_device_check("without a restart time", tested->open(&c));
        tested->errors(256, 0);
        check_int("bus-off is reported", hear(), -HAL_BUS_OFF);
        for (int k = 0; k < 10; k++) {
            can_device_us += 1000000000;
            tested->idle();
            check_int("and stays", hear(), 0);
            check_int("nothing is taken", give(CAN_DEVICE_BASE, 0), 0);
        }
        check_int("restarts", tested->can->restarted, 0);
        end();
    }
}

/* A controller that loses its configuration, by a glitch of its supply: it must not stay deaf. */
TEST(can_upset)
{
    for (int i = 0; i < DEVICES; i++) {
        begin(i, false);
        check_outage(HAL_DOWN);
        check_int("outages", tested->can->down, 1);
        end();
    }
}

TEST(can_stuck)
{
    for (int i = 0; i < DEVICES; i++) {
        tested = devices[i];
        *tested->stuck = true;
        const char *why = tested->open(&can_device_config);
        check_true("a controller that does not change its mode is told", why != NULL || hear() == -HAL_DOWN);
        begin(i, false);
        tested->errors(256, 0);
        check_int("bus-off", hear(), -HAL_BUS_OFF);
        *tested->stuck = true; /* it does not come out of it */
        for (int k = 0; k < 3; k++) {
            can_device_us += CAN_DEVICE_RESTART_US;
            check_below("tries do not fail loudly", hear(), 0);
        }
        check_int("nothing is taken", give(CAN_DEVICE_BASE, 0), 0);
        *tested->stuck = false;
        can_device_us += CAN_DEVICE_RESTART_US;
        hear();
        tested->idle();
        hear();
        hear();
        check_int("once it can, it comes back", give(CAN_DEVICE_BASE, 0), 1);
    }
}

static void check_refused(struct can_config c, const char *name)
{
    const char *why = tested->open(&c);
    check_error(name, why);
}

TEST(can_refuses_configuration)
{
    for (int i = 0; i < DEVICES; i++) {
        struct can_config c = can_device_config;
        begin(i, false);
        c.base_id = CAN_DEVICE_BASE + 1;
        check_refused(c, "a base that is no multiple of 0x40");
        c.base_id = 0x800;
        check_refused(c, "a base of more than 11 bits");
        c = can_device_config;
        c.timing.prescaler = 0;
        check_refused(c, "prescaler 0");
        c.timing.prescaler = 513;
        check_refused(c, "prescaler 513");
        c = can_device_config;
        c.timing.segment2 = 129;
        check_refused(c, "segment 2 of 129 quanta");
        c = can_device_config;
        c.timing.segment2 = 0;
        check_refused(c, "no segment 2");
        c = can_device_config;
        c.timing.jump = 3;
        check_refused(c, "a jump longer than segment 2");
        can_device_check("and a good one is taken", tested->open(&can_device_config));
    }
}
