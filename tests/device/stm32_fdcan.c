/* stm32_fdcan.c - the driver of the FDCAN controller of STM32H7; see stm32_fdcan.h. */
#include "tests/device/stm32_fdcan.h"

#include <string.h>
#include "models/check.h"

/* Offsets, and the bits in use, under the manual's names. */
enum {
    ENDN = 0x004,  /* a constant, to see that there is a controller */
    DBTP = 0x00C,  /* data bit timing */
    CCCR = 0x018,  /* control */
    NBTP = 0x01C,  /* nominal bit timing */
    ECR = 0x040,   /* error counters */
    PSR = 0x044,   /* protocol status */
    IR = 0x050,    /* events; a one clears */
    IE = 0x054,    /* interrupts */
    GFC = 0x080,   /* global filter */
    SIDFC = 0x084, /* list of 11-bit filters */
    XIDFC = 0x088, /* list of 29-bit filters */
    XIDAM = 0x090, /* mask before those */
    RXF0C = 0x0A0, /* receive FIFO 0: where and how long */
    RXF0S = 0x0A4, /* its fill level and get index */
    RXF0A = 0x0A8, /* acknowledges the element of this index and those before */
    RXBC = 0x0AC,
    RXF1C = 0x0B0,
    RXESC = 0x0BC, /* sizes of receive elements, 0: eight bytes of data */
    TXBC = 0x0C0,  /* transmit FIFO: where and how long */
    TXFQS = 0x0C4, /* its free level and put index */
    TXESC = 0x0C8,
    TXBAR = 0x0D0, /* requests the sending of an element */
    TXEFC = 0x0F0
};

enum {
    CCCR_INIT = 1 << 0,
    CCCR_CCE = 1 << 1, /* settings may change; possible while INIT is set */
    CCCR_ASM = 1 << 2, /* restricted operation: set after a failed access to the message RAM */
    CCCR_CSA = 1 << 3, /* the clock is stopped */
    CCCR_FDOE = 1 << 8,
    CCCR_BRSE = 1 << 9
};
enum { PSR_EP = 1 << 5, PSR_EW = 1 << 6, PSR_BO = 1 << 7, PSR_PXE = 1 << 14 };
enum { ECR_RECEIVE_PASSIVE = 1 << 15 };
enum { IR_RF0L = 1 << 3, IR_ALL = 0x3FCFFFFF };
enum { GFC_REJECT = 0x3F }; /* remote frames and frames that no filter takes, both formats */
enum { RXF0S_FILL = 0x7F, TXFQS_FREE = 0x3F, TXFQS_FULL = 1 << 21 };
#define ENDIANNESS 0x87654321u

/* Filters: type "classic" and "store in receive FIFO 0", an identifier, a mask. */
enum { STANDARD_TO_FIFO0 = 1 << 27, STANDARD_MASK = 0x7FF, EXTENDED_TO_FIFO0 = 1 << 29 };
#define CLASSIC       0x80000000u
#define EXTENDED_MASK 0x1FFFFFFFu

/* The first two words of an element; behind them the data, byte 0 in bits 7..0. */
enum {
    ELEMENT_EXTENDED = 1 << 30,
    ELEMENT_REMOTE = 1 << 29,
    STANDARD_SHIFT = 18,
    ELEMENT_FD = 1 << 21,
    LENGTH_SHIFT = 16
};

/* Our part of the message RAM, in bytes. */
enum {
    ELEMENT = 16,
    RAM_FILTER = 0, /* one word for 11 bits, two for 29 */
    RAM_RX = 8,
    RAM_TX = RAM_RX + STM32_FDCAN_RX * ELEMENT,
    RAM_END = RAM_TX + STM32_FDCAN_TX * ELEMENT
};
STATIC_ASSERT((int)RAM_END == (int)STM32_FDCAN_RAM, the_header_says_how_much_ram);

static const struct can_limits limits = {
    .prescaler_max = 512, .prescaler_step = 1, .segment1_max = 255, .segment2_max = 128, .jump_max = 128};

static uint32_t get(const struct stm32_fdcan *d, uint32_t offset)
{
    return d->registers.read(d->registers.context, offset);
}

static void set(const struct stm32_fdcan *d, uint32_t offset, uint32_t value)
{
    d->registers.write(d->registers.context, offset, value);
}

static uint32_t get_ram(const struct stm32_fdcan *d, uint32_t offset)
{
    return d->ram.read(d->ram.context, d->ram_offset + offset);
}

static void set_ram(const struct stm32_fdcan *d, uint32_t offset, uint32_t value)
{
    d->ram.write(d->ram.context, d->ram_offset + offset, value);
}

/* ---- modes ---- */

