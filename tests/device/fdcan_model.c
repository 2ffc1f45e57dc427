/* fdcan_model.c - the FDCAN controller of STM32H7 after RM0433; see fdcan_model.h. */
#include "tests/device/fdcan_model.h"

#include <string.h>

struct fdcan_model fdcan_model;
struct stm32_fdcan fdcan_driver;

/* Offsets and bits as in RM0433. */
enum {
    ENDN = 0x04,
    DBTP = 0x0C,
    CCCR = 0x18,
    NBTP = 0x1C,
    ECR = 0x40,
    PSR = 0x44,
    IR = 0x50,
    IE = 0x54,
    GFC = 0x80,
    SIDFC = 0x84,
    XIDFC = 0x88,
    XIDAM = 0x90,
    RXF0C = 0xA0,
    RXF0S = 0xA4,
    RXF0A = 0xA8,
    RXBC = 0xAC,
    RXF1C = 0xB0,
    RXESC = 0xBC,
    TXBC = 0xC0,
    TXFQS = 0xC4,
    TXESC = 0xC8,
    TXBAR = 0xD0,
    TXEFC = 0xF0
};
enum { INIT = 1, CCE = 2, ASM = 4, CSA = 8, CSR = 16, FDOE = 1 << 8, BRSE = 1 << 9 };
enum { RF0L = 1 << 3, BO = 1 << 25 };
enum { XTD = 1 << 30, RTR = 1 << 29, FDF = 1 << 21 };
enum { LOOKS = 3, ELEMENT = 16 };

static struct fdcan_model *at(uintptr_t context)
{
    return (struct fdcan_model *)context;
}

static uint32_t *reg(struct fdcan_model *m, uint32_t offset)
{
    return &m->reg[offset / 4];
}

static uint32_t rx_size(struct fdcan_model *m)
{
    return *reg(m, RXF0C) >> 16 & 0x7F;
}

static uint32_t tx_size(struct fdcan_model *m)
{
    return *reg(m, TXBC) >> 24 & 0x3F;
}

/* ---- modes ---- */

static void follow(struct fdcan_model *m)
{
    if (m->stuck || m->init == m->wanted_init)
        return;
    if (m->looks > 0) {
        m->looks--;
        return;
    }
    m->init = m->wanted_init;
    m->cce = m->cce && m->init;
    m->recovering = m->off && !m->init;
}

static void write_control(struct fdcan_model *m, uint32_t value)
{
    m->illegal += (value & ~(uint32_t)(INIT | CCE | CSR | FDOE | BRSE)) != 0;
    if (m->stuck)
        return;
    m->illegal += value & CCE && !m->init;
    if (m->cce && value & CCE)
        m->mode = (m->mode & ~(uint32_t)(FDOE | BRSE)) | (value & (FDOE | BRSE));
    m->mode &= value & CSR ? ~0u : ~(uint32_t)(CSA);
    m->mode &= ~(uint32_t)ASM;
    m->looks = (value & INIT) != (uint32_t)m->wanted_init ? LOOKS : m->looks;
    m->wanted_init = value & INIT;
    m->cce = value & CCE && m->init;
    if (m->cce) /* CCE resets these */
        m->get = m->n_rx = m->put = m->n_tx = 0;
}

/* ---- registers ---- */

static uint32_t protocol_status(struct fdcan_model *m)
{
    bool passive = m->tec >= 128 || m->rec >= 128, warning = m->tec >= 96 || m->rec >= 96;
    uint32_t value = 7u | (uint32_t)passive << 5 | (uint32_t)warning << 6 | (uint32_t)m->off << 7 |
                     (uint32_t)m->exception << 14;
    m->exception = false;
    return value;
}

static uint32_t error_counters(const struct fdcan_model *m)
{
    return (m->tec & 0xFF) | (m->rec < 128 ? m->rec : 127) << 8 | (uint32_t)(m->rec >= 128) << 15;
}

static uint32_t read(uintptr_t context, uint32_t offset)
{
    struct fdcan_model *m = at(context);
    m->reads++;
    switch (offset) {
    case ENDN:
        return m->absent ? 0 : 0x87654321;
    case CCCR:
        follow(m);
        return (uint32_t)m->init | (uint32_t)m->cce << 1 | m->mode;
    case PSR:
        return protocol_status(m);
    case ECR:
        return error_counters(m);
    case IR:
        return *reg(m, IR);
    case RXF0S:
        return m->n_rx | m->get << 8 | (uint32_t)(m->n_rx == rx_size(m)) << 24 | m->stuck_fill;
    case TXFQS:
        return (tx_size(m) - m->n_tx) | m->put << 16 | (uint32_t)(m->n_tx == tx_size(m)) << 21 |
               m->stuck_full;
    default:
        m->illegal++;
        return 0;
    }
}

