/* test_stm32_fdcan.c - peculiarities of the FDCAN controller.
 *
 * They are its registers and its message RAM bit by bit, the handshake of its modes, CAN FD, protocol
 * exceptions, bits that are stuck, and bus-off in the middle. The contract that all drivers share is in
 * test_can.c. */
#include <string.h>
#include "tests/device/fdcan_model.h"
#include "tests/unit/test.h"

enum { BASE = 0x240, RESTART_US = 100000 };

static struct fdcan_model *const m = &fdcan_model;
static struct stm32_fdcan *const d = &fdcan_driver;
static const struct can_device *const device = &stm32_fdcan_device;

static uint32_t setting(uint32_t offset)
{
    return m->reg[offset / 4];
}

static struct stm32_fdcan_config config(void)
{
    return (struct stm32_fdcan_config){.can = can_device_config, .ram_offset = 0x400};
}

static void begin(const struct stm32_fdcan_config *c)
{
    m->absent = m->stuck = m->promiscuous = false;
    m->stuck_fill = m->stuck_full = 0;
    can_device_us = 0xFFFF0000u;
    can_device_check("open", fdcan_model_open(c));
}

static int hear(struct frame *f)
{
    return d->hal.recv(d, f);
}

static int hear_nothing(void)
{
    struct frame f;
    return hear(&f);
}

static int give(uint8_t first)
{
    return d->hal.send(d, &(struct frame){.id = BASE + 0x10, .length = 8, .data = {first}});
}

static void arrive(uint32_t id, uint8_t first)
{
    device->arrive(&(struct wire_frame){.id = id, .dlc = 8, .data = {first}});
}

/* ---- registers, elements ---- */

TEST(stm32_fdcan_registers)
{
    struct stm32_fdcan_config c = config();
    c.can.timing = (struct can_timing){8, 7, 2, 1};
    c.can.base_id = 0x200;
    begin(&c);
    check_hex("NBTP: 1 Mbit/s of 80 MHz, jump 1", setting(0x1C), 0x00070601);
    check_hex("GFC: rejects all that no filter takes, and remote frames", setting(0x80), 0x3F);
    check_hex("SIDFC: one filter, first of our part", setting(0x84), 0x00010400);
    check_hex("XIDFC: none", setting(0x88), 0);
    check_hex("RXF0C: 64 elements, blocking", setting(0xA0), 0x00400408);
    check_hex("RXESC: eight bytes", setting(0xBC), 0);
    check_hex("TXBC: FIFO of 32, no buffers", setting(0xC0), 0x20000808);
    check_hex("TXESC: eight bytes", setting(0xC8), 0);
    check_hex("IE: polled", setting(0x54), 0);
    check_hex("filter: classic, to FIFO 0, 0x200, mask 0x7C0", m->ram[0x100], 0x8A0007C0);
    check_true("on the bus, settings closed", !m->init && !m->cce);
    check_hex("classic", m->mode, 0);
    check_hex("below our part nothing was written", m->ram[0xFF], 0xA5A5A5A5);
    check_hex("nor above", m->ram[(0x400 + STM32_FDCAN_RAM) / 4], 0xA5A5A5A5);
    check_hex("its last word was", m->ram[(0x400 + STM32_FDCAN_RAM) / 4 - 1], 0);
    c.can.extended = true;
    c.can.base_id = 0x18DAF140;
    c.ram_offset = STM32_FDCAN_RAM_BYTES - STM32_FDCAN_RAM;
    begin(&c);
    check_hex("SIDFC: none", setting(0x84), 0);
    check_hex("XIDFC: one filter, at the end of the RAM", setting(0x88), 0x000121F8);
    check_hex("XIDAM: all bits", setting(0x90), 0x1FFFFFFF);
    check_hex("filter: to FIFO 0, identifier", m->ram[0x21F8 / 4], 0x38DAF140);
    check_hex("filter: classic, mask", m->ram[0x21F8 / 4 + 1], 0x9FFFFFC0);
    check_int("accesses that RM0433 forbids", m->illegal, 0);
}

