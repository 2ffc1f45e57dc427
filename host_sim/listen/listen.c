/* listen.c - see listen.h. */
#include "host_sim/listen/listen.h"

#include <math.h>
#include "firmware/bus/wire_table.h"

enum { OVERTAKEN = 256 }; /* frames that a late SYNC may be behind the newest one */

uint64_t listen_nearest(uint64_t last, double low, int bits)
{
    uint64_t mask = (UINT64_C(1) << bits) - 1, up = ((uint64_t)low - last) & mask, down = mask + 1 - up;
    return up > mask / 2 && last >= down ? last - down : last + up;
}

uint64_t listen_extend(uint64_t last, const struct message *m, int field)
{
    return listen_nearest(last, m->value[field], wire_layout(m->kind)->field[field].bits);
}

/* The frame that the plant is in at least: FRAME has 16 bits only, and in a silence more may pass. A tick of
 * 0 says nothing: no SYNC came yet. */
static uint64_t expected_frame(uint32_t substeps, uint64_t frame, uint64_t tick, uint64_t next_tick)
{
    bool known = substeps && tick && next_tick > tick;
    return known ? frame + (next_tick - tick) / substeps : frame;
}

bool listen_sync(uint32_t substeps, const struct message *m, uint64_t *frame, uint64_t *tick)
{
    uint64_t next_tick = listen_extend(*tick, m, SYNC_TICK);
    uint64_t next = listen_extend(expected_frame(substeps, *frame, *tick, next_tick), m, SYNC_FRAME);
    uint64_t late = next < WIRE_COUNTER_STATES ? WIRE_COUNTER_STATES : OVERTAKEN;
    bool anew = next + late < *frame || next_tick + (uint64_t)OVERTAKEN * substeps < *tick;
    *frame = anew ? (uint64_t)m->value[SYNC_FRAME] : next;
    *tick = next_tick;
    return anew;
}

/* ---- events ---- */

void listen_events_end(struct listen_events *l)
{
    if (l->waits && l->take)
        l->take(l->context, &l->last);
    l->waits = false;
}

static void begin_event(struct listen_events *l, const struct message *m, uint64_t sync_tick)
{
    const double *v = m->value;
    uint64_t tick = listen_extend(sync_tick, m, EVENT_TIME_TICK);
    listen_events_end(l);
    l->last = (struct listen_event){.tick = tick,
                                    .fraction = v[EVENT_TIME_FRACTION],
                                    .t_s = ((double)tick + v[EVENT_TIME_FRACTION]) * l->tick_s,
                                    .touch = v[EVENT_TOUCH] > 0.0,
                                    .contact = (unsigned)v[EVENT_CONTACT],
                                    .speed = (double)NAN,
                                    .peak_force_N = (double)NAN};
    l->counter = m->counter;
    l->waits = true;
}

void listen_events_take(struct listen_events *l, const struct message *m, uint64_t tick)
{
    const double *v = m->value;
    if (m->kind == WIRE_EVENT_TIME)
        begin_event(l, m, tick);
    if (m->kind != WIRE_EVENT_DATA || m->counter != l->counter ||
        (unsigned)v[EVENT_CONTACT] != l->last.contact || (v[EVENT_TOUCH] > 0.0) != l->last.touch || !l->waits)
        return;
    l->last.has_data = true;
    l->last.speed = v[EVENT_DATA_SPEED];
    l->last.peak_force_N = v[EVENT_DATA_PEAK_FORCE];
    listen_events_end(l);
}