static void acknowledge(struct fdcan_model *m, uint32_t index)
{
    m->illegal += m->n_rx == 0 || index != m->get;
    if (m->n_rx == 0)
        return;
    m->n_rx--;
    m->get = (m->get + 1) % rx_size(m);
}

static void request(struct fdcan_model *m, uint32_t bits)
{
    bool good = bits == 1u << m->put && m->n_tx < tx_size(m) && !m->init;
    m->illegal += !good;
    if (!good)
        return;
    m->n_tx++;
    m->put = (m->put + 1) % tx_size(m);
}

static void write(uintptr_t context, uint32_t offset, uint32_t value)
{
    struct fdcan_model *m = at(context);
    switch (offset) {
    case CCCR:
        write_control(m, value);
        break;
    case IR:
        *reg(m, IR) &= ~value;
        break;
    case IE:
        *reg(m, IE) = value;
        break;
    case RXF0A:
        acknowledge(m, value);
        break;
    case TXBAR:
        request(m, value);
        break;
    case DBTP:
    case NBTP:
    case GFC:
    case SIDFC:
    case XIDFC:
    case XIDAM:
    case RXF0C:
    case RXBC:
    case RXF1C:
    case RXESC:
    case TXBC:
    case TXESC:
    case TXEFC:
        m->illegal += !m->cce;
        *reg(m, offset) = m->cce ? value : *reg(m, offset);
        break;
    default:
        m->illegal++;
    }
}

/* ---- message RAM ---- */

static bool outside(const struct fdcan_model *m, uint32_t offset)
{
    return offset % 4 || offset < m->ram_offset || offset - m->ram_offset >= STM32_FDCAN_RAM;
}

static uint32_t read_ram(uintptr_t context, uint32_t offset)
{
    struct fdcan_model *m = at(context);
    m->illegal += outside(m, offset);
    return outside(m, offset) ? 0 : m->ram[offset / 4];
}

static void write_ram(uintptr_t context, uint32_t offset, uint32_t value)
{
    struct fdcan_model *m = at(context);
    m->illegal += outside(m, offset);
    if (!outside(m, offset))
        m->ram[offset / 4] = value;
}

static uint32_t *word(struct fdcan_model *m, uint32_t offset)
{
    return &m->ram[offset / 4 % FDCAN_MODEL_WORDS];
}

/* ---- the wire ---- */

/* By type: 0 a range, 1 one of two, 2 identifier and mask, 3 off (11 bits) or a range (29 bits). */
static bool matches(uint32_t type, uint32_t id, uint32_t first, uint32_t second, bool extended)
{
    if (type == 2)
        return (id & second) == (first & second);
    if (type == 1)
        return id == first || id == second;
    return (type == 0 || extended) && id >= first && id <= second;
}

/* Stored in receive FIFO 0 by the first filter that matches. */
static bool accepts(struct fdcan_model *m, const struct wire_frame *f)
{
    uint32_t global = *reg(m, GFC), list = *reg(m, f->extended ? XIDFC : SIDFC);
    if (m->promiscuous)
        return true;
    if (f->remote && global >> !f->extended & 1)
        return false;
    for (uint32_t i = 0; i < (list >> 16 & 0xFF); i++) {
        uint32_t from = (list & 0xFFFC) + i * (f->extended ? 8 : 4), a = *word(m, from),
                 b = *word(m, from + 4);
        if (f->extended && matches(b >> 30, f->id & *reg(m, XIDAM), a & 0x1FFFFFFF, b & 0x1FFFFFFF, true))
            return a >> 29 == 1;
        if (!f->extended && matches(a >> 30, f->id, a >> 16 & 0x7FF, a & 0x7FF, false))
            return (a >> 27 & 7) == 1;
    }
    return (global >> (f->extended ? 2 : 4) & 3) == 0;
}

