/* xilinx_can.c - the driver of the CAN controller of Zynq devices; see xilinx_can.h. */
#include "hal/can/xilinx_can.h"

#include <string.h>

enum {
    RESET = 0x00,
    MODE = 0x04,
    PRESCALER = 0x08,
    TIMING = 0x0C,
    ERRORS = 0x10,
    STATUS = 0x18,
    EVENTS = 0x1C, /* interrupt status; interrupts stay off */
    EVENTS_ENABLED = 0x20,
    EVENTS_CLEAR = 0x24,
    TX_ID = 0x30, /* then length and two words of data: the last write queues the frame */
    RX_ID = 0x50, /* reading it takes a frame out of the FIFO; the three words behind it are that frame's */
    FILTERS = 0x60,
    FILTER_MASK = 0x64,
    FILTER_ID = 0x68
};

/* RESET and STATUS. */
enum { RESET_ALL = 1 << 0, RESET_RUN = 1 << 1 };
enum {
    SR_CONFIG = 1 << 0,
    SR_NORMAL = 1 << 3,
    SR_WARNING = 1 << 6,
    SR_STATE = 3 << 7, /* 0 configuration, then: */
    SR_OFF = 2 << 7,
    SR_PASSIVE = 3 << 7,
    SR_TX_FULL = 1 << 10,
    SR_FILTER_BUSY = 1 << 11
};

enum { EVENT_RX_OVERFLOW = 1 << 6, EVENT_RX_WAITS = 1 << 7, EVENT_OFF = 1 << 9, EVENT_ALL = 0x7FFF };

/* An identifier word: 11 high bits, remote (11-bit frames) or 1 (29-bit ones), format, 18 low bits, remote
 * (29-bit ones). */
enum {
    ID_HIGH_SHIFT = 21,
    ID_LOW_BITS = 18,
    ID_LOW_SHIFT = 1,
    ID_STANDARD_REMOTE = 1 << 20,
    ID_EXTENDED = 1 << 19,
    ID_EXTENDED_REMOTE = 1 << 0
};
enum { LENGTH_SHIFT = 28, STAMP = 0xFFFF };

static const struct can_limits limits = {
    .prescaler_max = 256, .prescaler_step = 1, .segment1_max = 16, .segment2_max = 8, .jump_max = 4};

static uint32_t get(const struct xilinx_can *d, uint32_t offset)
{
    return d->registers.read(d->registers.context, offset);
}

static void set(const struct xilinx_can *d, uint32_t offset, uint32_t value)
{
    d->registers.write(d->registers.context, offset, value);
}

/* ---- frames and identifier words ---- */

static uint32_t id_word(uint32_t id, bool extended)
{
    if (!extended)
        return id << ID_HIGH_SHIFT;
    uint32_t low = id & ((1u << ID_LOW_BITS) - 1);
    return id >> ID_LOW_BITS << ID_HIGH_SHIFT | ID_STANDARD_REMOTE | ID_EXTENDED | low << ID_LOW_SHIFT;
}

/* False for a remote frame. */
static bool unpack(const uint32_t word[4], struct frame *f)
{
    bool extended = (word[0] & ID_EXTENDED) != 0;
    uint32_t length = word[1] >> LENGTH_SHIFT, high = word[0] >> ID_HIGH_SHIFT;
    uint32_t low = word[0] >> ID_LOW_SHIFT & ((1u << ID_LOW_BITS) - 1);
    f->id = extended ? high << ID_LOW_BITS | low : high;
    f->flags = extended ? FRAME_EXTENDED : 0;
    f->length = length <= FRAME_DATA ? (uint8_t)length : FRAME_DATA; /* 9..15 mean 8 */
    for (int i = 0; i < FRAME_DATA; i++)
        f->data[i] = (uint8_t)(word[2 + i / 4] >> (24 - 8 * (i % 4)));
    return !(word[0] & (extended ? ID_EXTENDED_REMOTE : ID_STANDARD_REMOTE));
}

/* ---- start and restart ---- */

static bool wait_status(const struct xilinx_can *d, uint32_t bit, bool is)
{
    int i = 0;
    while (i < CAN_TRIES && ((get(d, STATUS) & bit) != 0) != is)
        i++;
    return i < CAN_TRIES;
}

static bool set_filter(const struct xilinx_can *d)
{
    const struct can_config *c = &d->can.config;
    uint32_t ids = id_word(~(uint32_t)(FRAME_IDS - 1) & (c->extended ? 0x1FFFFFFF : 0x7FF), c->extended);
    uint32_t remote = c->extended ? ID_EXTENDED_REMOTE : ID_STANDARD_REMOTE;
    set(d, FILTERS, 0);
    if (!wait_status(d, SR_FILTER_BUSY, false))
        return false;
    set(d, FILTER_MASK, ids | ID_EXTENDED | remote);
    set(d, FILTER_ID, id_word(c->base_id, c->extended));
    set(d, FILTERS, 1);
    return true;
}

