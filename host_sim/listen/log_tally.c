/* log_tally.c - see log_tally.h. HEALTH tells one counter at a time, so the last of a run may be missing in
 * it: what other messages said meanwhile counts where it is more. */
#include "host_sim/listen/log_tally.h"

static void raise(uint32_t *count, uint32_t heard)
{
    *count = *count < heard ? heard : *count;
}

static uint32_t whole(double x)
{
    return x < 4e9 ? (uint32_t)x : UINT32_MAX;
}

static void take_health(struct log_tally *t, const struct message *m)
{
    if (!(m->value[HEALTH_ITEM] < DIAG_COUNTERS))
        return;
    int i = (int)m->value[HEALTH_ITEM];
    t->known[i] = true;
    t->sensor_faults = t->sensor_faults || (i == DIAG_SENSOR_FAULTS && m->value[HEALTH_VALUE] > 0.0);
    t->count[i] = whole(m->value[HEALTH_VALUE]);
}

static void take_overrun(struct log_tally *t, const struct message *m)
{
    t->overruns++;
    t->missed += whole(m->value[OVERRUN_MISSED]);
}

/* A cause has the counter of its name. */
static void take_reply(struct log_tally *t, const struct message *m)
{
    unsigned cause = (unsigned)m->value[REPLY_CAUSE];
    if (cause > CAUSE_OK && cause < CAUSES)
        t->refused[cause]++;
}

void log_tally_take(struct log_tally *t, const struct message *m)
{
    if (m->kind == WIRE_HEALTH)
        take_health(t, m);
    if (m->kind == WIRE_OVERRUN)
        take_overrun(t, m);
    if (m->kind == WIRE_REPLY)
        take_reply(t, m);
    if (m->kind == WIRE_EVENT_SUMMARY)
        t->not_sent += m->value[SUMMARY_NOT_SENT];
    if (m->kind == WIRE_STATUS) {
        t->faults |= (unsigned)m->value[STATUS_FAULTS];
        raise(&t->count[DIAG_TIMEOUTS], (t->faults & FAULT_TIMEOUT) != 0);
    }
    raise(&t->count[DIAG_OVERRUNS], t->overruns);
    raise(&t->count[DIAG_FRAMES_MISSED], t->missed);
    for (int i = CAUSE_RANGE; i < CAUSES; i++)
        raise(&t->count[DIAG_RANGE + i - CAUSE_RANGE], t->refused[i]);
}

bool log_tally_is_complete(const struct log_tally *t)
{
    bool all = true;
    for (int i = 0; i < DIAG_COUNTERS; i++)
        all = all && t->known[i];
    return all;
}
