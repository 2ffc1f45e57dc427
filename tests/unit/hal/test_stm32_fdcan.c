/* test_stm32_fdcan.c - peculiarities of the FDCAN controller.
 *
 * They are its registers and its message RAM bit by bit, the handshake of its modes, CAN FD, protocol
 * exceptions, bits that are stuck, and bus-off in the middle. The contract that all drivers share is in
 * test_can.c. */
#include "tests/device/fdcan_model.h"
#include "tests/unit/test.h"

static uint32_t setting(uint32_t offset)
{
    return fdcan_model.reg[offset / 4];
}

static struct stm32_fdcan_config fdcan_config(void)
{
    return (struct stm32_fdcan_config){.can = can_device_config, .ram_offset = 0x400};
}

static void fdcan_begin(const struct stm32_fdcan_config *c)
{
    fdcan_model.absent = fdcan_model.stuck = fdcan_model.promiscuous = false;
    fdcan_model.stuck_fill = fdcan_model.stuck_full = 0;
    can_device_us = 0xFFFF0000u;
    can_device_check("open", fdcan_model_open(c));
}

static int fdcan_hear(struct frame *f)
{
    return fdcan_driver.hal.recv(&fdcan_driver, f);
}

static int hear_nothing(void)
{
    struct frame f;
    return fdcan_hear(&f);
}

static int fdcan_give(uint8_t first)
{
    return fdcan_driver.hal.send(&fdcan_driver,
                                 &(struct frame){.id = CAN_DEVICE_BASE + 0x10, .length = 8, .data = {first}});
}

static void fdcan_arrive(uint32_t id, uint8_t first)
{
    stm32_fdcan_device.arrive(&(struct wire_frame){.id = id, .dlc = 8, .data = {first}});
}

/* ---- registers, elements ---- */

TEST(stm32_fdcan_registers)
{
    struct stm32_fdcan_config c = fdcan_config();
    c.can.timing = (struct can_timing){8, 7, 2, 1};
    c.can.base_id = 0x200;
    fdcan_begin(&c);
    check_hex("NBTP: 1 Mbit/s of 80 MHz, jump 1", setting(0x1C), 0x00070601);
    check_hex("GFC: rejects all that no filter takes, and remote frames", setting(0x80), 0x3F);
    check_hex("SIDFC: one filter, first of our part", setting(0x84), 0x00010400);
    check_hex("XIDFC: none", setting(0x88), 0);
    check_hex("RXF0C: 64 elements, blocking", setting(0xA0), 0x00400408);
    check_hex("RXESC: eight bytes", setting(0xBC), 0);
    check_hex("TXBC: FIFO of 32, no buffers", setting(0xC0), 0x20000808);
    check_hex("TXESC: eight bytes", setting(0xC8), 0);
    check_hex("IE: polled", setting(0x54), 0);
    check_hex("filter: classic, to FIFO 0, 0x200, mask 0x7C0", fdcan_model.ram[0x100], 0x8A0007C0);
    check_true("on the bus, settings closed", !fdcan_model.init && !fdcan_model.cce);
    check_hex("classic", fdcan_model.mode, 0);
    check_hex("below our part nothing was written", fdcan_model.ram[0xFF], 0xA5A5A5A5);
    check_hex("nor above", fdcan_model.ram[(0x400 + STM32_FDCAN_RAM) / 4], 0xA5A5A5A5);
    check_hex("its last word was", fdcan_model.ram[(0x400 + STM32_FDCAN_RAM) / 4 - 1], 0);
    c.can.extended = true;
    c.can.base_id = 0x18DAF140;
    c.ram_offset = STM32_FDCAN_RAM_BYTES - STM32_FDCAN_RAM;
    fdcan_begin(&c);
    check_hex("SIDFC: none", setting(0x84), 0);
    check_hex("XIDFC: one filter, at the end of the RAM", setting(0x88), 0x000121F8);
    check_hex("XIDAM: all bits", setting(0x90), 0x1FFFFFFF);
    check_hex("filter: to FIFO 0, identifier", fdcan_model.ram[0x21F8 / 4], 0x38DAF140);
    check_hex("filter: classic, mask", fdcan_model.ram[0x21F8 / 4 + 1], 0x9FFFFFC0);
    check_int("accesses that RM0433 forbids", fdcan_model.illegal, 0);
}

