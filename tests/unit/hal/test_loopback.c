/* test_loopback.c - the in-process bus keeps order, bounds and its word about losses. */
#include "hal/link/loopback.h"
#include "tests/unit/test.h"

static struct loopback_bus loopback;

static int port_give(int port, uint32_t id)
{
    struct frame f = {.id = id, .length = 1, .data = {(uint8_t)id}};
    return loopback.port[port].hal.send(loopback.port[port].hal.context, &f);
}

/* The identifier that arrived, or what recv said. */
static int64_t port_take(int port)
{
    struct frame f;
    int got = loopback.port[port].hal.recv(loopback.port[port].hal.context, &f);
    return got > 0 ? (int64_t)f.id : got;
}

TEST(loopback_order)
{
    loopback_init(&loopback, 3, 8);
    port_give(0, 0x10);
    port_give(1, 0x11);
    port_give(0, 0x12);
    check_int("port 2 hears the first", port_take(2), 0x10);
    check_int("port 2 hears the second", port_take(2), 0x11);
    check_int("port 2 hears the third", port_take(2), 0x12);
    check_int("port 2 hears no more", port_take(2), 0);
    check_int("port 0 hears only the other", port_take(0), 0x11);
    check_int("port 0 does not hear itself", port_take(0), 0);
    check_int("port 1 hears port 0", port_take(1), 0x10);
    int64_t wrong = 0;
    port_take(1);
    for (uint32_t i = 1; i < 2000; i++) { /* many times around the ring */
        port_give(0, i);
        wrong += port_take(1) != (int64_t)i;
        port_take(2);
    }
    check_int("frames out of order in 2000", wrong, 0);
    loopback.now_us = 0xFFFFFFFFu;
    check_int("the clock is the test's", loopback.port[2].hal.now_us(loopback.port[2].hal.context),
              0xFFFFFFFF);
    loopback.port[2].hal.healthy(loopback.port[2].hal.context);
    check_int("healthy is counted", loopback.port[2].healthy, 1);
}

TEST(loopback_full)
{
    loopback_init(&loopback, 2, 4);
    for (uint32_t i = 1; i <= 6; i++)
        check_int("a deaf receiver does not stop the sender", port_give(0, i), 1);
    for (int64_t i = 1; i <= 4; i++)
        check_int("the oldest are kept", port_take(1), i);
    check_int("then the loss is reported", port_take(1), -HAL_DROPPED);
    check_int("once", port_take(1), 0);
    loopback.port[0].tx_limit = 2;
    loopback.port[0].hal.flush(loopback.port[0].hal.context);
    check_int("first of two", port_give(0, 1), 1);
    check_int("second of two", port_give(0, 2), 1);
    check_int("no room until flush", port_give(0, 3), 0);
    loopback.port[0].hal.flush(loopback.port[0].hal.context);
    check_int("room again", port_give(0, 4), 1);
    check_int("the refused one never arrives", port_take(1) * 100 + port_take(1) * 10 + port_take(1), 124);
    loopback.port[1].fault = HAL_BUS_OFF | HAL_DOWN;
    check_int("a fault set by the test", port_take(1), -(HAL_BUS_OFF | HAL_DOWN));
    check_int("is reported once", port_take(1), 0);
}