/* From any state to where it joins the bus after 11 recessive bits. */
static bool start(const struct xilinx_can *d)
{
    const struct can_timing *t = &d->can.config.timing;
    set(d, RESET, RESET_ALL);
    if (!wait_status(d, SR_CONFIG, true))
        return false;
    set(d, EVENTS_ENABLED, 0);
    set(d, MODE, 0);
    set(d, PRESCALER, t->prescaler - 1u);
    set(d, TIMING, (t->jump - 1u) << 7 | (t->segment2 - 1u) << 4 | (t->segment1 - 1u));
    if (!set_filter(d))
        return false;
    set(d, EVENTS_CLEAR, EVENT_ALL);
    set(d, RESET, RESET_RUN);
    return true;
}

/* ---- error states ---- */

static enum can_state look(struct xilinx_can *d)
{
    uint32_t status = get(d, STATUS), errors = get(d, ERRORS);
    d->can.transmit_errors = (uint8_t)errors;
    d->can.receive_errors = (uint8_t)(errors >> 8);
    if (get(d, EVENTS) & EVENT_OFF || (status & SR_STATE) == SR_OFF)
        return CAN_OFF;
    if (!(status & SR_NORMAL))
        return d->can.state < CAN_OFF ? CAN_DOWN : d->can.state;
    if ((status & SR_STATE) == SR_PASSIVE)
        return CAN_PASSIVE;
    return status & SR_WARNING ? CAN_WARNING : CAN_ACTIVE;
}

static void restart(struct xilinx_can *d)
{
    d->can.off_us = d->can.config.now_us(NULL);
    d->can.restarted += start(d);
}

static int watch(struct xilinx_can *d)
{
    bool overrun = (get(d, EVENTS) & EVENT_RX_OVERFLOW) != 0;
    if (overrun)
        set(d, EVENTS_CLEAR, EVENT_RX_OVERFLOW);
    int fault = can_see(&d->can, look(d), overrun);
    if (fault & (HAL_BUS_OFF | HAL_DOWN))
        set(d, RESET, RESET_ALL); /* held in configuration, FIFOs empty; it would come back by itself */
    else if (can_restart_due(&d->can))
        restart(d);
    return fault;
}

/* ---- the hal ---- */

static bool take(struct xilinx_can *d, struct frame *f)
{
    uint32_t word[4];
    for (uint32_t i = 0; i < 4; i++)
        word[i] = get(d, RX_ID + 4 * i);
    set(d, EVENTS_CLEAR, EVENT_RX_WAITS); /* the controller sets it again while frames wait */
    d->received_stamp = (uint16_t)(word[1] & STAMP);
    return unpack(word, f) && can_is_ours(&d->can, f);
}

static int receive(void *context, struct frame *f)
{
    struct xilinx_can *d = context;
    for (int i = 0; i < CAN_PASS_OVER && get(d, EVENTS) & EVENT_RX_WAITS; i++) {
        if (take(d, f)) {
            d->can.received++;
            return 1;
        }
        d->can.passed_over++;
    }
    return -watch(d);
}

static int transmit(void *context, const struct frame *f)
{
    struct xilinx_can *d = context;
    uint32_t word[2] = {0, 0}, status = get(d, STATUS);
    if (!(status & SR_NORMAL) || status & SR_TX_FULL) {
        d->can.refused++;
        return 0;
    }
    for (int i = 0; i < FRAME_DATA; i++)
        word[i / 4] |= (uint32_t)f->data[i] << (24 - 8 * (i % 4));
    set(d, TX_ID, id_word(f->id, (f->flags & FRAME_EXTENDED) != 0));
    set(d, TX_ID + 4, (uint32_t)f->length << LENGTH_SHIFT);
    set(d, TX_ID + 8, word[0]);
    set(d, TX_ID + 12, word[1]);
    d->can.sent++;
    return 1;
}

static void flush(void *context)
{
    (void)context; /* the controller sends by itself */
}

const char *xilinx_can_open(struct xilinx_can *d, struct registers registers, const struct can_config *c)
{
    const char *why = can_open(&d->can, c, &limits);
    if (why)
        return why;
    d->registers = registers;
    d->received_stamp = 0;
    d->hal = (struct hal){d, receive, transmit, flush, c->now_us, can_no_watchdog};
    if (!start(d))
        return "the CAN controller does not enter its configuration mode: is its clock on?";
    (void)wait_status(d, SR_NORMAL, true); /* on a bus that is not idle it joins later, or watch says so */
    return NULL;
}