/* Elements of RM0433: 11-bit identifier 0x123 in bits 28..18, byte 0 the lowest. */
TEST(stm32_fdcan_elements)
{
    const struct stm32_fdcan_config c = config();
    const uint32_t *tx = &m->ram[(0x400 + 8 + 64 * 16) / 4], *rx = &m->ram[(0x400 + 8) / 4];
    const struct frame f = {
        .id = 0x123, .length = 8, .data = {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}};
    const struct frame g = {.id = 0x15555555, .flags = FRAME_EXTENDED, .length = 2, .data = {0xAB, 0xCD}};
    struct frame got;
    begin(&c);
    d->hal.send(d, &f);
    d->hal.send(d, &g);
    check_hex("T0", tx[0], 0x048C0000);
    check_hex("T1: eight bytes, classic, no event", tx[1], 0x00080000);
    check_hex("bytes 3 to 0", tx[2], 0x44332211);
    check_hex("bytes 7 to 4", tx[3], 0x88776655);
    check_hex("T0 of 29 bits", tx[4], 0x55555555);
    check_hex("T1: two bytes", tx[5], 0x00020000);
    check_hex("its bytes", tx[6], 0x0000CDAB);
    arrive(0x27F, 0x5A);
    check_hex("R0", rx[0], 0x27Fu << 18);
    check_int("a frame is received", hear(&got), 1);
    check_hex("its identifier", got.id, 0x27F);
    check_hex("its first byte", got.data[0], 0x5A);
    check_int("accesses that RM0433 forbids", m->illegal, 0);
}

/* From all identifiers of 11 bits those of the plant come through, whatever else is wrong with their
 * frames. */
TEST(stm32_fdcan_filter)
{
    const struct stm32_fdcan_config c = config();
    int ours = 0, others = 0;
    begin(&c);
    for (uint32_t id = 0; id < 0x800; id++)
        for (int k = 0; k < 4; k++) {
            struct wire_frame f = {id, k & 1, k & 2, 8, {0}};
            device->arrive(&f);
            *(id - BASE < 64 && k == 0 ? &ours : &others) += hear_nothing() == 1;
        }
    check_int("identifiers of the plant that come through", ours, 64);
    check_int("others, remote frames and the other format", others, 0);
    check_int("and none was left to the driver", d->can.passed_over, 0);
    m->promiscuous = true;
    device->arrive(&(struct wire_frame){BASE, false, true, 8, {0}});
    check_int("a remote frame that gets through", hear_nothing(), 0);
    check_int("is passed over", d->can.passed_over, 1);
}

/* ---- FIFOs ---- */

TEST(stm32_fdcan_fifos)
{
    const struct stm32_fdcan_config c = config();
    struct wire_frame w;
    struct frame f;
    int taken = 0, wrong = 0;
    begin(&c);
    for (int round = 0; round < 5; round++) { /* the put index goes around at different places */
        taken = 0;
        for (int i = 0; i < 40; i++)
            taken += give((uint8_t)i) == 1;
        wrong += taken != STM32_FDCAN_TX;
        for (int i = 0; i < taken; i++)
            wrong += !device->leave(&w) || w.data[0] != i;
        give(0xEE);
        device->leave(&w);
    }
    check_int("transmit FIFO: rounds and frames that went wrong", wrong, 0);
    check_int("refused", d->can.refused, 5 * 8);
    for (int round = 0; round < 3; round++) {
        for (int i = 0; i < STM32_FDCAN_RX + 7; i++)
            arrive(BASE, (uint8_t)i);
        for (int i = 0; i < STM32_FDCAN_RX; i++)
            wrong += hear(&f) != 1 || f.data[0] != i;
        wrong += hear_nothing() != -HAL_DROPPED || hear_nothing() != 0;
        arrive(BASE, 0x77);
        wrong += hear(&f) != 1 || f.data[0] != 0x77;
    }
    check_int("receive FIFO: rounds and frames that went wrong", wrong, 0);
    check_int("overruns", d->can.dropped, 3);
    check_int("accesses that RM0433 forbids", m->illegal, 0);
}

/* ---- modes ---- */

TEST(stm32_fdcan_modes)
{
    const struct stm32_fdcan_config c = config();
    begin(&c);
    check_below("looks of an open", m->reads, 30);
    m->stuck = true;
    const char *why = fdcan_model_open(&c);
    check_string("a controller that keeps its mode", why ? why : "",
                 "the FDCAN does not change its mode: is its kernel clock on?");
    check_below("looks until it is told", m->reads, 2 * CAN_TRIES + 10);
    m->stuck = false;
    m->absent = true;
    why = fdcan_model_open(&c);
    check_string("no controller", why ? why : "", "no FDCAN answers at its address: is its bus clock on?");
    m->absent = false;
    can_device_check("and then it is there", fdcan_model_open(&c));
    m->mode = 8; /* a clock that was stopped: CSA */
    device->errors(256, 0);
    check_int("bus-off", hear_nothing(), -HAL_BUS_OFF);
    check_hex("the clock was asked to run", m->mode, 0);
    check_int("accesses that RM0433 forbids", m->illegal, 0);
}