/* Elements of RM0433: 11-bit identifier 0x123 in bits 28..18, byte 0 the lowest. */
TEST(stm32_fdcan_elements)
{
    const struct stm32_fdcan_config c = fdcan_config();
    const uint32_t *tx = &fdcan_model.ram[(0x400 + 8 + 64 * 16) / 4], *rx = &fdcan_model.ram[(0x400 + 8) / 4];
    const struct frame f = {
        .id = 0x123, .length = 8, .data = {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}};
    const struct frame g = {.id = 0x15555555, .flags = FRAME_EXTENDED, .length = 2, .data = {0xAB, 0xCD}};
    struct frame got;
    fdcan_begin(&c);
    fdcan_driver.hal.send(&fdcan_driver, &f);
    fdcan_driver.hal.send(&fdcan_driver, &g);
    check_hex("T0", tx[0], 0x048C0000);
    check_hex("T1: eight bytes, classic, no event", tx[1], 0x00080000);
    check_hex("bytes 3 to 0", tx[2], 0x44332211);
    check_hex("bytes 7 to 4", tx[3], 0x88776655);
    check_hex("T0 of 29 bits", tx[4], 0x55555555);
    check_hex("T1: two bytes", tx[5], 0x00020000);
    check_hex("its bytes", tx[6], 0x0000CDAB);
    fdcan_arrive(0x27F, 0x5A);
    check_hex("R0", rx[0], 0x27Fu << 18);
    check_int("a frame is received", fdcan_hear(&got), 1);
    check_hex("its identifier", got.id, 0x27F);
    check_hex("its first byte", got.data[0], 0x5A);
    check_int("accesses that RM0433 forbids", fdcan_model.illegal, 0);
}

/* From all identifiers of 11 bits those of the plant come through, whatever else is wrong with their
 * frames. */
TEST(stm32_fdcan_filter)
{
    const struct stm32_fdcan_config c = fdcan_config();
    int ours = 0, others = 0;
    fdcan_begin(&c);
    for (uint32_t id = 0; id < 0x800; id++)
        for (int k = 0; k < 4; k++) {
            struct wire_frame f = {id, k & 1, k & 2, 8, {0}};
            stm32_fdcan_device.arrive(&f);
            *(id - CAN_DEVICE_BASE < 64 && k == 0 ? &ours : &others) += hear_nothing() == 1;
        }
    check_int("identifiers of the plant that come through", ours, 64);
    check_int("others, remote frames and the other format", others, 0);
    check_int("and none was left to the driver", fdcan_driver.can.passed_over, 0);
    fdcan_model.promiscuous = true;
    stm32_fdcan_device.arrive(&(struct wire_frame){CAN_DEVICE_BASE, false, true, 8, {0}});
    check_int("a remote frame that gets through", hear_nothing(), 0);
    check_int("is passed over", fdcan_driver.can.passed_over, 1);
}

/* ---- FIFOs ---- */

TEST(stm32_fdcan_fifos)
{
    const struct stm32_fdcan_config c = fdcan_config();
    struct wire_frame w;
    struct frame f;
    int taken = 0, wrong = 0;
    fdcan_begin(&c);
    for (int round = 0; round < 5; round++) { /* the put index goes around at different places */
        taken = 0;
        for (int i = 0; i < 40; i++)
            taken += fdcan_give((uint8_t)i) == 1;
        wrong += taken != STM32_FDCAN_TX;
        for (int i = 0; i < taken; i++)
            wrong += !stm32_fdcan_device.leave(&w) || w.data[0] != i;
        fdcan_give(0xEE);
        stm32_fdcan_device.leave(&w);
    }
    check_int("transmit FIFO: rounds and frames that went wrong", wrong, 0);
    check_int("refused", fdcan_driver.can.refused, 5 * 8);
    for (int round = 0; round < 3; round++) {
        for (int i = 0; i < STM32_FDCAN_RX + 7; i++)
            fdcan_arrive(CAN_DEVICE_BASE, (uint8_t)i);
        for (int i = 0; i < STM32_FDCAN_RX; i++)
            wrong += fdcan_hear(&f) != 1 || f.data[0] != i;
        wrong += hear_nothing() != -HAL_DROPPED || hear_nothing() != 0;
        fdcan_arrive(CAN_DEVICE_BASE, 0x77);
        wrong += fdcan_hear(&f) != 1 || f.data[0] != 0x77;
    }
    check_int("receive FIFO: rounds and frames that went wrong", wrong, 0);
    check_int("overruns", fdcan_driver.can.dropped, 3);
    check_int("accesses that RM0433 forbids", fdcan_model.illegal, 0);
}

