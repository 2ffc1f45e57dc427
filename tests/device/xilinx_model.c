/* xilinx_model.c - the CAN controller of Zynq UltraScale+ after its manual; see xilinx_model.h. */
#include "tests/device/xilinx_model.h"

#include <string.h>

struct xilinx_model xilinx_model;
struct xilinx_can xilinx_driver;

/* Offsets and bits as in UG1087. */
enum {
    SRR = 0x00,
    MSR = 0x04,
    BRPR = 0x08,
    BTR = 0x0C,
    ECR = 0x10,
    SR = 0x18,
    ISR = 0x1C,
    IER = 0x20,
    ICR = 0x24,
    TXFIFO_ID = 0x30,
    TXFIFO_DATA2 = 0x3C,
    RXFIFO_ID = 0x50,
    RXFIFO_DATA2 = 0x5C,
    AFR = 0x60,
    AFMR1 = 0x64,
    AFIR4 = 0x80
};
enum { SRST = 1, CEN = 2 };
enum { RXOFLW = 1 << 6, RXNEMP = 1 << 7, BSOFF = 1 << 9 };
enum { JOINING = 3 };

static struct xilinx_model *at(uintptr_t context)
{
    return (struct xilinx_model *)context;
}

static uint32_t status(struct xilinx_model *m)
{
    uint32_t filter = m->filter_busy ? 1u << 11 : 0;
    if (!(m->reset & CEN))
        return 1 | filter;
    if (m->stuck || m->joining > 0) {
        m->joining -= m->joining > 0;
        return filter;
    }
    uint32_t estat = m->off ? 2 : m->tec >= 128 || m->rec >= 128 ? 3 : 1;
    uint32_t warning = m->tec >= 96 || m->rec >= 96;
    return 1u << 3 | warning << 6 | estat << 7 | (uint32_t)(m->n_tx == XILINX_FIFO) << 10 | filter;
}

static uint32_t take_rx(struct xilinx_model *m)
{
    if (m->n_rx == 0) {
        m->illegal++; /* RXUFLW */
        return 0;
    }
    memcpy(m->taken, m->rx[0], sizeof m->taken);
    m->n_rx--;
    memmove(m->rx[0], m->rx[1], m->n_rx * sizeof m->rx[0]);
    return m->taken[0];
}

static uint32_t read(uintptr_t context, uint32_t offset)
{
    struct xilinx_model *m = at(context);
    switch (offset) {
    case ECR:
        return m->rec << 8 | m->tec;
    case SR:
        return status(m);
    case ISR:
        m->events |= m->n_rx > 0 || m->rx_stuck ? RXNEMP : 0;
        return m->events;
    case RXFIFO_ID:
        return take_rx(m);
    default:
        if (offset > RXFIFO_ID && offset <= RXFIFO_DATA2)
            return m->taken[(offset - RXFIFO_ID) / 4];
        m->illegal++;
        return 0;
    }
}

static void write_reset(struct xilinx_model *m, uint32_t value)
{
    if (value & SRST) {
        if (m->stuck)
            return;
        m->reset = m->mode = m->prescaler = m->timing = m->enabled = m->events = 0; /* filters stay */
        m->tec = m->rec = m->n_tx = m->n_rx = m->n_part = m->joining = 0;
        m->off = false;
        return;
    }
    m->joining = value & CEN && !(m->reset & CEN) ? JOINING : m->joining;
    m->reset = value;
}

static void write_tx(struct xilinx_model *m, unsigned i, uint32_t value)
{
    m->illegal += i != m->n_part || m->n_tx == XILINX_FIFO || !(m->reset & CEN);
    m->part[i] = value;
    m->n_part = i + 1;
    if (m->n_part < 4)
        return;
    m->n_part = 0;
    if (m->n_tx < XILINX_FIFO)
        memcpy(m->tx[m->n_tx++], m->part, sizeof m->part);
}

static void write_filter(struct xilinx_model *m, uint32_t offset, uint32_t value)
{
    uint32_t i = (offset - AFMR1) / 8;
    m->illegal += m->filters >> i & 1 || m->filter_busy;
    *((offset - AFMR1) % 8 ? &m->id[i] : &m->mask[i]) = value;
}

static void write_setting(struct xilinx_model *m, uint32_t *setting, uint32_t value, uint32_t bits)
{
    m->illegal += (m->reset & CEN) || value & ~bits;
    *setting = value;
}