/* The clock stops while the bus goes off: configuration is not
 * reached, and the next restart finds the controller again. */
TEST(stm32_fdcan_clock_stops)
{
    const struct stm32_fdcan_config c = config();
    begin(&c);
    m->mode = 8; /* CSA */
    m->stuck = true;
    device->errors(256, 0);
    check_int("bus-off", hear_nothing(), -HAL_BUS_OFF);
    check_hex("the clock stands", m->mode, 8);
    check_int("no frame is taken", give(1), 0);
    m->stuck = false;
    can_device_us += RESTART_US;
    check_int("restart", hear_nothing(), 0);
    check_hex("the clock runs", m->mode, 0);
    device->idle();
    check_int("back on the bus", hear_nothing(), 0);
    check_int("frames are taken", give(2), 1);
    check_int("accesses that RM0433 forbids", m->illegal, 0);
}

/* ---- CAN FD ---- */

TEST(stm32_fdcan_fd)
{
    struct stm32_fdcan_config c = config();
    struct frame f;
    struct wire_frame w;
    c.data = (struct can_timing){1, 29, 10, 10};
    begin(&c);
    check_hex("DBTP: 2 Mbit/s of 80 MHz", setting(0x0C), 0x00001C99);
    check_hex("CCCR: CAN FD with bit rate switching", m->mode, 0x300);
    for (int i = 0; i < 10; i++) {
        fdcan_model_arrive_fd(BASE + 1);
        arrive(BASE + 2, (uint8_t)i);
    }
    for (int i = 0; i < 10; i++) {
        check_int("a classic frame behind one of CAN FD", hear(&f), 1);
        check_hex("its identifier", f.id, BASE + 2);
    }
    check_int("then none", hear_nothing(), 0);
    check_int("CAN FD frames, counted", d->fd_frames, 10);
    check_int("passed over", d->can.passed_over, 10);
    check_int("what is sent", give(1), 1);
    check_true("is classic", device->leave(&w));
    check_int("is classic", m->illegal, 0);
    device->errors(256, 0);
    check_int("bus-off", hear_nothing(), -HAL_BUS_OFF);
    can_device_us += RESTART_US;
    hear_nothing();
    check_hex("after a restart it still takes part in CAN FD", m->mode, 0x300);
    c.data.prescaler = 0;
    begin(&c);
    fdcan_model_arrive_fd(BASE + 1);
    check_int("a classic controller receives none", hear_nothing(), 0);
    check_int("and counts an error", d->can.receive_errors, 1);
}

/* A frame of a protocol yet to come: the controller waits for the bus to be idle, nothing else changes. */
TEST(stm32_fdcan_exceptions)
{
    const struct stm32_fdcan_config c = config();
    begin(&c);
    for (int i = 0; i < 3; i++) {
        m->exception = true;
        check_int("a protocol exception is no fault", hear_nothing(), 0);
        check_int("nothing to hear after it", hear_nothing(), 0);
    }
    check_int("counted", d->protocol_exceptions, 3);
    check_int("state", d->can.state, CAN_ACTIVE);
    m->exception = true;
    arrive(BASE, 1);
    check_int("a frame comes first", hear_nothing(), 1);
    check_int("sending goes on", give(1), 1);
    hear_nothing();
    check_int("counted", d->protocol_exceptions, 4);
}

/* ---- bits that are stuck ---- */

TEST(stm32_fdcan_stuck_bits)
{
    const struct stm32_fdcan_config c = config();
    begin(&c);
    m->stuck_fill = 1; /* the receive FIFO never looks empty, with nothing of ours in it */
    for (int i = 0; i < 3; i++)
        check_int("a FIFO that never looks empty comes to an end", hear_nothing(), 0);
    check_int("frames passed over", d->can.passed_over, 3 * CAN_PASS_OVER);
    m->stuck_fill = 0x3F << 8; /* and a get index that is stuck at its last value */
    check_int("a get index that is stuck", hear_nothing(), 0);
    begin(&c);
    m->stuck_full = 1 << 21;
    check_int("a transmit FIFO that always looks full takes nothing", give(1), 0);
    m->stuck_full = 0x1F << 16;
    check_is("a put index that is stuck stays in our part", give(1), >=, 0);
    m->stuck_full = 0;
    check_int("refused", d->can.refused, 1);
    begin(&c);
    m->init = m->wanted_init = true; /* INIT comes back by itself, again and again */
    check_int("sending is refused at once", give(1), 0);
    check_int("and the loss of the bus told", hear_nothing(), -HAL_DOWN);
    for (int i = 0; i < 5; i++) {
        can_device_us += RESTART_US;
        check_int("a restart", hear_nothing(), 0);
        m->init = m->wanted_init = true;
    }
    check_int("restarts", d->can.restarted, 5);
}

