/* lan9118.c - the driver of the LAN9118 Ethernet controller; see lan9118.h. */
#include "hal/ethernet/lan9118.h"

#include <string.h>

/* The host bus registers. */
enum {
    RX_DATA = 0x00,
    TX_DATA = 0x20,
    RX_STATUS = 0x40,
    TX_STATUS = 0x48,
    INTERRUPT_ENABLE = 0x5C,
    BYTE_TEST = 0x64,
    RX_CONFIG = 0x6C,
    TX_CONFIG = 0x70,
    HW_CONFIG = 0x74,
    RX_INFO = 0x7C,
    TX_INFO = 0x80,
    RX_DROPPED = 0xA0,
    MAC_COMMAND = 0xA4,
    MAC_DATA = 0xA8,
    FLOW_CONTROL = 0xAC
};

/* Registers behind MAC_COMMAND, and of the PHY behind those. */
enum { MAC_CONTROL = 1, MAC_HIGH, MAC_LOW, MII_ACCESS = 6, MII_DATA = 7 };
enum { PHY_CONTROL = 0, PHY_ADVERTISE = 4, PHY_ADDRESS = 1 };

enum {
    TRIES = 100000,     /* looks until something must have answered */
    PHY_TRIES = 1000,   /* looks at the PHY, each through the MAC */
    STATUSES = 0xFF,    /* waiting, as shown in bits 16..23 of RX_INFO and TX_INFO */
    RX_LENGTH = 0x3FFF, /* bits 16..29 of a receive status, FCS included */
    RX_ERROR = 1 << 15, /* bit of a receive status */
    FCS = 4,
    TX_OVERHEAD = 16,       /* bytes of FIFO that the two command words and alignment take */
    TX_FREE = 0xFFFF,       /* bits of TX_INFO */
    TX_FIRST_LAST = 0x3000, /* bits of command word A: the frame is in one piece */
    TX_ON = 1 << 1,
    HW_RESET = 1 << 0,
    HW_SETTING = 0x00150000,   /* transmit FIFO of 5 KB, the bit that must be one */
    FLOW_SETTING = 0x006E3740, /* pauses the sender when 7 KB wait, as the data sheet suggests */
    MII_BUSY = 1 << 0,
    MII_WRITE = 1 << 1,
    PHY_FULL_DUPLEX =
        0x0141, /* advertise 100 and 10 Mbit/s full duplex only: MAC_CONTROL is then always right */
    PHY_NEGOTIATE = 0x1200, /* enable and restart */
    MAC_FULL_DUPLEX = 1 << 20,
    MAC_TX_RX = 0xC
};
static const uint32_t byte_test = 0x87654321u, mac_busy = 0x80000000u, mac_read = 0x40000000u;

static uint32_t get(const struct lan9118 *d, uint32_t offset)
{
    return d->registers.read(d->registers.context, offset);
}

static void set(const struct lan9118 *d, uint32_t offset, uint32_t value)
{
    d->registers.write(d->registers.context, offset, value);
}

/* ---- start ---- */

static bool wait_clear(const struct lan9118 *d, uint32_t reg, uint32_t bit)
{
    int i = 0;
    while (i < TRIES && (get(d, reg) & bit))
        i++;
    return i < TRIES;
}

static bool mac_write(const struct lan9118 *d, uint32_t reg, uint32_t value)
{
    if (!wait_clear(d, MAC_COMMAND, mac_busy))
        return false;
    set(d, MAC_DATA, value);
    set(d, MAC_COMMAND, mac_busy | reg);
    return wait_clear(d, MAC_COMMAND, mac_busy);
}

/* The wire to the PHY is slow, some 25 us a register, and takes one at a time. */
static bool wait_phy(const struct lan9118 *d)
{
    for (int i = 0; i < PHY_TRIES; i++) {
        set(d, MAC_COMMAND, mac_busy | mac_read | MII_ACCESS);
        if (!wait_clear(d, MAC_COMMAND, mac_busy))
            return false;
        if (!(get(d, MAC_DATA) & MII_BUSY))
            return true;
    }
    return false;
}

