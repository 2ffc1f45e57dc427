/* sja1000_model.c - the SJA1000 after its data sheet; see sja1000_model.h. */
#include "tests/device/sja1000_model.h"

#include <string.h>

struct sja1000_model sja1000_model;
struct sja1000 sja1000_driver;

/* Addresses and bits as in the data sheet. */
enum {
    MOD = 0,
    CMR,
    SR,
    IR,
    IER,
    BTR0 = 6,
    BTR1,
    OCR,
    RXERR = 14,
    TXERR,
    ACR0 = 16,
    AMR0 = 20,
    FRAME_END = 29,
    CDR = 31
};
enum { RM = 1, AFM = 8 };
enum { RBS = 1, DOS = 2, TBS = 4, TCS = 8, RS = 16, TS = 32, ES = 64, BS = 128 };
enum { RI = 1, TI = 2, DOI = 8 };

static struct sja1000_model *at(uintptr_t context)
{
    return (struct sja1000_model *)context;
}

static void enter_reset(struct sja1000_model *m)
{
    m->mode |= RM;
    m->status = (uint8_t)((m->status & (BS | ES)) | TBS | TCS);
    m->events = 0;
    m->n_fifo = 0;
    m->sending = false;
}

static unsigned frame_bytes(uint8_t form)
{
    unsigned data = form & 15;
    data = data > 8 ? 8 : data;
    return (form & 0x80 ? 5u : 3u) + (form & 0x40 ? 0 : data);
}

/* ---- registers ---- */

static uint32_t read(uintptr_t context, uint32_t address)
{
    struct sja1000_model *m = at(context);
    uint8_t events = m->events;
    switch (address) {
    case MOD:
        return m->mode;
    case SR:
        return (uint32_t)m->status | (m->n_fifo > 0 ? RBS : 0);
    case IR:
        m->events = m->n_fifo > 0 ? RI : 0;
        return events;
    case RXERR:
        return m->rec;
    case TXERR:
        return m->tec;
    default:
        break;
    }
    if (address < ACR0 || address >= FRAME_END || m->mode & RM) {
        m->illegal++;
        return 0;
    }
    return m->fifo[address - ACR0];
}

static void write_mode(struct sja1000_model *m, uint8_t value)
{
    bool leaves = m->mode & RM && !(value & RM);
    if (m->stuck)
        return;
    if (!(m->mode & RM) && (value & 0x0E) != (m->mode & 0x0E))
        m->illegal++; /* listen only, self test and filter mode change in reset mode only */
    if (!(m->mode & RM) && value & RM)
        enter_reset(m);
    m->mode = value;
    m->illegal += leaves && !m->pelican;
}

static void release(struct sja1000_model *m)
{
    unsigned n = frame_bytes(m->fifo[0]);
    if (m->n_fifo == 0) {
        m->illegal++;
        return;
    }
    m->n_fifo -= n;
    memmove(m->fifo, m->fifo + n, m->n_fifo);
}

static void command(struct sja1000_model *m, uint8_t value)
{
    if (value & 1) {
        m->illegal += !(m->status & TBS) || m->mode & RM;
        m->sending = true;
        m->status = (uint8_t)((m->status & ~(TBS | TCS)) | TS);
    }
    if (value & 4)
        release(m);
    if (value & 8)
        m->status &= (uint8_t)~DOS;
    m->illegal += (value & ~13) != 0;
}

static void write_setting(struct sja1000_model *m, uint8_t *setting, uint8_t value)
{
    m->illegal += !(m->mode & RM);
    *setting = value;
}

static void write_frame(struct sja1000_model *m, uint32_t address, uint8_t value)
{
    uint32_t i = address - ACR0;
    if (!(m->mode & RM)) {
        m->illegal += !(m->status & TBS);
        m->tx[i] = value;
    } else if (i < 8) {
        *(i < 4 ? &m->code[i] : &m->mask[i - 4]) = value;
    } else {
        m->illegal++;
    }
}

static void write(uintptr_t context, uint32_t address, uint32_t word)
{
    struct sja1000_model *m = at(context);
    uint8_t value = (uint8_t)word;
    m->illegal += word > 0xFF || (!m->pelican && address != MOD && address != CDR);
    switch (address) {
    case MOD:
        write_mode(m, value);
        break;
    case CMR:
        command(m, value);
        break;
    case IER:
        m->enabled = value;
        break;
    case BTR0:
    case BTR1:
        write_setting(m, &m->timing[address - BTR0], value);
        break;
    case OCR:
        write_setting(m, &m->output, value);
        break;
    case CDR:
        write_setting(m, &m->clock, value);
        m->pelican = value & 0x80;
        break;
    default:
        if (address >= ACR0 && address < FRAME_END)
            write_frame(m, address, value);
        else
            m->illegal++;
    }
}

/* ---- the wire ---- */

static unsigned pack(const struct wire_frame *f, uint8_t *to)
{
    unsigned n = f->extended ? 5 : 3;
    uint32_t id = f->extended ? f->id << 3 : f->id << 21;
    to[0] = (uint8_t)((f->extended ? 0x80 : 0) | (f->remote ? 0x40 : 0) | f->dlc);
    for (unsigned i = 1; i < n; i++, id <<= 8)
        to[i] = (uint8_t)(id >> 24);
    if (!f->extended)
        to[2] |= (uint8_t)(f->remote << 4);
    else
        to[4] |= (uint8_t)(f->remote << 2);
    memcpy(to + n, f->data, 8);
    return frame_bytes(to[0]);
}

