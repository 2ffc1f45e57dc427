/* lan9118_model.c - the LAN9118 after its data sheet; see lan9118_model.h. */
#include "tests/device/lan9118_model.h"

#include <string.h>

enum {
    RX_DATA = 0x00,
    TX_DATA = 0x20,
    RX_STATUS = 0x40,
    TX_STATUS = 0x48,
    BYTE_TEST = 0x64,
    RX_CFG = 0x6C,
    TX_CFG = 0x70,
    HW_CFG = 0x74,
    RX_FIFO_INF = 0x7C,
    TX_FIFO_INF = 0x80,
    RX_DROP = 0xA0,
    MAC_CSR_CMD = 0xA4,
    MAC_CSR_DATA = 0xA8
};
enum { MAC_CR = 1, MII_ACC = 6, MII_DATA = 7, RX_TX_ENABLED = 0xC, MUST_BE_ONE = 1 << 20, FCS = 4, SLOW = 5 };
enum { ONE_PIECE = 0x3000, LENGTH = 0x7FF, TX_OVERHEAD = 16 };
static const uint32_t busy = 0x80000000u, reading = 0x40000000u;

struct lan9118_model lan9118_model;
struct lan9118 lan9118_driver;
static struct lan9118_model *const m = &lan9118_model;

static bool running(void)
{
    return (m->mac[MAC_CR] & RX_TX_ENABLED) != 0;
}

/* ---- receiving ---- */

static uint32_t words(uint32_t bytes)
{
    return (bytes + 3) / 4;
}

void lan9118_model_arrive(uint32_t n, uint8_t seed, bool error)
{
    if (m->n_rx == LAN9118_MODEL_FRAMES) {
        m->dropped++;
        return;
    }
    uint32_t i = m->n_rx++;
    memset(m->rx[i].bytes, 0xFC, sizeof m->rx[i].bytes);
    for (uint32_t k = 0; k < n; k++)
        m->rx[i].bytes[k] = (uint8_t)(k + seed);
    m->rx[i].n = n + FCS;
    m->rx[i].status = (n + FCS) << 16 | (error ? 1u << 15 : 0);
}

static void next_frame(void)
{
    memmove(&m->rx[0], &m->rx[1], (LAN9118_MODEL_FRAMES - 1) * sizeof m->rx[0]);
    m->n_rx--;
}

/* The data of a frame wait from when its status is read. */
static uint32_t read_status(void)
{
    m->illegal += m->n_rx == 0 || m->rx_words_left > 0;
    if (m->n_rx == 0)
        return 0;
    m->rx_words_left = words(m->rx[0].n);
    return m->rx[0].status;
}

static uint32_t read_data(void)
{
    uint32_t word = 0;
    m->illegal += m->rx_words_left == 0;
    if (m->rx_words_left == 0)
        return 0;
    memcpy(&word, m->rx[0].bytes + 4 * (words(m->rx[0].n) - m->rx_words_left), 4);
    if (--m->rx_words_left == 0)
        next_frame();
    return word;
}

/* ---- sending ---- */

static void send_frame(void)
{
    uint32_t n = m->tx_words[1] & LENGTH;
    m->illegal += m->tx_words[0] != (ONE_PIECE | n) || n > ETHERNET_MAX;
    memcpy(m->sent, &m->tx_words[2], n < ETHERNET_MAX ? n : ETHERNET_MAX);
    m->sent_bytes = n;
    m->n_sent++;
    m->tx_statuses++;
    m->n_tx = 0;
}

static void write_data(uint32_t value)
{
    m->illegal += !running() || (m->n_tx == 0 && m->tx_statuses == LAN9118_MODEL_STATUSES);
    if (m->n_tx == 0)
        m->illegal += m->tx_free < (value & LENGTH) + TX_OVERHEAD;
    m->tx_words[m->n_tx++] = value;
    if (m->n_tx >= 2 && m->n_tx == 2 + words(m->tx_words[1] & LENGTH))
        send_frame();
}

