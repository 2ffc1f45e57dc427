/* share.c - one bus for many plants; see share.h. */
#include "hal/link/share.h"

#include <string.h>

static int receive(void *context, struct frame *f)
{
    struct share_part *p = context;
    int fault = p->fault;
    p->fault = 0;
    if (fault)
        return -fault;
    if (p->i < p->n) {
        *f = p->queue[p->i++];
        return 1;
    }
    p->i = 0;
    p->n = 0;
    return 0;
}

static int transmit(void *context, const struct frame *f)
{
    const struct share_part *p = context;
    return p->bus->send(p->bus->context, f);
}

static uint32_t now_us(void *context)
{
    const struct share_part *p = context;
    return p->bus->now_us(p->bus->context);
}

/* The end of one plant's frame is not the end of the turn: share_flush is. */
static void wait_for_others(void *context)
{
    (void)context;
}

void share_init(struct share *s, const struct hal *bus, struct share_part *part, uint32_t n, uint32_t base_id,
                uint8_t flags, uint32_t n_urgent)
{
    *s = (struct share){.bus = bus, .part = part, .n_parts = n, .base_id = base_id, .n_urgent = n_urgent};
    s->flags = flags;
    for (uint32_t i = 0; i < n; i++) {
        struct share_part *p = &part[i];
        memset(p, 0, sizeof *p);
        p->bus = bus;
        p->hal = (struct hal){p, receive, transmit, wait_for_others, now_us, wait_for_others};
    }
}

/* Identifiers below the first one wrap to a plant that is not there. */
static void hand_out(struct share *s, const struct frame *f)
{
    uint32_t number = f->id - s->base_id, i = number / FRAME_IDS;
    if (i >= s->n_parts || f->flags != s->flags)
        return;
    struct share_part *p = &s->part[i];
    uint32_t room = number % FRAME_IDS < s->n_urgent ? SHARE_QUEUE + SHARE_URGENT : SHARE_QUEUE;
    if (p->n < room)
        p->queue[p->n++] = *f;
    else
        p->fault |= HAL_DROPPED;
}

void share_collect(struct share *s)
{
    struct frame f;
    int got = 1;
    for (int looks = 0; looks < SHARE_LOOKS && got; looks++) {
        got = s->bus->recv(s->bus->context, &f);
        if (got > 0)
            hand_out(s, &f);
        for (uint32_t i = 0; i < s->n_parts && got < 0; i++)
            s->part[i].fault |= -got;
    }
}

void share_flush(const struct share *s)
{
    s->bus->flush(s->bus->context);
    s->bus->healthy(s->bus->context);
}
