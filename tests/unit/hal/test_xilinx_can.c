/* test_xilinx_can.c - peculiarities of the Xilinx controller: its registers bit by bit, its filter's
 * handshake, the wait for an idle bus. The contract that all drivers share is in test_can.c. */
#include <stddef.h>
#include "tests/unit/test.h"
#include "tests/device/xilinx_model.h"

TEST(xilinx_can_registers)
{
    struct can_config c = {.timing = {10, 7, 2, 1}, .base_id = 0x200, .now_us = can_device_now};
    can_device_check("1 Mbit/s of 100 MHz", xilinx_device.open(&c));
    check_hex("BRPR: divide by 10", xilinx_model.prescaler, 9);
    check_hex("BTR: jump 1, segments 7 and 2", xilinx_model.timing, 0x016);
    check_hex("MSR: normal mode", xilinx_model.mode, 0);
    check_hex("interrupts", xilinx_model.enabled, 0);
    check_hex("filter 1 is in use, no other", xilinx_model.filters, 1);
    check_hex("it compares 5 identifier bits, remote, format", xilinx_model.mask[0], 0xF8180000);
    check_hex("with", xilinx_model.id[0], 0x40000000);
    c.extended = true;
    c.base_id = 0x18DAF140;
    can_device_check("29 bits", xilinx_device.open(&c));
    check_hex("it compares 23 identifier bits, format, remote", xilinx_model.mask[0], 0xFFFFFF81);
    check_hex("with", xilinx_model.id[0], 0xC6DDE280);
    check_int("accesses that UG1087 forbids", xilinx_model.illegal, 0);
}

/* Words of UG1085: 11-bit identifier 0x123 is 0x24600000, byte 0 the highest. */
TEST(xilinx_can_words)
{
    const struct frame f = {
        .id = 0x123, .length = 8, .data = {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}};
    const struct frame g = {.id = 0x15555555, .flags = FRAME_EXTENDED, .length = 2, .data = {0xAB, 0xCD}};
    struct wire_frame w = {.id = 0x241, .dlc = 8};
    struct frame got;
    xilinx_device.open(&can_device_config);
    xilinx_driver.hal.send(&xilinx_driver, &f);
    xilinx_driver.hal.send(&xilinx_driver, &g);
    check_hex("identifier word", xilinx_model.tx[0][0], 0x24600000);
    check_hex("length word", xilinx_model.tx[0][1], 0x80000000);
    check_hex("bytes 0 to 3", xilinx_model.tx[0][2], 0x11223344);
    check_hex("bytes 4 to 7", xilinx_model.tx[0][3], 0x55667788);
    check_hex("identifier word of 29 bits", xilinx_model.tx[1][0], 0xAABAAAAA);
    check_hex("two bytes", xilinx_model.tx[1][2], 0xABCD0000);
    xilinx_device.arrive(&w);
    check_int("a frame arrives", xilinx_driver.hal.recv(&xilinx_driver, &got), 1);
    check_hex("with its time stamp", xilinx_driver.received_stamp, 0x1234);
}

TEST(xilinx_can_start)
{
    struct frame f = {.id = 0x250, .length = 8};
    xilinx_model.filter_busy = true;
    check_true("a filter that stays busy is told", xilinx_device.open(&can_device_config) != NULL);
    xilinx_model.filter_busy = false;
    can_device_check("the bus was idle after some looks", xilinx_device.open(&can_device_config));
    check_int("looks left", xilinx_model.joining, 0);
    xilinx_model.stuck = true;
    can_device_check("a bus that is not idle keeps nobody from starting",
                     xilinx_device.open(&can_device_config));
    check_int("but is told", xilinx_driver.hal.recv(&xilinx_driver, &f), -HAL_DOWN);
    xilinx_model.stuck = false;
    can_device_us += can_device_config.restart_us;
    check_int("and joined when it can be", xilinx_driver.hal.recv(&xilinx_driver, &f), 0);
    xilinx_device.idle();
    check_int("from then on", xilinx_driver.hal.recv(&xilinx_driver, &f), 0);
    check_int("frames are taken", xilinx_driver.hal.send(&xilinx_driver, &f), 1);
}

TEST(xilinx_can_events)
{
    struct frame f = {.id = 0x250, .length = 8};
    xilinx_device.open(&can_device_config);
    xilinx_device.errors(256, 0);
    xilinx_device.idle();
    check_int("a bus-off that was over before anybody looked is told",
              xilinx_driver.hal.recv(&xilinx_driver, &f), -HAL_BUS_OFF);
    can_device_us += can_device_config.restart_us;
    check_int("restart", xilinx_driver.hal.recv(&xilinx_driver, &f), 0);
    xilinx_device.idle();
    xilinx_model.rx_stuck = true;
    check_int("a FIFO that never seems empty gives nothing", xilinx_driver.hal.recv(&xilinx_driver, &f), 0);
    check_int("and is left after some looks", xilinx_driver.can.passed_over, CAN_PASS_OVER);
    check_int("while sending goes on", xilinx_driver.hal.send(&xilinx_driver, &f), 1);
}
