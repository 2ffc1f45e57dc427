/* test_cmsdk_watchdog.c - the watchdog's driver against its registers after Arm DDI 0479.
 *
 * The counter interrupts at its first zero and resets at its second. While locked it refuses, and counts,
 * all writes but the lock's. */
#include <stdbool.h>
#include <string.h>
#include "hal/device/cmsdk_watchdog.h"
#include "tests/unit/test.h"

enum { LOAD = 0x000, VALUE = 0x004, CONTROL = 0x008, INTCLR = 0x00C, LOCK = 0xC00, COUNTS = 1000 };

static struct {
    uint32_t load, value, control;
    bool locked, interrupt, reset;
    uint32_t illegal;
} dog;

static uint32_t dog_read(uintptr_t context, uint32_t offset)
{
    (void)context;
    return offset == LOAD      ? dog.load
           : offset == VALUE   ? dog.value
           : offset == CONTROL ? dog.control
                               : dog.locked;
}

static void dog_write(uintptr_t context, uint32_t offset, uint32_t value)
{
    (void)context;
    if (offset == LOCK) {
        dog.locked = value != 0x1ACCE551;
        return;
    }
    dog.illegal += dog.locked || (offset != LOAD && offset != CONTROL && offset != INTCLR);
    if (dog.locked)
        return;
    if (offset == LOAD)
        dog.load = dog.value = value;
    if (offset == CONTROL)
        dog.control = value;
    if (offset == INTCLR)
        dog.interrupt = false;
    if (offset == INTCLR || (offset == CONTROL && (value & 1)))
        dog.value = dog.load;
}

static void pass(uint32_t counts)
{
    for (uint32_t i = 0; i < counts && (dog.control & 1); i++) {
        if (dog.value-- > 0)
            continue;
        dog.value = dog.load;
        dog.reset = dog.reset || (dog.interrupt && (dog.control & 2));
        dog.interrupt = true;
    }
}

static const struct registers registers = {0, dog_read, dog_write};

/* After power-on, or after a program that left it locked and with its interrupt raised. */
static void open_dog(bool used)
{
    memset(&dog, 0, sizeof dog);
    dog.load = dog.value = 0xFFFFFFFF;
    dog.locked = dog.interrupt = used;
    cmsdk_watchdog_open(registers, COUNTS);
}

TEST(cmsdk_watchdog_fed)
{
    open_dog(false);
    for (int i = 0; i < 10; i++) {
        pass(COUNTS);
        cmsdk_watchdog_feed(registers);
    }
    check_true("fed in time: no interrupt", !dog.interrupt);
    check_true("and no reset", !dog.reset);
    check_int("writes while locked, or to registers that take none", dog.illegal, 0);
    open_dog(true);
    pass(COUNTS);
    check_true("an interrupt from before is gone", !dog.interrupt);
    check_int("writes while locked", dog.illegal, 0);
}

TEST(cmsdk_watchdog_starved)
{
    open_dog(false);
    pass(COUNTS + 1);
    check_true("the interrupt after its counts", dog.interrupt);
    check_true("not yet the reset", !dog.reset);
    pass(COUNTS + 1);
    check_true("the reset after twice that", dog.reset);
}

TEST(cmsdk_watchdog_locked)
{
    open_dog(false);
    registers.write(0, CONTROL, 0);
    registers.write(0, LOAD, 0xFFFFFFFF);
    check_int("a stray write finds it locked", dog.illegal, 2);
    cmsdk_watchdog_feed(registers);
    registers.write(0, CONTROL, 0);
    check_int("also after a feed", dog.illegal, 3);
    check_int("so it runs on", (registers.read(0, CONTROL) & 3), 3);
    check_int("so it runs on", registers.read(0, VALUE), COUNTS);
}
