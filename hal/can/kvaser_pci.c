/* kvaser_pci.c - finds Kvaser PCIcan cards and their SJA1000; see kvaser_pci.h. */
#include "hal/can/kvaser_pci.h"

enum {
    SLOTS = 32,
    SLOT_SHIFT = 15, /* address of a slot's configuration space, function 0 */
    IDENTITY = 0x00,
    KVASER = 0x840610E8u, /* device, vendor */
    COMMAND = 0x04,
    COMMAND_IO = 1 << 0,
    RANGE = 0x10,
    RANGES = 3,
    RANGE_BYTES = 0x100, /* more than any of them */
    CARD_BYTES = 0x1000
};
/* In the bridge's range. */
enum { INTERRUPTS = 0x38, INTERRUPTS_ON = 0x2000, TIMING = 0x60 };
static const uint32_t timing = 0x80808080u; /* pass-through as slow as the controllers need */

static int find(int i, uintptr_t config)
{
    for (int slot = 0; slot < SLOTS; slot++) {
        struct registers r = registers_words(config + ((uintptr_t)slot << SLOT_SHIFT));
        if (r.read(r.context, IDENTITY) == KVASER && i-- == 0)
            return slot;
    }
    return -1;
}

bool kvaser_pci_open(int i, uintptr_t config, uintptr_t io, struct registers *sja1000)
{
    int slot = find(i, config);
    if (slot < 0)
        return false;
    struct registers space = registers_words(config + ((uintptr_t)slot << SLOT_SHIFT));
    uint32_t at = (uint32_t)(i + 1) * CARD_BYTES; /* a range at 0 is none */
    for (uint32_t k = 0; k < RANGES; k++)
        space.write(space.context, RANGE + 4 * k, at + k * RANGE_BYTES);
    space.write(space.context, COMMAND, COMMAND_IO);
    struct registers bridge = registers_words(io + at);
    bridge.write(bridge.context, TIMING, timing);
    bridge.write(bridge.context, INTERRUPTS, INTERRUPTS_ON);
    *sja1000 = registers_bytes(io + at + RANGE_BYTES);
    return true;
}