/* ---- bus-off ---- */

TEST(stm32_fdcan_bus_off)
{
    const struct stm32_fdcan_config c = config();
    struct wire_frame w;
    begin(&c);
    for (int i = 0; i < 10; i++)
        give((uint8_t)i);
    device->leave(&w);
    arrive(BASE, 1);
    device->errors(256, 0); /* nine wait to be sent, one to be received */
    check_int("sending is refused before anybody has looked", give(10), 0);
    check_int("what had come is received", hear_nothing(), 1);
    check_int("then bus-off", hear_nothing(), -HAL_BUS_OFF);
    check_int("what waited is dropped", m->n_tx, 0);
    device->idle();
    check_true("the controller stays off while INIT is set", m->off);
    check_int("the controller stays off while INIT is set", hear_nothing(), 0);
    can_device_us += RESTART_US;
    check_int("the restart", hear_nothing(), 0);
    check_true("INIT is clear, the controller counts idle bits", !m->init && m->off);
    for (int i = 0; i < 4; i++) { /* a bus that is never idle: the count must not begin again */
        can_device_us += RESTART_US;
        check_int("still off", hear_nothing(), 0);
        check_int("nothing is taken", give(1), 0);
    }
    check_int("restarts", d->can.restarted, 1);
    check_true("it was left alone", m->recovering);
    device->errors(256, 0);
    can_device_us += RESTART_US;
    check_int("bus-off while it counts: no new one to report", hear_nothing(), 0);
    check_int("but a restart", d->can.restarted, 2);
    device->idle();
    check_int("back", hear_nothing(), 0);
    check_int("state", d->can.state, CAN_ACTIVE);
    check_int("nothing from before goes out", device->leave(&w), 0);
    check_int("what is new does", give(0x42), 1);
    check_true("what is new does", device->leave(&w));
    check_is("what is new does", w.data[0], ==, 0x42);
    check_int("bus-offs", d->can.bus_off, 1);
    check_int("accesses that RM0433 forbids", m->illegal, 0);
}

/* A failed access to the message RAM puts the controller
 * into restricted operation: deaf in one direction, so down. */
TEST(stm32_fdcan_memory_failure)
{
    const struct stm32_fdcan_config c = config();
    begin(&c);
    m->mode |= 4;
    check_int("restricted operation is told", hear_nothing(), -HAL_DOWN);
    check_int("nothing is taken", give(1), 0);
    can_device_us += RESTART_US;
    check_int("the restart", hear_nothing(), 0);
    check_hex("ends it", m->mode & 4, 0);
    check_int("active", hear_nothing() == 0 && d->can.state == CAN_ACTIVE, 1);
    check_int("sending", give(1), 1);
    check_int("outages", d->can.down, 1);
}

static void check_refused(const struct stm32_fdcan_config *c, const char *name)
{
    check_error(name, fdcan_model_open(c));
}

TEST(stm32_fdcan_refuses)
{
    struct stm32_fdcan_config c = config();
    c.can.timing.prescaler = 513;
    check_refused(&c, "prescaler 513");
    c = config();
    c.can.timing.segment1 = 1;
    check_refused(&c, "segment 1 of one quantum");
    c = config();
    c.can.timing.segment2 = 1;
    check_refused(&c, "segment 2 of one quantum");
    c = config();
    c.ram_offset = 2;
    check_refused(&c, "half a word of RAM");
    c.ram_offset = STM32_FDCAN_RAM_BYTES - STM32_FDCAN_RAM + 4;
    check_refused(&c, "RAM beyond the end");
    c.ram_offset = 0xFFFFFFFC;
    check_refused(&c, "RAM before the beginning");
    c = config();
    c.data = (struct can_timing){33, 5, 2, 1};
    check_refused(&c, "prescaler 33 of the data phase");
    c.data = (struct can_timing){1, 33, 2, 1};
    check_refused(&c, "data segment 1 of 33 quanta");
    c.data = (struct can_timing){1, 5, 17, 1};
    check_refused(&c, "data segment 2 of 17 quanta");
    c.data = (struct can_timing){1, 5, 2, 3};
    check_refused(&c, "a data jump longer than segment 2");
    c = config();
    can_device_check("and a good one is taken", fdcan_model_open(&c));
}
