/* test_registers.c - registers as memory: each width touches its own bytes and no other; and Kvaser cards
 * found in a configuration space that is memory too. */
#include "hal/can/kvaser_pci.h"
#include "tests/unit/test.h"

#include <stdlib.h>
#include <string.h>

/* 16 bytes 0x10, 0x11 .. 0x1F; the machines here are little-endian. */
static void fill(uint8_t *byte)
{
    for (int i = 0; i < 16; i++)
        byte[i] = (uint8_t)(0x10 + i);
}

static int changed(const uint8_t *byte)
{
    int n = 0;
    for (int i = 0; i < 16; i++)
        n += byte[i] != 0x10 + i;
    return n;
}

static void check_width(struct registers r, int width, uint32_t offset, uint32_t content)
{
    uint8_t *byte = (uint8_t *)r.context;
    fill(byte);
    check_hex("read", r.read(r.context, offset), content);
    check_int("which changes nothing", changed(byte), 0);
    r.write(r.context, offset, 0xA1B2C3D4u);
    for (int i = 0; i < width; i++)
        check_hex("a byte that was written", byte[offset + (uint32_t)i], 0xA1B2C3D4u >> 8 * i & 0xFF);
    check_int("bytes that changed", changed(byte), width);
}

TEST(registers_widths)
{
    static uint32_t memory[4];
    check_width(registers_words((uintptr_t)memory), 4, 8, 0x1B1A1918);
    check_width(registers_halfwords((uintptr_t)memory), 2, 6, 0x1716);
    check_width(registers_bytes((uintptr_t)memory), 1, 13, 0x1D);
}

/* ---- Kvaser cards ---- */

enum { KVASER_SLOTS = 32, KVASER_SLOT_WORDS = 0x8000 / 4, WINDOW_WORDS = 0x4000 / 4 };
static const uint32_t card = 0x840610E8u, other = 0x100E8086u;

/* Two cards in slots 3 and 31, another device in slot 2: the ranges of card i at (i + 1) 0x1000, first the
 * bridge, then the controllers. */
TEST(registers_kvaser)
{
    static uint32_t io[WINDOW_WORDS];
    uint32_t *config = calloc(KVASER_SLOTS, KVASER_SLOT_WORDS * sizeof *config);
    struct registers sja1000 = {0, NULL, NULL};
    check_true("memory", config != NULL);
    if (!config)
        return;
    memset(io, 0, sizeof io);
    check_true("an empty bus has none", !kvaser_pci_open(0, (uintptr_t)config, (uintptr_t)io, &sja1000));
    config[2 * KVASER_SLOT_WORDS] = other;
    config[3 * KVASER_SLOT_WORDS] = config[31 * KVASER_SLOT_WORDS] = card;
    for (uint32_t i = 0; i < 2; i++) {
        const uint32_t *space = config + (i ? 31 : 3) * KVASER_SLOT_WORDS, at = (i + 1) * 0x1000;
        check_true("a card", kvaser_pci_open((int)i, (uintptr_t)config, (uintptr_t)io, &sja1000));
        check_hex("the bridge's range", space[0x10 / 4], at);
        check_hex("the controllers'", space[0x14 / 4], at + 0x100);
        check_hex("the FPGA's", space[0x18 / 4], at + 0x200);
        check_hex("I/O is on", space[1], 1);
        check_hex("interrupts are let through", io[(at + 0x38) / 4], 0x2000);
        check_hex("timing", io[(at + 0x60) / 4], 0x80808080);
        sja1000.write(sja1000.context, 5, 0xEE);
        check_hex("the controller's registers are bytes side by side", io[(at + 0x104) / 4], 0xEE00);
    }
    check_true("there is no third", !kvaser_pci_open(2, (uintptr_t)config, (uintptr_t)io, &sja1000));
    check_hex("another device is left alone", config[2 * KVASER_SLOT_WORDS + 1], 0);
    free(config);
}
