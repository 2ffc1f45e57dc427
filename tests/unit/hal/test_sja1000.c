/* test_sja1000.c - peculiarities of the SJA1000: its registers bit by bit, queues beside its one buffer,
 * recovery counted by the controller, a mode that takes its filter away. The contract that all drivers
 * share is in test_can.c. */
#include <string.h>
#include "tests/device/sja1000_model.h"
#include "tests/unit/test.h"

static int sja1000_give(uint8_t first)
{
    const struct frame f = {.id = CAN_DEVICE_BASE + 0x10, .length = 1, .data = {first}};
    return sja1000_driver.hal.send(&sja1000_driver, &f);
}

static uint32_t word(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

TEST(sja1000_registers)
{
    struct can_config c = can_device_config;
    can_device_check("1 Mbit/s of 16 MHz", sja1000_device.open(&c));
    check_hex("CDR: PeliCAN, comparator bypassed, clock pin off", sja1000_model.clock, 0xC8);
    check_hex("BTR0: jump 1, divide by 2", sja1000_model.timing[0], 0x00);
    check_hex("BTR1: segments 5 and 2", sja1000_model.timing[1], 0x14); /* as Linux has it for 1 Mbit/s */
    check_hex("OCR", sja1000_model.output, 0x1A);
    check_hex("interrupts: received, sent", sja1000_model.enabled, 3);
    check_hex("MOD: operating, two filters", sja1000_model.mode, 0);
    check_hex("acceptance code", word(sja1000_model.code), 0x48004800);
    check_hex("acceptance mask: 6 identifier bits and data", word(sja1000_model.mask), 0x07EF07EF);
    c.extended = true;
    c.base_id = 0x18DAF140;
    c.timing.prescaler = 20;
    can_device_check("29 bits, 100 kbit/s", sja1000_device.open(&c));
    check_hex("BTR0: divide by 20", sja1000_model.timing[0], 0x09);
    check_hex("MOD: operating, one filter", sja1000_model.mode, 8);
    check_hex("acceptance code", word(sja1000_model.code), 0xC6D78A00);
    check_hex("acceptance mask: 6 identifier bits", word(sja1000_model.mask), 0x000001FB);
    check_int("accesses that the data sheet forbids", sja1000_model.illegal, 0);
    c.timing.prescaler = 3;
    check_true("an odd prescaler is refused", sja1000_device.open(&c) != NULL);
}

TEST(sja1000_bytes)
{
    const struct frame f = {.id = 0x123, .length = 2, .data = {0x11, 0x22}};
    const struct frame g = {.id = 0x15555555, .flags = FRAME_EXTENDED, .length = 1, .data = {0xAB}};
    const uint8_t standard[] = {0x02, 0x24, 0x60, 0x11, 0x22},
                  extended[] = {0x81, 0xAA, 0xAA, 0xAA, 0xA8, 0xAB};
    struct wire_frame w;
    sja1000_device.open(&can_device_config);
    sja1000_driver.hal.send(&sja1000_driver, &f);
    check_int("a frame of 11 bits as in the data sheet", memcmp(sja1000_model.tx, standard, sizeof standard),
              0);
    sja1000_device.leave(&w);
    sja1000_driver.hal.send(&sja1000_driver, &g);
    check_int("a frame of 29 bits as in the data sheet", memcmp(sja1000_model.tx, extended, sizeof extended),
              0);
}

/* The queue in the driver takes what comes between two
 * frames of the plant, if its owner answers the interrupt. */
TEST(sja1000_queues)
{
    uint32_t got = 0;
    struct frame f;
    sja1000_device.open(&can_device_config);
    for (uint32_t i = 0; i < SJA1000_WAITING + 5; i++) {
        const struct wire_frame w = {.id = CAN_DEVICE_BASE + 1, .dlc = 8, .data = {(uint8_t)i}};
        sja1000_device.arrive(&w);
        sja1000_service(&sja1000_driver);
    }
    check_int("waiting in the driver", sja1000_driver.in.n, SJA1000_WAITING);
    check_above("and in the controller, bytes", sja1000_model.n_fifo, 5 * 11);
    while (sja1000_driver.hal.recv(&sja1000_driver, &f) == 1)
        got += f.data[0] == (uint8_t)got;
    check_int("all come, in order", got, SJA1000_WAITING + 5);
    check_int("nothing was dropped", sja1000_driver.can.dropped, 0);
    sja1000_give(1);
    sja1000_device.leave(&(struct wire_frame){0});
    check_int("the interrupt of a frame that went is lowered", sja1000_model.events & sja1000_model.enabled,
              0);
}

TEST(sja1000_recovery)
{
    struct frame f;
    sja1000_device.open(&can_device_config);
    sja1000_device.errors(256, 0);
    sja1000_give(1);
    check_hex("a frame meant for the wire did not get into the filter", word(sja1000_model.code), 0x48004800);
    check_int("bus-off", sja1000_driver.hal.recv(&sja1000_driver, &f), -HAL_BUS_OFF);
    can_device_us += can_device_config.restart_us;
    check_int("restart", sja1000_driver.hal.recv(&sja1000_driver, &f), 0);
    check_int("the controller still counts idle bits: nothing is taken", sja1000_give(2), 0);
    can_device_us += can_device_config.restart_us;
    check_int("which may last longer than the restart time", sja1000_driver.hal.recv(&sja1000_driver, &f), 0);
    check_int("restarts", sja1000_driver.can.restarted, 1);
    sja1000_device.idle();
    check_int("it is back", sja1000_driver.hal.recv(&sja1000_driver, &f), 0);
    check_int("and takes frames", sja1000_give(3), 1);
    check_int("bus-offs", sja1000_driver.can.bus_off, 1);
    check_int("accesses that the data sheet forbids", sja1000_model.illegal, 0);
}