/* ---- modes ---- */

TEST(stm32_fdcan_modes)
{
    const struct stm32_fdcan_config c = fdcan_config();
    fdcan_begin(&c);
    check_below("looks of an open", fdcan_model.reads, 30);
    fdcan_model.stuck = true;
    const char *why = fdcan_model_open(&c);
    check_string("a controller that keeps its mode", why ? why : "",
                 "the FDCAN does not change its mode: is its kernel clock on?");
    check_below("looks until it is told", fdcan_model.reads, 2 * CAN_TRIES + 10);
    fdcan_model.stuck = false;
    fdcan_model.absent = true;
    why = fdcan_model_open(&c);
    check_string("no controller", why ? why : "", "no FDCAN answers at its address: is its bus clock on?");
    fdcan_model.absent = false;
    can_device_check("and then it is there", fdcan_model_open(&c));
    fdcan_model.mode = 8; /* a clock that was stopped: CSA */
    stm32_fdcan_device.errors(256, 0);
    check_int("bus-off", hear_nothing(), -HAL_BUS_OFF);
    check_hex("the clock was asked to run", fdcan_model.mode, 0);
    check_int("accesses that RM0433 forbids", fdcan_model.illegal, 0);
}

/* The clock stops while the bus goes off: configuration is not
 * reached, and the next restart finds the controller again. */
TEST(stm32_fdcan_clock_stops)
{
    const struct stm32_fdcan_config c = fdcan_config();
    fdcan_begin(&c);
    fdcan_model.mode = 8; /* CSA */
    fdcan_model.stuck = true;
    stm32_fdcan_device.errors(256, 0);
    check_int("bus-off", hear_nothing(), -HAL_BUS_OFF);
    check_hex("the clock stands", fdcan_model.mode, 8);
    check_int("no frame is taken", fdcan_give(1), 0);
    fdcan_model.stuck = false;
    can_device_us += CAN_DEVICE_RESTART_US;
    check_int("restart", hear_nothing(), 0);
    check_hex("the clock runs", fdcan_model.mode, 0);
    stm32_fdcan_device.idle();
    check_int("back on the bus", hear_nothing(), 0);
    check_int("frames are taken", fdcan_give(2), 1);
    check_int("accesses that RM0433 forbids", fdcan_model.illegal, 0);
}

/* ---- CAN FD ---- */

TEST(stm32_fdcan_fd)
{
    struct stm32_fdcan_config c = fdcan_config();
    struct frame f;
    struct wire_frame w;
    c.data = (struct can_timing){1, 29, 10, 10};
    fdcan_begin(&c);
    check_hex("DBTP: 2 Mbit/s of 80 MHz", setting(0x0C), 0x00001C99);
    check_hex("CCCR: CAN FD with bit rate switching", fdcan_model.mode, 0x300);
    for (int i = 0; i < 10; i++) {
        fdcan_model_arrive_fd(CAN_DEVICE_BASE + 1);
        fdcan_arrive(CAN_DEVICE_BASE + 2, (uint8_t)i);
    }
    for (int i = 0; i < 10; i++) {
        check_int("a classic frame behind one of CAN FD", fdcan_hear(&f), 1);
        check_hex("its identifier", f.id, CAN_DEVICE_BASE + 2);
    }
    check_int("then none", hear_nothing(), 0);
    check_int("CAN FD frames, counted", fdcan_driver.fd_frames, 10);
    check_int("passed over", fdcan_driver.can.passed_over, 10);
    check_int("what is sent", fdcan_give(1), 1);
    check_true("is classic", stm32_fdcan_device.leave(&w));
    check_int("is classic", fdcan_model.illegal, 0);
    stm32_fdcan_device.errors(256, 0);
    check_int("bus-off", hear_nothing(), -HAL_BUS_OFF);
    can_device_us += CAN_DEVICE_RESTART_US;
    hear_nothing();
    check_hex("after a restart it still takes part in CAN FD", fdcan_model.mode, 0x300);
    c.data.prescaler = 0;
    fdcan_begin(&c);
    fdcan_model_arrive_fd(CAN_DEVICE_BASE + 1);
    check_int("a classic controller receives none", hear_nothing(), 0);
    check_int("and counts an error", fdcan_driver.can.receive_errors, 1);
}

