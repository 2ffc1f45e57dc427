/* can.c - the common code of the drivers of CAN controllers; see can.h. */
#include "hal/can/can.h"

#include <string.h>

enum { STANDARD_ID_MAX = 0x7FF, EXTENDED_ID_MAX = 0x1FFFFFFF };

const char *can_open(struct can *c, const struct can_config *config, const struct can_limits *limits)
{
    const struct can_timing *t = &config->timing;
    uint32_t id_max = config->extended ? EXTENDED_ID_MAX : STANDARD_ID_MAX;
    if (config->base_id % FRAME_IDS || config->base_id > id_max)
        return "the base identifier must be a multiple of 0x40 of 11 bits, or of 29 bits where extended";
    if (t->prescaler < 1 || t->prescaler > limits->prescaler_max || t->prescaler % limits->prescaler_step)
        return "this controller cannot divide its clock so";
    if (t->segment1 < 1 || t->segment1 > limits->segment1_max || t->segment2 < 1 ||
        t->segment2 > limits->segment2_max)
        return "this controller has no segments of so many quanta";
    if (t->jump < 1 || t->jump > limits->jump_max || t->jump > t->segment2)
        return "the synchronisation jump must fit into segment 2 and the controller";
    memset(c, 0, sizeof *c);
    c->config = *config;
    return NULL;
}

bool can_is_ours(const struct can *c, const struct frame *f)
{
    bool extended = (f->flags & FRAME_EXTENDED) != 0;
    return extended == c->config.extended && f->id - f->id % FRAME_IDS == c->config.base_id;
}

/* The fault bits of a state worse than the last one. */
static int worsen(struct can *c)
{
    if (c->state < CAN_OFF) {
        c->passive++;
        return HAL_ERROR_PASSIVE;
    }
    c->off_us = c->config.now_us(NULL);
    c->bus_off += c->state == CAN_OFF;
    c->down += c->state == CAN_DOWN;
    return c->state == CAN_OFF ? HAL_BUS_OFF : HAL_DOWN;
}

int can_see(struct can *c, enum can_state state, bool overrun)
{
    bool worse = state > c->state;
    c->state = state;
    c->dropped += overrun;
    return (overrun ? HAL_DROPPED : 0) | (worse ? worsen(c) : 0);
}

bool can_restart_due(const struct can *c)
{
    return c->state >= CAN_OFF && c->config.restart_us > 0 &&
           c->config.now_us(NULL) - c->off_us >= c->config.restart_us;
}

void can_no_watchdog(void *context)
{
    (void)context;
}
