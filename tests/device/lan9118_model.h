/* lan9118_model.h - the LAN9118 after its data sheet (DS 1.5): registers on one side, an Ethernet on the
 * other.
 *
 * `illegal` counts each access that the data sheet forbids:
 * - any but HW_CFG and BYTE_TEST during a reset;
 * - the MAC or the PHY while it is busy;
 * - a receive FIFO read beyond its end;
 * - a transmit FIFO filled beyond its room or a packet's length;
 * - settings while it runs.
 *
 * Operations that are slow in the data sheet are slow here. */
#ifndef TESTS_LAN9118_MODEL_H
#define TESTS_LAN9118_MODEL_H

#include "hal/ethernet/lan9118.h"

enum {
    LAN9118_MODEL_FRAMES = 8,
    LAN9118_MODEL_TX_ROOM = 4608, /* bytes of a transmit FIFO of 5 KB */
    LAN9118_MODEL_STATUSES = 128  /* sent frames whose status nobody has read: then it sends no more */
};

struct lan9118_model {
    uint32_t illegal;
    bool absent, stuck; /* nobody there; a reset that does not end */
    bool mii_stuck;     /* the PHY stays busy */
    uint32_t mac_hangs; /* the MAC stays busy before this command, from 1; 0: it does not */
    uint32_t mac_commands;
    uint32_t reset_left, mac_left, mii_left; /* looks */
    uint32_t reg[64], mac[16], phy[32];
    struct {
        uint8_t bytes[16384];
        uint32_t n, status;
    } rx[LAN9118_MODEL_FRAMES];
    uint32_t n_rx, rx_words_left, dropped;
    uint32_t tx_words[2048], n_tx, tx_length, tx_free, tx_statuses;
    uint8_t sent[ETHERNET_MAX];
    uint32_t sent_bytes, n_sent;
};

extern struct lan9118_model lan9118_model;
extern struct lan9118 lan9118_driver;

/* Powers it up and opens the driver on it: what open says. */
const char *lan9118_model_open(const uint8_t *mac);

/* A frame of n bytes without FCS arrives, byte k being k +
 * seed; error: damaged on the way. Without room it is dropped. */
void lan9118_model_arrive(uint32_t n, uint8_t seed, bool error);

#endif