static void store(const struct wire_frame *f, uint32_t form)
{
    struct fdcan_model *m = &fdcan_model;
    if (m->init || m->off || !accepts(m, f))
        return;
    if (m->n_rx == rx_size(m)) { /* blocking */
        *reg(m, IR) |= RF0L;
        return;
    }
    uint32_t to = (*reg(m, RXF0C) & 0xFFFC) + (m->get + m->n_rx) % rx_size(m) * ELEMENT;
    *word(m, to) = (f->extended ? (uint32_t)XTD | f->id : f->id << 18) | (f->remote ? RTR : 0);
    *word(m, to + 4) = (uint32_t)f->dlc << 16 | form | 0x1234;
    for (uint32_t i = 0; i < 8; i += 4)
        *word(m, to + 8 + i) = (uint32_t)f->data[i] | (uint32_t)f->data[i + 1] << 8 |
                               (uint32_t)f->data[i + 2] << 16 | (uint32_t)f->data[i + 3] << 24;
    m->n_rx++;
}

static void arrive(const struct wire_frame *f)
{
    store(f, 0);
}

void fdcan_model_arrive_fd(uint32_t id)
{
    struct wire_frame f = {.id = id, .dlc = 15, .data = {1, 2, 3, 4, 5, 6, 7, 8}};
    if (fdcan_model.mode & FDOE)
        store(&f, FDF | 1u << 20);
    else
        fdcan_model.rec++;
}

static bool leave(struct wire_frame *f)
{
    struct fdcan_model *m = &fdcan_model;
    if (m->n_tx == 0 || m->init || m->off)
        return false;
    uint32_t index = (m->put + tx_size(m) - m->n_tx) % tx_size(m);
    uint32_t from = (*reg(m, TXBC) & 0xFFFC) + index * ELEMENT, head = *word(m, from),
             form = *word(m, from + 4);
    f->extended = (head & XTD) != 0;
    f->remote = (head & RTR) != 0;
    f->id = f->extended ? head & 0x1FFFFFFF : head >> 18 & 0x7FF;
    f->dlc = form >> 16 & 15;
    m->illegal += (form & FDF) != 0 || (!f->extended && head & 0x3FFFF) || head >> 31;
    for (uint32_t i = 0; i < 8; i++)
        f->data[i] = (uint8_t)(*word(m, from + 8 + (i & 4)) >> 8 * (i % 4));
    m->n_tx--;
    return true;
}

static void errors(unsigned transmit, unsigned receive)
{
    struct fdcan_model *m = &fdcan_model;
    m->off = transmit > 255;
    m->tec = transmit;
    m->rec = receive;
    if (!m->off)
        return;
    m->init = m->wanted_init = true;
    m->recovering = false;
    *reg(m, IR) |= BO;
}

static void idle(void)
{
    if (fdcan_model.recovering)
        errors(0, 0);
}

/* ---- power ---- */

static void power_up(struct fdcan_model *m)
{
    memset(m->reg, 0, sizeof m->reg);
    memset(m->ram, 0xA5, sizeof m->ram);
    *reg(m, XIDAM) = 0x1FFFFFFF;
    m->init = m->wanted_init = true;
    m->cce = m->off = m->recovering = false;
    m->mode = 0;
    m->get = m->n_rx = m->put = m->n_tx = 0;
    m->tec = m->rec = 0;
}

static void upset(void)
{
    power_up(&fdcan_model);
}

const char *fdcan_model_open(const struct stm32_fdcan_config *c)
{
    struct fdcan_model *m = &fdcan_model;
    struct registers registers = {(uintptr_t)m, read, write}, ram = {(uintptr_t)m, read_ram, write_ram};
    power_up(m);
    m->ram_offset = c->ram_offset;
    m->illegal = m->reads = 0;
    return stm32_fdcan_open(&fdcan_driver, registers, ram, c);
}

static const char *open(const struct can_config *c)
{
    return fdcan_model_open(&(struct stm32_fdcan_config){.can = *c, .ram_offset = 0x400});
}

const struct can_device stm32_fdcan_device = {"stm32_fdcan",
                                              &fdcan_driver.hal,
                                              &fdcan_driver.can,
                                              STM32_FDCAN_TX,
                                              STM32_FDCAN_RX,
                                              &fdcan_model.illegal,
                                              &fdcan_model.stuck,
                                              &fdcan_model.promiscuous,
                                              open,
                                              arrive,
                                              leave,
                                              errors,
                                              idle,
                                              upset};