static void write(uintptr_t context, uint32_t offset, uint32_t value)
{
    struct xilinx_model *m = at(context);
    switch (offset) {
    case SRR:
        write_reset(m, value);
        break;
    case MSR:
        write_setting(m, &m->mode, value, 7);
        break;
    case BRPR:
        write_setting(m, &m->prescaler, value, 0xFF);
        break;
    case BTR:
        write_setting(m, &m->timing, value, 0x1FF);
        break;
    case IER:
        m->enabled = value;
        break;
    case ICR:
        m->events &= ~value;
        break;
    case AFR:
        m->filters = value;
        break;
    default:
        if (offset >= TXFIFO_ID && offset <= TXFIFO_DATA2)
            write_tx(m, (offset - TXFIFO_ID) / 4, value);
        else if (offset >= AFMR1 && offset <= AFIR4)
            write_filter(m, offset, value);
        else
            m->illegal++;
    }
}

/* ---- the wire ---- */

static uint32_t id_bits(const struct wire_frame *f)
{
    if (!f->extended)
        return f->id << 21 | (uint32_t)f->remote << 20;
    return (f->id >> 18) << 21 | 1u << 20 | 1u << 19 | (f->id & 0x3FFFF) << 1 | f->remote;
}

static bool accepts(const struct xilinx_model *m, uint32_t word)
{
    bool pass = m->promiscuous || m->filters == 0;
    for (int i = 0; i < 4; i++)
        pass = pass || (m->filters >> i & 1 && (m->mask[i] & word) == (m->mask[i] & m->id[i]));
    return pass;
}

static void arrive(const struct wire_frame *f)
{
    struct xilinx_model *m = &xilinx_model;
    uint32_t word = id_bits(f), *to = m->rx[m->n_rx % XILINX_FIFO];
    if (m->off || !(m->reset & CEN) || !accepts(m, word))
        return;
    if (m->n_rx == XILINX_FIFO) {
        m->events |= RXOFLW;
        return;
    }
    to[0] = word;
    to[1] = (uint32_t)f->dlc << 28 | 0x1234;
    to[2] = to[3] = 0;
    for (int i = 0; i < 8; i++)
        to[2 + i / 4] |= (uint32_t)f->data[i] << (24 - 8 * (i % 4));
    m->n_rx++;
}

static bool leave(struct wire_frame *f)
{
    struct xilinx_model *m = &xilinx_model;
    if (m->n_tx == 0 || m->off)
        return false;
    const uint32_t *from = m->tx[0];
    f->extended = from[0] >> 19 & 1;
    f->id = f->extended ? (from[0] >> 21) << 18 | (from[0] >> 1 & 0x3FFFF) : from[0] >> 21;
    f->remote = f->extended ? from[0] & 1 : from[0] >> 20 & 1;
    f->dlc = (uint8_t)(from[1] >> 28);
    m->illegal += f->extended && !(from[0] >> 20 & 1);
    for (int i = 0; i < 8; i++)
        f->data[i] = (uint8_t)(from[2 + i / 4] >> (24 - 8 * (i % 4)));
    m->n_tx--;
    memmove(m->tx[0], m->tx[1], m->n_tx * sizeof m->tx[0]);
    return true;
}

static void errors(unsigned transmit, unsigned receive)
{
    struct xilinx_model *m = &xilinx_model;
    m->off = transmit > 255;
    m->tec = m->off ? 0 : transmit;
    m->rec = receive;
    m->events |= m->off ? BSOFF : 0;
}

static void idle(void)
{
    errors(0, 0);
    xilinx_model.joining = 0;
}

static void upset(void)
{
    write_reset(&xilinx_model, SRST);
}

static const char *open(const struct can_config *c)
{
    struct xilinx_model *m = &xilinx_model;
    bool stuck = m->stuck, busy = m->filter_busy, promiscuous = m->promiscuous;
    memset(m, 0, sizeof *m);
    m->stuck = stuck;
    m->filter_busy = busy;
    m->promiscuous = promiscuous;
    return xilinx_can_open(&xilinx_driver, (struct registers){(uintptr_t)m, read, write}, c);
}

const struct can_device xilinx_device = {"xilinx",
                                         &xilinx_driver.hal,
                                         &xilinx_driver.can,
                                         XILINX_FIFO,
                                         XILINX_FIFO,
                                         &xilinx_model.illegal,
                                         &xilinx_model.stuck,
                                         &xilinx_model.promiscuous,
                                         open,
                                         arrive,
                                         leave,
                                         errors,
                                         idle,
                                         upset};
