/* i6300esb.c - the watchdog of Intel's 6300ESB; see i6300esb.h. */
#include "hal/device/i6300esb.h"

#include "hal/device/registers.h"

enum {
    SLOTS = 32,
    SLOT_SHIFT = 15, /* address of a slot's configuration space, function 0 */
    IDENTITY = 0x00,
    WATCHDOG = 0x25AB8086, /* device, vendor */
    COMMAND = 0x04,
    COMMAND_MEMORY = 1 << 1,
    RANGE = 0x10,
    CONFIG = 0x60,
    CONFIG_NO_INTERRUPT = 3, /* and a count of 2^15 cycles of 33 MHz, and the reset let through */
    LOCK = 0x68,
    LOCK_ENABLE = 1 << 1
};
/* In its memory range. */
enum {
    PRELOAD_1 = 0x0,
    PRELOAD_2 = 0x4,
    RELOAD = 0xC,
    RELOAD_NOW = 1 << 8,
    UNLOCK_1 = 0x80,
    UNLOCK_2 = 0x86
};

/* Before each write of another register. */
static void unlock(uintptr_t memory)
{
    struct registers r = registers_bytes(memory);
    r.write(r.context, RELOAD, UNLOCK_1);
    r.write(r.context, RELOAD, UNLOCK_2);
}

static void preload(uintptr_t memory, uint32_t which, uint32_t counts)
{
    struct registers r = registers_words(memory);
    unlock(memory);
    r.write(r.context, which, counts);
}

static bool find(uintptr_t config, uintptr_t *space)
{
    for (int slot = 0; slot < SLOTS; slot++) {
        *space = config + ((uintptr_t)slot << SLOT_SHIFT);
        struct registers r = registers_words(*space);
        if (r.read(r.context, IDENTITY) == WATCHDOG)
            return true;
    }
    return false;
}

bool i6300esb_open(uintptr_t config, uintptr_t memory, uint32_t milliseconds)
{
    uintptr_t space;
    if (!find(config, &space))
        return false;
    struct registers words = registers_words(space);
    struct registers halves = registers_halfwords(space), bytes = registers_bytes(space);
    words.write(words.context, RANGE, (uint32_t)memory);
    words.write(words.context, COMMAND, COMMAND_MEMORY);
    bytes.write(bytes.context, LOCK, 0);
    halves.write(halves.context, CONFIG, CONFIG_NO_INTERRUPT);
    preload(memory, PRELOAD_1, milliseconds / 2);
    preload(memory, PRELOAD_2, milliseconds / 2);
    bytes.write(bytes.context, LOCK, LOCK_ENABLE);
    return true;
}

void i6300esb_feed(uintptr_t memory)
{
    struct registers r = registers_halfwords(memory);
    unlock(memory);
    r.write(r.context, RELOAD, RELOAD_NOW);
}
