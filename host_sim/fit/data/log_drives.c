/* log_drives.c - see log_drives.h. */
#include "host_sim/fit/data/log_drives.h"

#include <math.h>
#include <string.h>
#include "host_sim/listen/listen.h"
#include "models/math/elementary.h"

#define BIT(field) (1u << (field))

static const double rounding = 1e-6; /* single precision on the bus */

void log_drives_begin(struct log_drives *d, double tick_s)
{
    memset(d, 0, sizeof *d);
    d->tick_s = tick_s;
    d->state = d->reaction = -1;
}

/* All tones may differ from here on. */
static bool forget(struct log_drives *d)
{
    for (int i = 0; i < MODEL_INPUTS; i++) {
        d->tone[i].told = 0;
        d->tone[i].begin_tick = (double)NAN;
    }
    return true;
}

static bool take_fire(struct log_drives *d, const struct message *m, uint64_t tick)
{
    unsigned channels = (unsigned)m->value[FIRE_CHANNELS];
    uint64_t at = listen_nearest(tick, m->value[FIRE_TICK], 32);
    for (int i = 0; i < MODEL_INPUTS; i++) {
        struct log_tone *t = &d->tone[i];
        if (!(channels >> i & 1u))
            continue;
        bool silent = (t->told & BIT(ARM_AMPLITUDE)) && t->value[ARM_AMPLITUDE] == 0.0;
        uint64_t settled = at + 1 + (uint64_t)(t->ramp_s / d->tick_s + 1.0);
        t->begin_tick = silent ? (double)at + m->value[FIRE_FRACTION] : (double)NAN;
        t->told = 0;
        t->ramp_s = 0.0;
        d->settled_tick = settled > d->settled_tick ? settled : d->settled_tick;
    }
    d->acts_tick = at;
    d->echoes = true;
    return true;
}

/* The field is told to be another one than before. */
static bool differs(const struct log_tone *t, unsigned field, double value)
{
    double off = value - t->value[field], turn = 2.0 * ELEMENTARY_PI;
    bool silent = t->value[ARM_AMPLITUDE] == 0.0 && field != ARM_AMPLITUDE && field != ARM_NOISE;
    if (field == ARM_PHASE)
        off -= turn * floor(off / turn + 0.5);
    if (!(t->told & BIT(field)) || silent || field == ARM_NOISE_HOLD || field == ARM_NOISE_SEED)
        return false;
    return !(fabs(off) <= rounding * fmax(fabs(value), field == ARM_PHASE ? turn : 0.0));
}

static bool take_echo(struct log_drives *d, const struct message *m, uint64_t tick)
{
    unsigned channel = (unsigned)m->value[DRIVE_ECHO_CHANNEL], field = (unsigned)m->value[DRIVE_ECHO_FIELD];
    double value = m->value[DRIVE_ECHO_VALUE];
    d->echoes = true;
    if (channel >= MODEL_INPUTS || field >= ARM_FIELDS || tick <= d->acts_tick)
        return false;
    struct log_tone *t = &d->tone[channel];
    if (field == ARM_RAMP) {
        uint64_t settled = tick + (uint64_t)(value / d->tick_s + 2.0);
        bool later = value > 0.0 && settled > d->settled_tick + 2;
        d->settled_tick = later ? settled : d->settled_tick;
        return later;
    }
    bool other = differs(t, field, value);
    if (other) {
        d->holds_tick = t->told_tick[field];
        t->told = 0;
        t->begin_tick = (double)NAN;
    }
    t->value[field] = t->told & BIT(field) ? t->value[field] : value;
    t->told |= BIT(field);
    t->told_tick[field] = tick;
    return other;
}

static bool moves(int state)
{
    return state == STATE_RUNNING || state == STATE_PAUSED;
}

/* A run that ends, or a reaction, moves the drives. */
static bool take_status(struct log_drives *d, const struct message *m, uint64_t tick)
{
    int state = (int)m->value[STATUS_STATE], reaction = (int)m->value[STATUS_REACTION];
    bool ends = moves(d->state) && !moves(state);
    bool reacts = d->reaction == 0 && reaction != 0;
    d->holds_tick = d->status_tick;
    d->status_tick = tick;
    d->state = state;
    d->reaction = reaction;
    return ends || reacts ? forget(d) : false;
}

bool log_drives_take(struct log_drives *d, const struct message *m, uint64_t tick)
{
    if (m->kind >= WIRE_ARM && m->kind < WIRE_ARM + MODEL_INPUTS && (int)m->value[ARM_FIELD] == ARM_RAMP)
        d->tone[m->kind - WIRE_ARM].ramp_s = m->value[ARM_VALUE];
    d->holds_tick = tick;
    if (m->kind == WIRE_SYNC && !d->begun) {
        for (int i = 0; i < MODEL_INPUTS && m->value[SYNC_TICK] > 0.0; i++)
            d->tone[i].begin_tick = (double)NAN; /* a FIRE may have been before */
        d->begun = true;
    }
    if (m->kind == WIRE_FIRE)
        return take_fire(d, m, tick);
    if (m->kind == WIRE_REPLY && (int)m->value[REPLY_MESSAGE] == WIRE_FIRE &&
        (int)m->value[REPLY_CAUSE] != CAUSE_OK)
        return forget(d);
    if (m->kind == WIRE_STATUS)
        return take_status(d, m, tick);
    return m->kind == WIRE_DRIVE_ECHO ? take_echo(d, m, tick) : m->kind == WIRE_PARAM_COMMIT;
}

bool log_drives_knows(const struct log_drives *d, int input)
{
    const unsigned needed = BIT(ARM_AMPLITUDE) | BIT(ARM_NOISE);
    const struct log_tone *t = &d->tone[input];
    bool sounds = t->value[ARM_AMPLITUDE] != 0.0;
    bool told = (t->told & needed) == needed && (!sounds || (t->told & BIT(ARM_FREQUENCY)));
    return told || !d->echoes;
}

double log_drives_phase(const struct log_drives *d, int input, uint64_t tick)
{
    const struct log_tone *t = &d->tone[input];
    if (!(t->told & BIT(ARM_PHASE)))
        return (double)NAN;
    double turns = ((double)tick - t->begin_tick) * d->tick_s * t->value[ARM_FREQUENCY];
    return t->value[ARM_PHASE] + 2.0 * ELEMENTARY_PI * (turns - floor(turns));
}
