/* test_lan9118.c - the Ethernet driver on a model of its controller.
 *
 * Tested are settings, frames of every length both ways, reports of loss, damaged frames, no room,
 * statuses that must be read, and a controller that is not there. */
#include <string.h>
#include "tests/device/lan9118_model.h"
#include "tests/unit/test.h"

static const struct ethernet *const lan9118_ethernet = &lan9118_driver.ethernet;
static const uint8_t mac[ETHERNET_MAC] = {0x52, 0x54, 0x00, 0x12, 0x34, 0x56};

static void open_lan9118(void)
{
    lan9118_model.absent = lan9118_model.stuck = lan9118_model.mii_stuck = false;
    lan9118_model.mac_hangs = 0;
    const char *why = lan9118_model_open(mac);
    check_string("open", why ? why : "ready", "ready");
}

static int hear_bytes(uint8_t *frame)
{
    return lan9118_ethernet->receive(lan9118_ethernet->context, frame);
}

static int wrong_bytes(const uint8_t *frame, uint32_t n, uint8_t seed)
{
    int wrong = 0;
    for (uint32_t k = 0; k < n; k++)
        wrong += frame[k] != (uint8_t)(k + seed);
    return wrong;
}

TEST(lan9118_settings)
{
    open_lan9118();
    check_hex("ADDRL", lan9118_model.mac[3], 0x12005452);
    check_hex("ADDRH", lan9118_model.mac[2], 0x5634);
    check_hex("MAC_CR: full duplex, both ways on", lan9118_model.mac[1], 0x0010000C);
    check_hex("PHY 4: full duplex offered", lan9118_model.phy[4], 0x0141);
    check_hex("PHY 0: negotiate", lan9118_model.phy[0], 0x1200);
    check_hex("HW_CFG: transmit FIFO of 5 KB", lan9118_model.reg[0x74 / 4], 0x00150000);
    check_hex("TX_CFG: on", lan9118_model.reg[0x70 / 4], 2);
    check_hex("RX_CFG", lan9118_model.reg[0x6C / 4], 0);
    check_hex("INT_EN: polled", lan9118_model.reg[0x5C / 4], 0);
    check_hex("AFC_CFG: pauses the sender", lan9118_model.reg[0xAC / 4], 0x006E3740);
    check_int("accesses that the data sheet forbids", lan9118_model.illegal, 0);
}

TEST(lan9118_receives)
{
    uint8_t frame[ETHERNET_MAX + 8];
    int wrong = 0;
    open_lan9118();
    check_int("nothing yet", hear_bytes(frame), 0);
    for (uint32_t n = ETHERNET_MIN; n <= ETHERNET_MAX; n++) {
        lan9118_model_arrive(n, (uint8_t)n, false);
        memset(frame, 0xEE, sizeof frame);
        wrong += hear_bytes(frame) != (int)n || wrong_bytes(frame, n, (uint8_t)n) || frame[n] != 0xEE;
    }
    check_int("frames of every length that came in wrong", wrong, 0);
    for (uint8_t i = 0; i < 5; i++)
        lan9118_model_arrive(61 + i, i, false);
    for (uint8_t i = 0; i < 5; i++)
        wrong += hear_bytes(frame) != 61 + i || frame[0] != i;
    check_int("frames that wait come in their order: wrong", wrong, 0);
    check_int("then none", hear_bytes(frame), 0);
    check_int("accesses that the data sheet forbids", lan9118_model.illegal, 0);
}

TEST(lan9118_damage)
{
    uint8_t frame[ETHERNET_MAX];
    open_lan9118();
    lan9118_model_arrive(100, 1, true);
    lan9118_model_arrive(ETHERNET_MAX + 1, 2, false);
    lan9118_model_arrive(8000, 3, false);
    lan9118_model_arrive(0, 4, false);
    lan9118_model_arrive(100, 5, false);
    for (int i = 0; i < 4; i++)
        check_int("damaged, longer than a frame may be, or empty", hear_bytes(frame), -HAL_FOREIGN);
    check_int("counted", lan9118_driver.damaged, 4);
    check_int("the good one behind them", hear_bytes(frame), 100);
    check_int("its bytes that differ", wrong_bytes(frame, 100, 5), 0);
    check_int("accesses that the data sheet forbids", lan9118_model.illegal, 0);
}