static bool phy_write(const struct lan9118 *d, uint32_t reg, uint32_t value)
{
    return mac_write(d, MII_DATA, value) &&
           mac_write(d, MII_ACCESS, PHY_ADDRESS << 11 | reg << 6 | MII_WRITE | MII_BUSY) && wait_phy(d);
}

static bool is_there(const struct lan9118 *d)
{
    int i = 0;
    while (i < TRIES && get(d, BYTE_TEST) != byte_test)
        i++;
    return i < TRIES;
}

static bool start(const struct lan9118 *d, const uint8_t *mac)
{
    uint32_t low = (uint32_t)mac[0] | (uint32_t)mac[1] << 8 | (uint32_t)mac[2] << 16 | (uint32_t)mac[3] << 24;
    set(d, HW_CONFIG, HW_RESET);
    if (!wait_clear(d, HW_CONFIG, HW_RESET))
        return false;
    set(d, HW_CONFIG, HW_SETTING);
    set(d, FLOW_CONTROL, FLOW_SETTING);
    set(d, INTERRUPT_ENABLE, 0);
    set(d, RX_CONFIG, 0);
    set(d, TX_CONFIG, TX_ON);
    return mac_write(d, MAC_LOW, low) && mac_write(d, MAC_HIGH, (uint32_t)mac[4] | (uint32_t)mac[5] << 8) &&
           phy_write(d, PHY_ADVERTISE, PHY_FULL_DUPLEX) && phy_write(d, PHY_CONTROL, PHY_NEGOTIATE) &&
           mac_write(d, MAC_CONTROL, MAC_FULL_DUPLEX | MAC_TX_RX);
}

/* ---- frames ---- */

/* Takes n bytes out of the FIFO, whole words; keeps them where `frame` is given. */
static void read_fifo(const struct lan9118 *d, uint8_t *frame, uint32_t n)
{
    for (uint32_t at = 0; at < n; at += 4) {
        uint32_t word = get(d, RX_DATA);
        if (frame)
            memcpy(frame + at, &word, n - at < 4 ? n - at : 4);
    }
}

static int receive(void *context, uint8_t *frame)
{
    struct lan9118 *d = context;
    if (!(get(d, RX_INFO) >> 16 & STATUSES)) {
        uint32_t dropped = get(d, RX_DROPPED); /* cleared by reading */
        d->dropped += dropped;
        return dropped ? -HAL_DROPPED : 0;
    }
    uint32_t status = get(d, RX_STATUS), n = status >> 16 & RX_LENGTH;
    if (status & RX_ERROR || n <= FCS || n > ETHERNET_MAX + FCS) {
        read_fifo(d, NULL, n);
        d->damaged++;
        return -HAL_FOREIGN;
    }
    read_fifo(d, frame, n - FCS);
    read_fifo(d, NULL, FCS);
    return (int)(n - FCS);
}

static bool transmit(void *context, const uint8_t *frame, size_t n)
{
    const struct lan9118 *d = context;
    for (uint32_t left = get(d, TX_INFO) >> 16 & STATUSES; left > 0; left--)
        (void)get(d, TX_STATUS); /* or the controller stops when they are many */
    if ((get(d, TX_INFO) & TX_FREE) < n + TX_OVERHEAD)
        return false;
    set(d, TX_DATA, TX_FIRST_LAST | (uint32_t)n);
    set(d, TX_DATA, (uint32_t)n);
    for (size_t at = 0; at < n; at += 4) {
        uint32_t word = 0;
        memcpy(&word, frame + at, n - at < 4 ? n - at : 4);
        set(d, TX_DATA, word);
    }
    return true;
}

const char *lan9118_open(struct lan9118 *d, struct registers registers, const uint8_t *mac)
{
    memset(d, 0, sizeof *d);
    d->registers = registers;
    d->ethernet = (struct ethernet){d, receive, transmit};
    if (!is_there(d))
        return "no LAN9118 answers at its address";
    return start(d, mac) ? NULL : "the LAN9118 does not start";
}