/* A frame of a protocol yet to come: the controller waits for the bus to be idle, nothing else changes. */
TEST(stm32_fdcan_exceptions)
{
    const struct stm32_fdcan_config c = fdcan_config();
    fdcan_begin(&c);
    for (int i = 0; i < 3; i++) {
        fdcan_model.exception = true;
        check_int("a protocol exception is no fault", hear_nothing(), 0);
        check_int("nothing to hear after it", hear_nothing(), 0);
    }
    check_int("counted", fdcan_driver.protocol_exceptions, 3);
    check_int("state", fdcan_driver.can.state, CAN_ACTIVE);
    fdcan_model.exception = true;
    fdcan_arrive(CAN_DEVICE_BASE, 1);
    check_int("a frame comes first", hear_nothing(), 1);
    check_int("sending goes on", fdcan_give(1), 1);
    hear_nothing();
    check_int("counted", fdcan_driver.protocol_exceptions, 4);
}

/* ---- bits that are stuck ---- */

TEST(stm32_fdcan_stuck_bits)
{
    const struct stm32_fdcan_config c = fdcan_config();
    fdcan_begin(&c);
    fdcan_model.stuck_fill = 1; /* the receive FIFO never looks empty, with nothing of ours in it */
    for (int i = 0; i < 3; i++)
        check_int("a FIFO that never looks empty comes to an end", hear_nothing(), 0);
    check_int("frames passed over", fdcan_driver.can.passed_over, 3 * CAN_PASS_OVER);
    fdcan_model.stuck_fill = 0x3F << 8; /* and a get index that is stuck at its last value */
    check_int("a get index that is stuck", hear_nothing(), 0);
    fdcan_begin(&c);
    fdcan_model.stuck_full = 1 << 21;
    check_int("a transmit FIFO that always looks full takes nothing", fdcan_give(1), 0);
    fdcan_model.stuck_full = 0x1F << 16;
    check_is("a put index that is stuck stays in our part", fdcan_give(1), >=, 0);
    fdcan_model.stuck_full = 0;
    check_int("refused", fdcan_driver.can.refused, 1);
    fdcan_begin(&c);
    fdcan_model.init = fdcan_model.wanted_init = true; /* INIT comes back by itself, again and again */
    check_int("sending is refused at once", fdcan_give(1), 0);
    check_int("and the loss of the bus told", hear_nothing(), -HAL_DOWN);
    for (int i = 0; i < 5; i++) {
        can_device_us += CAN_DEVICE_RESTART_US;
        check_int("a restart", hear_nothing(), 0);
        fdcan_model.init = fdcan_model.wanted_init = true;
    }
    check_int("restarts", fdcan_driver.can.restarted, 5);
}

/* ---- bus-off ---- */