TEST(lan9118_loss)
{
    uint8_t frame[ETHERNET_MAX];
    int kept = 0;
    open_lan9118();
    for (uint8_t i = 0; i < LAN9118_MODEL_FRAMES + 3; i++)
        lan9118_model_arrive(60, i, false);
    while (hear_bytes(frame) == 60)
        kept += frame[0] == kept;
    check_int("the oldest are kept", kept, LAN9118_MODEL_FRAMES);
    check_int("lost ones counted", lan9118_driver.dropped, 3);
    lan9118_model_arrive(60, 0, false);
    lan9118_model.dropped = 2;
    check_int("a frame comes before the loss", hear_bytes(frame), 60);
    check_int("then it is told", hear_bytes(frame), -HAL_DROPPED);
    check_int("once", hear_bytes(frame), 0);
    check_int("and counted", lan9118_driver.dropped, 5);
    check_int("accesses that the data sheet forbids", lan9118_model.illegal, 0);
}

/* More than there are statuses. */
TEST(lan9118_sends)
{
    uint8_t frame[ETHERNET_MAX];
    int wrong = 0;
    open_lan9118();
    for (uint32_t k = 0; k < sizeof frame; k++)
        frame[k] = (uint8_t)(k + 7);
    for (uint32_t n = ETHERNET_MIN; n <= ETHERNET_MAX; n++)
        wrong += !lan9118_ethernet->transmit(lan9118_ethernet->context, frame, n) ||
                 lan9118_model.sent_bytes != n || memcmp(lan9118_model.sent, frame, n) != 0;
    check_int("frames of every length that went out wrong", wrong, 0);
    check_int("sent", lan9118_model.n_sent, ETHERNET_MAX - ETHERNET_MIN + 1);
    check_int("accesses that the data sheet forbids", lan9118_model.illegal, 0);
}

TEST(lan9118_no_room)
{
    uint8_t frame[ETHERNET_MAX] = {0};
    open_lan9118();
    lan9118_model.tx_free = 115;
    check_true("100 bytes and their commands do not fit into 115",
               !lan9118_ethernet->transmit(lan9118_ethernet->context, frame, 100));
    check_int("nothing was written", lan9118_model.n_tx, 0);
    lan9118_model.tx_free = 116;
    check_true("into 116 they do", lan9118_ethernet->transmit(lan9118_ethernet->context, frame, 100));
    check_int("accesses that the data sheet forbids", lan9118_model.illegal, 0);
}

TEST(lan9118_refuses)
{
    lan9118_model.absent = true, lan9118_model.stuck = false;
    check_string("nobody there", lan9118_model_open(mac), "no LAN9118 answers at its address");
    lan9118_model.absent = false, lan9118_model.stuck = true;
    check_string("a reset without end", lan9118_model_open(mac), "the LAN9118 does not start");
    lan9118_model.stuck = false;
    open_lan9118();
    uint32_t needed = lan9118_model.mac_commands;
    for (uint32_t k = 1; k <= needed + 1; k++) { /* the last one must have ended, too */
        lan9118_model.mac_hangs = k;
        check_string("a MAC without end", lan9118_model_open(mac), "the LAN9118 does not start");
        check_int("its commands", lan9118_model.mac_commands, k - 1);
    }
    lan9118_model.mac_hangs = 0, lan9118_model.mii_stuck = true;
    check_string("a PHY without end", lan9118_model_open(mac), "the LAN9118 does not start");
    check_hex("of which nothing was negotiated", lan9118_model.phy[0], 0);
    check_hex("and the MAC stays off", lan9118_model.mac[1], 0);
    check_int("accesses that the data sheet forbids", lan9118_model.illegal, 0);
    open_lan9118();
}
