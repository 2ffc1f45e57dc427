/* silent_bus.h - a bus that is there and silent: the frame's own work is what is timed or counted. */
#ifndef TESTS_SILENT_BUS_H
#define TESTS_SILENT_BUS_H

#include "hal/hal.h"

static int silent_recv(void *context, struct frame *f)
{
    (void)context, (void)f;
    return 0;
}
static int silent_send(void *context, const struct frame *f)
{
    (void)context, (void)f;
    return 1;
}
static void silent_nothing(void *context)
{
    (void)context;
}
static uint32_t silent_clock(void *context)
{
    (void)context;
    return 0;
}

static const struct hal silent_bus = {NULL,           silent_recv,  silent_send,
                                      silent_nothing, silent_clock, silent_nothing};

#endif
