/* cmsdk_watchdog.c - the watchdog of Arm's MPS2 boards; see cmsdk_watchdog.h. */
#include "hal/device/cmsdk_watchdog.h"

enum { LOAD = 0x000, CONTROL = 0x008, INTCLR = 0x00C, LOCK = 0xC00 };
enum { CONTROL_INTERRUPT = 1 << 0, CONTROL_RESET = 1 << 1, UNLOCK = 0x1ACCE551, LOCKED = 1 };

void cmsdk_watchdog_open(struct registers r, uint32_t counts)
{
    r.write(r.context, LOCK, UNLOCK);
    r.write(r.context, CONTROL, 0);
    r.write(r.context, LOAD, counts);
    r.write(r.context, INTCLR, 1);
    r.write(r.context, CONTROL, CONTROL_INTERRUPT | CONTROL_RESET);
    r.write(r.context, LOCK, LOCKED);
}

void cmsdk_watchdog_feed(struct registers r)
{
    r.write(r.context, LOCK, UNLOCK);
    r.write(r.context, INTCLR, 1);
    r.write(r.context, LOCK, LOCKED);
}
