/* telemetry_send.c - messages on their way out, and those for which there was no room; see telemetry.h. */
#include "firmware/telemetry.h"

#include "firmware/app.h"

enum { TICKS_NOT_AVAILABLE = 65535 };

bool telemetry_waits(const struct app *a, unsigned kind)
{
    for (uint32_t i = 0; i < a->n_tx; i++) {
        if (a->tx[i].id == a->scene.base_id + kind)
            return true;
    }
    return false;
}

/* Behind everything that waits; an older frame of its identifier goes. So nothing overtakes, and what dates a message
 * (SYNC, EVENT_TIME) still stands before it. There is a slot for each kind. */
static void keep(struct app *a, const struct frame *f)
{
    uint32_t n = 0;
    a->count[DIAG_TX_DEFERRED]++;
    for (uint32_t i = 0; i < a->n_tx; i++) {
        if (a->tx[i].id == f->id)
            a->count[DIAG_TX_REPLACED]++;
        else
            a->tx[n++] = a->tx[i];
    }
    a->tx[n] = *f;
    a->n_tx = n + 1;
}

void telemetry_send_kept(struct app *a)
{
    uint32_t sent = 0;
    while (sent < a->n_tx && a->hal->send(a->hal->context, &a->tx[sent]))
        sent++;
    for (uint32_t i = sent; i < a->n_tx; i++)
        a->tx[i - sent] = a->tx[i];
    a->n_tx -= sent;
}

void telemetry_send(struct app *a, const struct message *m)
{
    struct frame f;
    struct message counted = *m;
    counted.counter = a->tx_counter[m->kind];
    a->tx_counter[m->kind] = (uint8_t)((counted.counter + 1) % WIRE_COUNTER_STATES);
    wire_encode(&a->scene, &counted, &f);
    if (a->n_tx > 0 || !a->hal->send(a->hal->context, &f))
        keep(a, &f);
}

void telemetry_reply(struct app *a, const struct message *command, enum cause cause, unsigned index,
                     uint64_t ticks_late)
{
    struct message m = {.kind = WIRE_REPLY};
    m.value[SESSION] = a->session;
    m.value[REPLY_MESSAGE] = command->kind;
    m.value[REPLY_CAUSE] = cause;
    m.value[REPLY_COUNTER] = command->counter;
    m.value[REPLY_INDEX] = index;
    m.value[REPLY_TICKS_LATE] = ticks_late < TICKS_NOT_AVAILABLE ? (double)ticks_late : TICKS_NOT_AVAILABLE;
    telemetry_send(a, &m);
}