static bool equal(uint8_t mask, uint8_t code, uint8_t bits)
{
    return ((code ^ bits) & ~mask & 0xFF) == 0;
}

/* Two filters: 11 bits, remote and the first byte, or 11 bits and remote; for 29-bit frames 16 bits each. */
static bool accepts_dual(const struct sja1000_model *m, const struct wire_frame *f, const uint8_t *p)
{
    const uint8_t *c = m->code, *k = m->mask;
    if (f->extended)
        return (equal(k[0], c[0], p[1]) && equal(k[1], c[1], p[2])) ||
               (equal(k[2], c[2], p[1]) && equal(k[3], c[3], p[2]));
    bool has_data = !f->remote && f->dlc > 0;
    uint8_t first = has_data ? f->data[0] : 0, nibble = (uint8_t)(k[1] << 4 | (k[3] & 15));
    bool one = equal(k[0], c[0], p[1]) && equal(k[1] | 15, c[1], p[2]) &&
               (!has_data || equal(nibble, (uint8_t)(c[1] << 4 | (c[3] & 15)), first));
    return one || (equal(k[2], c[2], p[1]) && equal(k[3] | 15, c[3], p[2]));
}

static bool accepts_single(const struct sja1000_model *m, const struct wire_frame *f, const uint8_t *p)
{
    const uint8_t *c = m->code, *k = m->mask;
    bool id = equal(k[0], c[0], p[1]) && equal(f->extended ? k[1] : k[1] | 15, c[1], p[2]);
    if (f->extended)
        return id && equal(k[2], c[2], p[3]) && equal(k[3] | 3, c[3], p[4]);
    bool one = f->remote || f->dlc < 1 || equal(k[2], c[2], f->data[0]);
    return id && one && (f->remote || f->dlc < 2 || equal(k[3], c[3], f->data[1]));
}

static void arrive(const struct wire_frame *f)
{
    struct sja1000_model *m = &sja1000_model;
    uint8_t bytes[SJA1000_FRAME + 5];
    unsigned n = pack(f, bytes);
    bool pass = m->promiscuous || (m->mode & AFM ? accepts_single(m, f, bytes) : accepts_dual(m, f, bytes));
    if (m->mode & RM || m->status & BS || !pass)
        return;
    if (m->n_fifo + n > SJA1000_FIFO) {
        m->status |= DOS;
        m->events |= DOI;
        return;
    }
    memcpy(m->fifo + m->n_fifo, bytes, n);
    m->n_fifo += n;
    m->events |= RI;
}

static bool leave(struct wire_frame *f)
{
    struct sja1000_model *m = &sja1000_model;
    if (!m->sending || m->status & BS)
        return false;
    const uint8_t *p = m->tx;
    memset(f, 0, sizeof *f);
    f->extended = p[0] & 0x80;
    f->remote = p[0] & 0x40;
    f->dlc = p[0] & 15;
    f->id = f->extended ? ((uint32_t)p[1] << 24 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 8 | p[4]) >> 3
                        : ((uint32_t)p[1] << 8 | p[2]) >> 5;
    memcpy(f->data, p + (f->extended ? 5 : 3), f->dlc < 8 ? f->dlc : 8);
    m->sending = false;
    m->status = (uint8_t)((m->status & ~TS) | TBS | TCS);
    m->events |= TI;
    if (m->events & m->enabled)
        sja1000_service(&sja1000_driver); /* the interrupt */
    return true;
}

static void errors(unsigned transmit, unsigned receive)
{
    struct sja1000_model *m = &sja1000_model;
    bool off = transmit > 255, warning = transmit >= 96 || receive >= 96;
    m->tec = (uint8_t)(off ? 127 : transmit);
    m->rec = (uint8_t)receive;
    m->status = (uint8_t)((m->status & ~(BS | ES)) | (off ? BS : 0) | (off || warning ? ES : 0));
    if (off)
        enter_reset(m);
}

static void idle(void)
{
    struct sja1000_model *m = &sja1000_model;
    if (!(m->mode & RM))
        errors(0, 0); /* in reset mode bus-off stays */
}

static void upset(void)
{
    enter_reset(&sja1000_model);
}

static const char *open(const struct can_config *c)
{
    struct sja1000_model *m = &sja1000_model;
    const struct sja1000_config config = {.can = *c, .output = 0x1A};
    bool stuck = m->stuck, promiscuous = m->promiscuous;
    memset(m, 0, sizeof *m);
    m->stuck = stuck;
    m->promiscuous = promiscuous;
    m->mode = stuck ? 0 : RM;
    m->status = TBS | TCS;
    return sja1000_open(&sja1000_driver, (struct registers){(uintptr_t)m, read, write}, &config);
}

const struct can_device sja1000_device = {"sja1000",
                                          &sja1000_driver.hal,
                                          &sja1000_driver.can,
                                          1 + SJA1000_WAITING,
                                          SJA1000_FIFO / 11,
                                          &sja1000_model.illegal,
                                          &sja1000_model.stuck,
                                          &sja1000_model.promiscuous,
                                          open,
                                          arrive,
                                          leave,
                                          errors,
                                          idle,
                                          upset};