/* Control bits cross into the clock of the bus: they hold only when they read back. */
static bool wait_control(const struct stm32_fdcan *d, uint32_t bits, uint32_t value)
{
    int i = 0;
    while (i < CAN_TRIES && (get(d, CCCR) & bits) != value)
        i++;
    return i < CAN_TRIES;
}

/* Off the bus, settings open, both FIFOs empty. */
static bool enter_configuration(const struct stm32_fdcan *d)
{
    set(d, CCCR, CCCR_INIT);
    if (!wait_control(d, CCCR_INIT | CCCR_CSA, CCCR_INIT))
        return false;
    set(d, CCCR, CCCR_INIT | CCCR_CCE);
    return wait_control(d, CCCR_CCE, CCCR_CCE);
}

static uint32_t nominal(const struct can_timing *t)
{
    return (t->jump - 1u) << 25 | (t->prescaler - 1u) << 16 | (t->segment1 - 1u) << 8 | (t->segment2 - 1u);
}

static uint32_t data_phase(const struct can_timing *t)
{
    return (t->prescaler - 1u) << 16 | (t->segment1 - 1u) << 8 | (t->segment2 - 1u) << 4 | (t->jump - 1u);
}

static void set_filter(const struct stm32_fdcan *d)
{
    const struct can_config *c = &d->can.config;
    uint32_t list = (d->ram_offset + RAM_FILTER) | 1u << 16, any = FRAME_IDS - 1;
    set(d, GFC, GFC_REJECT);
    set(d, SIDFC, c->extended ? 0 : list);
    set(d, XIDFC, c->extended ? list : 0);
    set(d, XIDAM, EXTENDED_MASK);
    if (c->extended) {
        set_ram(d, RAM_FILTER, EXTENDED_TO_FIFO0 | c->base_id);
        set_ram(d, RAM_FILTER + 4, CLASSIC | (EXTENDED_MASK & ~any));
    } else {
        set_ram(d, RAM_FILTER, CLASSIC | STANDARD_TO_FIFO0 | c->base_id << 16 | (STANDARD_MASK & ~any));
    }
}

static void set_memory(const struct stm32_fdcan *d)
{
    for (uint32_t i = 0; i < STM32_FDCAN_RAM; i += 4)
        set_ram(d, i, 0);
    set(d, RXF0C, STM32_FDCAN_RX << 16 | (d->ram_offset + RAM_RX));
    set(d, RXF1C, 0);
    set(d, RXBC, 0);
    set(d, RXESC, 0);
    set(d, TXBC, STM32_FDCAN_TX << 24 | (d->ram_offset + RAM_TX));
    set(d, TXESC, 0);
    set(d, TXEFC, 0);
}

/* From any state to where the controller joins the bus
 * after 11 recessive bits, after bus-off 129 times that. */
static bool start(const struct stm32_fdcan *d)
{
    uint32_t mode = d->data.prescaler > 0 ? CCCR_FDOE | CCCR_BRSE : 0;
    if (!enter_configuration(d))
        return false;
    set(d, CCCR, CCCR_INIT | CCCR_CCE | mode);
    set(d, NBTP, nominal(&d->can.config.timing));
    if (mode)
        set(d, DBTP, data_phase(&d->data));
    set_memory(d);
    set_filter(d);
    set(d, IE, 0);
    set(d, IR, IR_ALL);
    set(d, CCCR, mode);
    return wait_control(d, CCCR_INIT, 0);
}

/* ---- error states ---- */

/* Bus-off sets INIT by itself, and ends only after INIT was cleared. */
static enum can_state look(struct stm32_fdcan *d)
{
    uint32_t control = get(d, CCCR), status = get(d, PSR), errors = get(d, ECR);
    d->can.transmit_errors = (uint8_t)errors;
    d->can.receive_errors = errors & ECR_RECEIVE_PASSIVE ? CAN_PASSIVE_COUNT : errors >> 8 & 0x7F;
    d->protocol_exceptions += (status & PSR_PXE) != 0;
    if (status & PSR_BO)
        return CAN_OFF;
    if (control & (CCCR_INIT | CCCR_ASM))
        return d->can.state < CAN_OFF ? CAN_DOWN : d->can.state;
    if (status & PSR_EP)
        return CAN_PASSIVE;
    return status & PSR_EW ? CAN_WARNING : CAN_ACTIVE;
}

/* A controller that counts idle bits after bus-off is left alone: INIT is clear. */
static void restart(struct stm32_fdcan *d)
{
    if (!(get(d, CCCR) & CCCR_INIT))
        return;
    d->can.off_us = d->can.config.now_us(NULL);
    d->can.restarted += start(d);
}

static int watch(struct stm32_fdcan *d)
{
    bool overrun = (get(d, IR) & IR_RF0L) != 0;
    if (overrun)
        set(d, IR, IR_RF0L);
    int fault = can_see(&d->can, look(d), overrun);
    if (fault & (HAL_BUS_OFF | HAL_DOWN))
        (void)enter_configuration(d); /* drops what waits; if it fails, the restart finds out */
    else if (can_restart_due(&d->can))
        restart(d);
    return fault;
}

