/* sja1000.c - the driver of the SJA1000 CAN controller; see sja1000.h. */
#include "hal/can/sja1000.h"

#include <string.h>

enum {
    MODE = 0,
    COMMAND = 1,
    STATUS = 2,
    EVENTS = 3, /* interrupts; reading clears all but the receive interrupt */
    EVENTS_ENABLED = 4,
    TIMING0 = 6,
    TIMING1 = 7,
    OUTPUT = 8,
    RX_ERRORS = 14,
    TX_ERRORS = 15,
    FILTER_CODE = 16, /* in reset mode; else the frame to send, or the oldest one received */
    FILTER_MASK = 20, /* a one means: do not compare */
    FRAME = 16,
    CLOCK = 31
};

enum { MODE_RESET = 1 << 0, MODE_SINGLE_FILTER = 1 << 3 };
enum { COMMAND_SEND = 1 << 0, COMMAND_RELEASE = 1 << 2, COMMAND_CLEAR_OVERRUN = 1 << 3 };
enum {
    STATUS_RX_WAITS = 1 << 0,
    STATUS_OVERRUN = 1 << 1,
    STATUS_TX_FREE = 1 << 2,
    STATUS_ERRORS = 1 << 6, /* a counter at the warning limit, 96 */
    STATUS_OFF = 1 << 7
};
enum { EVENT_RECEIVED = 1 << 0, EVENT_SENT = 1 << 1 };
enum { CLOCK_PELICAN = 1 << 7, CLOCK_BYPASS = 1 << 6, CLOCK_PIN_OFF = 1 << 3 };

/* The first byte of a frame; behind it two bytes of identifier, or four, left-aligned, and the data. */
enum { FORM_EXTENDED = 1 << 7, FORM_REMOTE = 1 << 6, FORM_LENGTH = 15 };

static const struct can_limits limits = {
    .prescaler_max = 128, .prescaler_step = 2, .segment1_max = 16, .segment2_max = 8, .jump_max = 4};

static uint32_t get(const struct sja1000 *d, uint32_t offset)
{
    return d->registers.read(d->registers.context, offset);
}

static void set(const struct sja1000 *d, uint32_t offset, uint32_t value)
{
    d->registers.write(d->registers.context, offset, value & 0xFF);
}

/* ---- start and restart ---- */

static bool change_mode(const struct sja1000 *d, uint32_t mode)
{
    bool done = false;
    for (int i = 0; i < CAN_TRIES && !done; i++) {
        set(d, MODE, mode); /* again and again: leaving reset mode may take the controller a while */
        done = (get(d, MODE) & MODE_RESET) == (mode & MODE_RESET);
    }
    return done;
}

static void set_filter(const struct sja1000 *d)
{
    uint8_t code[4], mask[4];
    uint32_t id = d->can.config.base_id, any = FRAME_IDS - 1;
    bool extended = d->can.config.extended;
    for (int i = 0; i < 4; i++) {
        int shift = extended ? 24 - 8 * i : 8 - 8 * (i % 2);
        code[i] = (uint8_t)(id << (extended ? 3 : 5) >> shift);
        mask[i] = (uint8_t)(any << (extended ? 3 : 5) >> shift);
    }
    if (extended) {
        mask[3] |= 0x03; /* below the remote bit: nothing */
    } else {
        mask[1] |= 0x0F; /* below the remote bits: data */
        mask[3] |= 0x0F;
    }
    for (uint32_t i = 0; i < 4; i++) {
        set(d, FILTER_CODE + i, code[i]);
        set(d, FILTER_MASK + i, mask[i]);
    }
}

/* From reset mode to operation; the controller joins the bus when that is idle, after bus-off 128 times. */
static bool start(const struct sja1000 *d)
{
    const struct can_timing *t = &d->can.config.timing;
    if (!change_mode(d, MODE_RESET))
        return false;
    set(d, CLOCK, CLOCK_PELICAN | CLOCK_BYPASS | CLOCK_PIN_OFF);
    set(d, EVENTS_ENABLED, 0);
    set(d, TIMING0, (t->jump - 1u) << 6 | (t->prescaler / 2 - 1u));
    set(d, TIMING1, (t->segment2 - 1u) << 4 | (t->segment1 - 1u));
    set(d, OUTPUT, d->output);
    set_filter(d);
    if (!change_mode(d, d->can.config.extended ? MODE_SINGLE_FILTER : 0))
        return false;
    set(d, EVENTS_ENABLED, EVENT_RECEIVED | EVENT_SENT);
    return true;
}

/* ---- frames ---- */

static void push(struct sja1000_queue *q, const struct frame *f)
{
    q->frame[(q->first + q->n++) % SJA1000_WAITING] = *f;
}

static void pop(struct sja1000_queue *q)
{
    q->first = (q->first + 1) % SJA1000_WAITING;
    q->n--;
}

