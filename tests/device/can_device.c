/* can_device.c - CAN controllers as their data sheets describe them; see can_device.h. */
#include "tests/device/can_device.h"

#include "tests/unit/test.h"

uint32_t can_device_us;

uint32_t can_device_now(void *context)
{
    (void)context;
    return can_device_us;
}

void can_device_check(const char *name, const char *why)
{
    check_string(name, why ? why : "ready", "ready");
}

const struct can_config can_device_config = {.timing = {2, 5, 2, 1},
                                             .base_id = CAN_DEVICE_BASE,
                                             .restart_us = CAN_DEVICE_RESTART_US,
                                             .now_us = can_device_now};