/* ---- the hal ---- */

/* False for what struct frame cannot hold: remote frames and CAN FD. */
static bool read_frame(struct stm32_fdcan *d, uint32_t at, struct frame *f)
{
    uint32_t head = get_ram(d, at), form = get_ram(d, at + 4), length = form >> LENGTH_SHIFT & 15;
    uint32_t word[2] = {get_ram(d, at + 8), get_ram(d, at + 12)};
    bool extended = (head & ELEMENT_EXTENDED) != 0;
    f->id = extended ? head & EXTENDED_MASK : head >> STANDARD_SHIFT & STANDARD_MASK;
    f->flags = extended ? FRAME_EXTENDED : 0;
    f->length = length <= FRAME_DATA ? (uint8_t)length : FRAME_DATA; /* 9..15 mean 8 */
    for (int i = 0; i < FRAME_DATA; i++)
        f->data[i] = i < f->length ? (uint8_t)(word[i / 4] >> 8 * (i % 4)) : 0;
    d->fd_frames += (form & ELEMENT_FD) != 0;
    return !(head & ELEMENT_REMOTE) && !(form & ELEMENT_FD);
}

static int receive(void *context, struct frame *f)
{
    struct stm32_fdcan *d = context;
    for (int i = 0; i < CAN_PASS_OVER; i++) {
        uint32_t status = get(d, RXF0S), index = status >> 8 & 0x3F;
        if (!(status & RXF0S_FILL))
            break;
        bool data = read_frame(d, RAM_RX + index * ELEMENT, f);
        set(d, RXF0A, index);
        if (data && can_is_ours(&d->can, f)) {
            d->can.received++;
            return 1;
        }
        d->can.passed_over++;
    }
    return -watch(d);
}

static void write_frame(const struct stm32_fdcan *d, uint32_t at, const struct frame *f)
{
    bool extended = (f->flags & FRAME_EXTENDED) != 0;
    uint32_t word[2] = {0, 0};
    for (int i = 0; i < FRAME_DATA; i++)
        word[i / 4] |= (uint32_t)f->data[i] << 8 * (i % 4);
    set_ram(d, at, extended ? ELEMENT_EXTENDED | f->id : f->id << STANDARD_SHIFT);
    set_ram(d, at + 4, (uint32_t)f->length << LENGTH_SHIFT);
    set_ram(d, at + 8, word[0]);
    set_ram(d, at + 12, word[1]);
}

static int transmit(void *context, const struct frame *f)
{
    struct stm32_fdcan *d = context;
    uint32_t status = get(d, TXFQS), index = status >> 16 & 0x1F;
    bool room = !(status & TXFQS_FULL) && status & TXFQS_FREE;
    if (d->can.state >= CAN_OFF || get(d, CCCR) & CCCR_INIT || !room) {
        d->can.refused++;
        return 0;
    }
    write_frame(d, RAM_TX + index * ELEMENT, f);
    set(d, TXBAR, 1u << index);
    d->can.sent++;
    return 1;
}

static void flush(void *context)
{
    (void)context; /* the controller sends by itself */
}

/* ---- open ---- */

static const char *check(const struct stm32_fdcan_config *c)
{
    const struct can_timing *t = &c->data;
    if (c->can.timing.segment1 < 2 || c->can.timing.segment2 < 2)
        return "this controller needs two quanta and more in each segment";
    if (t->prescaler > 0 && (t->prescaler > 32 || t->segment1 < 1 || t->segment1 > 32 || t->segment2 < 1 ||
                             t->segment2 > 16 || t->jump < 1 || t->jump > t->segment2))
        return "this controller cannot keep this timing of the data phase";
    if (c->ram_offset % 4 || c->ram_offset > STM32_FDCAN_RAM_BYTES - STM32_FDCAN_RAM)
        return "the message RAM has no room there: an offset in bytes, a multiple of 4, at most 8696";
    return NULL;
}

const char *stm32_fdcan_open(struct stm32_fdcan *d, struct registers registers, struct registers ram,
                             const struct stm32_fdcan_config *c)
{
    const char *why = can_open(&d->can, &c->can, &limits);
    if (!why)
        why = check(c);
    if (why)
        return why;
    d->registers = registers;
    d->ram = ram;
    d->data = c->data;
    d->ram_offset = c->ram_offset;
    d->fd_frames = d->protocol_exceptions = 0;
    d->hal = (struct hal){d, receive, transmit, flush, c->can.now_us, can_no_watchdog};
    if (get(d, ENDN) != ENDIANNESS)
        return "no FDCAN answers at its address: is its bus clock on?";
    return start(d) ? NULL : "the FDCAN does not change its mode: is its kernel clock on?";
}
