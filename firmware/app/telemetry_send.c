/* telemetry_send.c - messages on their way out, and those for which there was no room. */
#include "firmware/app/telemetry_send.h"

#include "firmware/app/app.h"

enum { TICKS_NOT_AVAILABLE = 65535 };

bool telemetry_waits(const struct telemetry *t, const struct app *a, unsigned kind)
{
    for (uint32_t i = 0; i < t->n_tx; i++) {
        if (t->tx[i].id == a->scene.base_id + kind)
            return true;
    }
    return false;
}

/* Keeps a frame behind all that wait, and drops an older frame of its identifier. So order is kept: SYNC
 * and EVENT_TIME still come before the messages that they date. There is a slot for each kind, so there is
 * always room. */
static void keep(struct telemetry *t, const struct frame *f)
{
    uint32_t n = 0;
    t->deferred++;
    for (uint32_t i = 0; i < t->n_tx; i++) {
        if (t->tx[i].id == f->id)
            t->replaced++;
        else
            t->tx[n++] = t->tx[i];
    }
    t->tx[n] = *f;
    t->n_tx = n + 1;
}

void telemetry_send_kept(struct telemetry *t, const struct app *a)
{
    uint32_t sent = 0;
    while (sent < t->n_tx && a->hal->send(a->hal->context, &t->tx[sent]))
        sent++;
    for (uint32_t i = sent; i < t->n_tx; i++)
        t->tx[i - sent] = t->tx[i];
    t->n_tx -= sent;
}

void telemetry_drop_kept(struct telemetry *t)
{
    t->replaced += t->n_tx;
    t->n_tx = 0;
}

void telemetry_send(struct telemetry *t, const struct app *a, const struct message *m)
{
    struct frame f;
    struct message counted = *m;
    counted.counter = t->tx_counter[m->kind];
    t->tx_counter[m->kind] = (uint8_t)((counted.counter + 1) % WIRE_COUNTER_STATES);
    wire_encode(&a->scene, &counted, &f);
    if (t->n_tx > 0 || !a->hal->send(a->hal->context, &f))
        keep(t, &f);
}

void telemetry_reply(struct telemetry *t, const struct app *a, const struct message *command,
                     enum cause cause, unsigned index, uint64_t ticks_late)
{
    struct message m = {.kind = WIRE_REPLY};
    m.value[SESSION] = a->session;
    m.value[REPLY_MESSAGE] = command->kind;
    m.value[REPLY_CAUSE] = cause;
    m.value[REPLY_COUNTER] = command->counter;
    m.value[REPLY_INDEX] = index;
    m.value[REPLY_TICKS_LATE] = ticks_late < TICKS_NOT_AVAILABLE ? (double)ticks_late : TICKS_NOT_AVAILABLE;
    telemetry_send(t, a, &m);
}