/* ---- MAC and PHY ---- */

static void mii(uint32_t value)
{
    m->illegal += m->mii_left > 0;
    m->mii_left = SLOW;
    if (value & 2)
        m->phy[value >> 6 & 31] = m->mac[MII_DATA];
    m->illegal += (value >> 11 & 31) != 1;
}

static void mac_command(uint32_t value)
{
    uint32_t which = value & 15;
    m->illegal += m->mac_left > 0 || !(value & busy);
    m->mac_left = SLOW;
    m->mac_commands++;
    if (value & reading) {
        m->reg[MAC_CSR_DATA / 4] = which == MII_ACC ? m->mii_left > 0 : m->mac[which];
        m->mii_left -= which == MII_ACC && m->mii_left > 0 && !m->mii_stuck;
        return;
    }
    m->illegal += which == MII_DATA && m->mii_left > 0;
    if (which == MII_ACC)
        mii(m->reg[MAC_CSR_DATA / 4]);
    m->mac[which] = m->reg[MAC_CSR_DATA / 4];
}

/* ---- registers ---- */

/* Everything but what is broken for good. */
static void forget(int with)
{
    uint32_t illegal = m->illegal, hangs = m->mac_hangs;
    bool absent = m->absent, stuck = m->stuck, mii_stuck = m->mii_stuck;
    memset(m, with, sizeof *m);
    m->illegal = illegal, m->mac_hangs = hangs;
    m->absent = absent, m->stuck = stuck, m->mii_stuck = mii_stuck;
    m->mac_commands = 0;
}

static uint32_t read_register(uintptr_t context, uint32_t offset)
{
    (void)context;
    if (m->reset_left > 0 && !m->stuck)
        m->reset_left--;
    m->illegal += m->reset_left > 0 && offset != HW_CFG && offset != BYTE_TEST;
    switch (offset) {
    case BYTE_TEST:
        return m->absent ? 0 : 0x87654321u;
    case HW_CFG:
        return m->reg[HW_CFG / 4] | (m->reset_left > 0);
    case RX_FIFO_INF:
        return m->n_rx << 16;
    case TX_FIFO_INF:
        return m->tx_statuses << 16 | m->tx_free;
    case RX_STATUS:
        return read_status();
    case RX_DATA:
        return read_data();
    case TX_STATUS:
        m->illegal += m->tx_statuses == 0;
        m->tx_statuses -= m->tx_statuses > 0;
        return 0;
    case RX_DROP: {
        uint32_t dropped = m->dropped;
        m->dropped = 0;
        return dropped;
    }
    case MAC_CSR_CMD:
        if (m->mac_hangs > 0 && m->mac_commands + 1 >= m->mac_hangs)
            return busy;
        m->mac_left -= m->mac_left > 0;
        return m->mac_left > 0 ? busy : 0;
    default:
        return m->reg[offset / 4];
    }
}

static void write_register(uintptr_t context, uint32_t offset, uint32_t value)
{
    (void)context;
    m->illegal += m->reset_left > 0;
    if (offset == HW_CFG && value & 1) {
        forget(0);
        m->tx_free = LAN9118_MODEL_TX_ROOM;
        m->reset_left = SLOW;
    } else if (offset == TX_DATA) {
        write_data(value);
    } else if (offset == MAC_CSR_CMD) {
        mac_command(value);
    } else {
        m->illegal += (offset == HW_CFG || offset == RX_CFG || offset == TX_CFG) && running();
        m->illegal += offset == HW_CFG && !(value & MUST_BE_ONE);
        m->illegal += offset == MAC_CSR_DATA && m->mac_left > 0;
        m->reg[offset / 4] = value;
    }
}

const char *lan9118_model_open(const uint8_t *mac)
{
    forget(0xA5);
    m->illegal = m->reset_left = 0;
    return lan9118_open(&lan9118_driver, (struct registers){0, read_register, write_register}, mac);
}