TEST(stm32_fdcan_bus_off)
{
    const struct stm32_fdcan_config c = fdcan_config();
    struct wire_frame w;
    fdcan_begin(&c);
    for (int i = 0; i < 10; i++)
        fdcan_give((uint8_t)i);
    stm32_fdcan_device.leave(&w);
    fdcan_arrive(CAN_DEVICE_BASE, 1);
    stm32_fdcan_device.errors(256, 0); /* nine wait to be sent, one to be received */
    check_int("sending is refused before anybody has looked", fdcan_give(10), 0);
    check_int("what had come is received", hear_nothing(), 1);
    check_int("then bus-off", hear_nothing(), -HAL_BUS_OFF);
    check_int("what waited is dropped", fdcan_model.n_tx, 0);
    stm32_fdcan_device.idle();
    check_true("the controller stays off while INIT is set", fdcan_model.off);
    check_int("the controller stays off while INIT is set", hear_nothing(), 0);
    can_device_us += CAN_DEVICE_RESTART_US;
    check_int("the restart", hear_nothing(), 0);
    check_true("INIT is clear, the controller counts idle bits", !fdcan_model.init && fdcan_model.off);
    for (int i = 0; i < 4; i++) { /* a bus that is never idle: the count must not begin again */
        can_device_us += CAN_DEVICE_RESTART_US;
        check_int("still off", hear_nothing(), 0);
        check_int("nothing is taken", fdcan_give(1), 0);
    }
    check_int("restarts", fdcan_driver.can.restarted, 1);
    check_true("it was left alone", fdcan_model.recovering);
    stm32_fdcan_device.errors(256, 0);
    can_device_us += CAN_DEVICE_RESTART_US;
    check_int("bus-off while it counts: no new one to report", hear_nothing(), 0);
    check_int("but a restart", fdcan_driver.can.restarted, 2);
    stm32_fdcan_device.idle();
    check_int("back", hear_nothing(), 0);
    check_int("state", fdcan_driver.can.state, CAN_ACTIVE);
    check_int("nothing from before goes out", stm32_fdcan_device.leave(&w), 0);
    check_int("what is new does", fdcan_give(0x42), 1);
    check_true("what is new does", stm32_fdcan_device.leave(&w));
    check_is("what is new does", w.data[0], ==, 0x42);
    check_int("bus-offs", fdcan_driver.can.bus_off, 1);
    check_int("accesses that RM0433 forbids", fdcan_model.illegal, 0);
}

/* A failed access to the message RAM puts the controller
 * into restricted operation: deaf in one direction, so down. */
TEST(stm32_fdcan_memory_failure)
{
    const struct stm32_fdcan_config c = fdcan_config();
    fdcan_begin(&c);
    fdcan_model.mode |= 4;
    check_int("restricted operation is told", hear_nothing(), -HAL_DOWN);
    check_int("nothing is taken", fdcan_give(1), 0);
    can_device_us += CAN_DEVICE_RESTART_US;
    check_int("the restart", hear_nothing(), 0);
    check_hex("ends it", fdcan_model.mode & 4, 0);
    check_int("active", hear_nothing() == 0 && fdcan_driver.can.state == CAN_ACTIVE, 1);
    check_int("sending", fdcan_give(1), 1);
    check_int("outages", fdcan_driver.can.down, 1);
}

static void check_fdcan_refused(const struct stm32_fdcan_config *c, const char *name)
{
    check_error(name, fdcan_model_open(c));
}

TEST(stm32_fdcan_refuses)
{
    struct stm32_fdcan_config c = fdcan_config();
    c.can.timing.prescaler = 513;
    check_fdcan_refused(&c, "prescaler 513");
    c = fdcan_config();
    c.can.timing.segment1 = 1;
    check_fdcan_refused(&c, "segment 1 of one quantum");
    c = fdcan_config();
    c.can.timing.segment2 = 1;
    check_fdcan_refused(&c, "segment 2 of one quantum");
    c = fdcan_config();
    c.ram_offset = 2;
    check_fdcan_refused(&c, "half a word of RAM");
    c.ram_offset = STM32_FDCAN_RAM_BYTES - STM32_FDCAN_RAM + 4;
    check_fdcan_refused(&c, "RAM beyond the end");
    c.ram_offset = 0xFFFFFFFC;
    check_fdcan_refused(&c, "RAM before the beginning");
    c = fdcan_config();
    c.data = (struct can_timing){33, 5, 2, 1};
    check_fdcan_refused(&c, "prescaler 33 of the data phase");
    c.data = (struct can_timing){1, 33, 2, 1};
    check_fdcan_refused(&c, "data segment 1 of 33 quanta");
    c.data = (struct can_timing){1, 5, 17, 1};
    check_fdcan_refused(&c, "data segment 2 of 17 quanta");
    c.data = (struct can_timing){1, 5, 2, 3};
    check_fdcan_refused(&c, "a data jump longer than segment 2");
    c = fdcan_config();
    can_device_check("and a good one is taken", fdcan_model_open(&c));
}