/* False for a remote frame. */
static bool read_frame(const struct sja1000 *d, struct frame *f)
{
    uint32_t form = get(d, FRAME), length = form & FORM_LENGTH, id = 0;
    bool extended = (form & FORM_EXTENDED) != 0;
    uint32_t id_bytes = extended ? 4 : 2;
    memset(f, 0, sizeof *f);
    for (uint32_t i = 0; i < id_bytes; i++)
        id = id << 8 | get(d, FRAME + 1 + i);
    f->id = id >> (extended ? 3 : 5);
    f->flags = extended ? FRAME_EXTENDED : 0;
    f->length = length <= FRAME_DATA ? (uint8_t)length : FRAME_DATA; /* 9..15 mean 8 */
    for (uint32_t i = 0; i < f->length; i++)
        f->data[i] = (uint8_t)get(d, FRAME + 1 + id_bytes + i);
    return !(form & FORM_REMOTE);
}

static void write_frame(const struct sja1000 *d, const struct frame *f)
{
    bool extended = (f->flags & FRAME_EXTENDED) != 0;
    uint32_t id_bytes = extended ? 4 : 2, id = f->id << (extended ? 3 : 5);
    set(d, FRAME, (extended ? FORM_EXTENDED : 0u) | f->length);
    for (uint32_t i = 0; i < id_bytes; i++)
        set(d, FRAME + 1 + i, id >> 8 * (id_bytes - 1 - i));
    for (uint32_t i = 0; i < f->length; i++)
        set(d, FRAME + 1 + id_bytes + i, f->data[i]);
    set(d, COMMAND, COMMAND_SEND);
}

/* A frame stays in the controller while there is no room for it here. */
static void move_in(struct sja1000 *d)
{
    struct frame f;
    for (int i = 0; i < CAN_PASS_OVER && d->in.n < SJA1000_WAITING && get(d, STATUS) & STATUS_RX_WAITS; i++) {
        if (read_frame(d, &f) && can_is_ours(&d->can, &f))
            push(&d->in, &f);
        else
            d->can.passed_over++;
        set(d, COMMAND, COMMAND_RELEASE);
    }
}

static void move_out(struct sja1000 *d)
{
    while (d->out.n > 0 && get(d, STATUS) & STATUS_TX_FREE) {
        write_frame(d, &d->out.frame[d->out.first]);
        pop(&d->out);
        d->can.sent++;
    }
}

void sja1000_service(struct sja1000 *d)
{
    if (get(d, MODE) & MODE_RESET)
        return; /* where a frame is, reset mode has the filter */
    (void)get(d, EVENTS);
    move_in(d);
    move_out(d);
}

/* ---- error states ---- */

static enum can_state look(struct sja1000 *d)
{
    uint32_t status = get(d, STATUS);
    d->can.transmit_errors = (uint8_t)get(d, TX_ERRORS);
    d->can.receive_errors = (uint8_t)get(d, RX_ERRORS);
    if (status & STATUS_OFF)
        return CAN_OFF;
    if (get(d, MODE) & MODE_RESET)
        return d->can.state < CAN_OFF ? CAN_DOWN : d->can.state;
    if (d->can.transmit_errors >= CAN_PASSIVE_COUNT || d->can.receive_errors >= CAN_PASSIVE_COUNT)
        return CAN_PASSIVE;
    return status & STATUS_ERRORS ? CAN_WARNING : CAN_ACTIVE;
}

/* Bus-off puts the controller into reset mode by itself; out of it, it still counts idle bits before it is
 * back, and must not be disturbed. */
static void restart(struct sja1000 *d)
{
    if (!(get(d, MODE) & MODE_RESET))
        return;
    d->can.off_us = d->can.config.now_us(NULL);
    d->can.restarted += start(d);
}

static int watch(struct sja1000 *d)
{
    bool overrun = (get(d, STATUS) & STATUS_OVERRUN) != 0;
    if (overrun)
        set(d, COMMAND, COMMAND_CLEAR_OVERRUN);
    int fault = can_see(&d->can, look(d), overrun);
    if (fault & (HAL_BUS_OFF | HAL_DOWN))
        d->out.n = 0;
    else if (can_restart_due(&d->can))
        restart(d);
    return fault;
}

/* ---- the hal ---- */

static int receive(void *context, struct frame *f)
{
    struct sja1000 *d = context;
    sja1000_service(d);
    if (d->in.n == 0)
        return -watch(d);
    *f = d->in.frame[d->in.first];
    pop(&d->in);
    d->can.received++;
    return 1;
}

static int transmit(void *context, const struct frame *f)
{
    struct sja1000 *d = context;
    sja1000_service(d);
    if (d->can.state >= CAN_OFF || d->out.n == SJA1000_WAITING) {
        d->can.refused++;
        return 0;
    }
    push(&d->out, f);
    sja1000_service(d);
    return 1;
}

static void flush(void *context)
{
    sja1000_service(context);
}

const char *sja1000_open(struct sja1000 *d, struct registers registers, const struct sja1000_config *c)
{
    const char *why = can_open(&d->can, &c->can, &limits);
    if (why)
        return why;
    d->registers = registers;
    d->output = c->output;
    d->in.first = d->in.n = d->out.first = d->out.n = 0;
    d->hal = (struct hal){d, receive, transmit, flush, c->can.now_us, can_no_watchdog};
    return start(d) ? NULL : "no SJA1000 answers at its address";
}
