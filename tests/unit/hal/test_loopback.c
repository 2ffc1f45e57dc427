/* test_loopback.c - the in-process bus keeps order, bounds and its word about losses. */
#include "hal/link/loopback.h"
#include "tests/unit/test.h"

static struct loopback_bus bus;

static int give(int port, uint32_t id)
{
    struct frame f = {.id = id, .length = 1, .data = {(uint8_t)id}};
    return bus.port[port].hal.send(bus.port[port].hal.context, &f);
}

/* The identifier that arrived, or what recv said. */
static int64_t take(int port)
{
    struct frame f;
    int got = bus.port[port].hal.recv(bus.port[port].hal.context, &f);
    return got > 0 ? (int64_t)f.id : got;
}

TEST(loopback_order)
{
    loopback_init(&bus, 3, 8);
    give(0, 0x10);
    give(1, 0x11);
    give(0, 0x12);
    check_int("port 2 hears the first", take(2), 0x10);
    check_int("port 2 hears the second", take(2), 0x11);
    check_int("port 2 hears the third", take(2), 0x12);
    check_int("port 2 hears no more", take(2), 0);
    check_int("port 0 hears only the other", take(0), 0x11);
    check_int("port 0 does not hear itself", take(0), 0);
    check_int("port 1 hears port 0", take(1), 0x10);
    int64_t wrong = 0;
    take(1);
    for (uint32_t i = 1; i < 2000; i++) { /* many times around the ring */
        give(0, i);
        wrong += take(1) != (int64_t)i;
        take(2);
    }
    check_int("frames out of order in 2000", wrong, 0);
    bus.now_us = 0xFFFFFFFFu;
    check_int("the clock is the test's", bus.port[2].hal.now_us(bus.port[2].hal.context), 0xFFFFFFFF);
    bus.port[2].hal.healthy(bus.port[2].hal.context);
    check_int("healthy is counted", bus.port[2].healthy, 1);
}

TEST(loopback_full)
{
    loopback_init(&bus, 2, 4);
    for (uint32_t i = 1; i <= 6; i++)
        check_int("a deaf receiver does not stop the sender", give(0, i), 1);
    for (int64_t i = 1; i <= 4; i++)
        check_int("the oldest are kept", take(1), i);
    check_int("then the loss is reported", take(1), -HAL_DROPPED);
    check_int("once", take(1), 0);
    bus.port[0].tx_limit = 2;
    bus.port[0].hal.flush(bus.port[0].hal.context);
    check_int("first of two", give(0, 1), 1);
    check_int("second of two", give(0, 2), 1);
    check_int("no room until flush", give(0, 3), 0);
    bus.port[0].hal.flush(bus.port[0].hal.context);
    check_int("room again", give(0, 4), 1);
    check_int("the refused one never arrives", take(1) * 100 + take(1) * 10 + take(1), 124);
    bus.port[1].fault = HAL_BUS_OFF | HAL_DOWN;
    check_int("a fault set by the test", take(1), -(HAL_BUS_OFF | HAL_DOWN));
    check_int("is reported once", take(1), 0);
}
