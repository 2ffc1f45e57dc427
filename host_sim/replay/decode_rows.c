/* decode_rows.c - see decode_rows.h. */
#include "host_sim/replay/decode_rows.h"
#include "models/check.h"

#include <math.h>
#include <string.h>

void decode_begin(struct decode *d, const struct wire_scene *scene, double tick_s)
{
    memset(d, 0, sizeof *d);
    d->scene = *scene;
    d->tick_s = tick_s;
    d->identity = (double)NAN;
    for (int i = 0; i < DECODE_SIGNALS; i++)
        d->row.value[i] = (double)NAN;
}

const char *decode_open(struct decode *d, const char *path, const struct wire_scene *scene, double tick_s)
{
    decode_begin(d, scene, tick_s);
    return log_reader_open(&d->reader, path);
}

void decode_close(struct decode *d)
{
    log_reader_close(&d->reader);
}

/* The number at or after `last` with these low bits, or just before it. */
static uint64_t extend(uint64_t last, double low, int bits)
{
    uint64_t mask = (UINT64_C(1) << bits) - 1, up = ((uint64_t)low - last) & mask;
    return up > mask / 2 && last >= mask + 1 - up ? last - (mask + 1 - up) : last + up;
}

static void hear_sync(struct decode *d, const struct message *m)
{
    d->row.frame = extend(d->row.frame, m->value[SYNC_FRAME], 16);
    d->row.tick = extend(d->row.tick, m->value[SYNC_TICK], 32);
    d->row.t_s = (double)d->row.tick * d->tick_s;
    d->begun = true;
}

static void hear_event(struct decode *d, const struct message *m)
{
    if (m->kind == WIRE_EVENT_TIME) {
        uint64_t tick = extend(d->row.tick, m->value[EVENT_TIME_TICK], 32);
        d->event = (struct decode_event){.t_s = ((double)tick + m->value[EVENT_TIME_FRACTION]) * d->tick_s,
                                         .touch = m->value[EVENT_TOUCH] > 0.0,
                                         .contact = (unsigned)m->value[EVENT_CONTACT]};
        return;
    }
    d->event.speed = m->value[EVENT_DATA_SPEED];
    d->event.peak_force_N = m->value[EVENT_DATA_PEAK_FORCE];
    if (d->heard)
        d->heard(d->context, &d->event);
}

/* Takes output i, or that it is not available. */
static void take_output(struct decode_row *row, int i, double value)
{
    row->value[i] = value;
    row->beyond &= ~(1u << i);
    row->beyond |= isnan(value) ? 1u << i : 0u;
}

static void take_pair(struct decode_row *row, int i, const struct message *m)
{
    row->closed = (unsigned)m->value[CONTACT_IN_CONTACT];
    row->contact_known = true;
    take_output(row, i, m->value[CONTACT_PENETRATION]);
    take_output(row, i + 1, m->value[CONTACT_FORCE]);
}

STATIC_ASSERT((int)MOTION_IN_CONTACT == (int)CONTACT_IN_CONTACT &&
                  (int)MOTION_DISPLACEMENT == (int)CONTACT_PENETRATION &&
                  (int)MOTION_VELOCITY == (int)CONTACT_FORCE,
              pairs_are_alike);

static void hear(struct decode *d, const struct message *m)
{
    double *value = d->row.value;
    log_tally_hear(&d->tally, m);
    if (m->kind >= WIRE_STREAM && m->kind < WIRE_STREAM + MODEL_INPUTS)
        value[DECODE_OUTPUTS + m->kind - WIRE_STREAM] = m->value[STREAM_SAMPLE];
    else if (m->kind == WIRE_EVENT_TIME || m->kind == WIRE_EVENT_DATA)
        hear_event(d, m);
    else if (m->kind == WIRE_INFO && (int)m->value[INFO_ITEM] == INFO_IDENTITY)
        d->identity = m->value[INFO_VALUE];
    else if (m->kind == WIRE_STATUS)
        d->row.state = (int)m->value[STATUS_STATE];
    else if (m->kind == WIRE_MOTION || m->kind == WIRE_CONTACT)
        take_pair(&d->row, m->kind == WIRE_MOTION ? 0 : 2, m);
}

bool decode_take(struct decode *d, const struct message *m, struct decode_row *row)
{
    bool complete = d->begun && m->kind == WIRE_SYNC;
    *row = d->row;
    (m->kind == WIRE_SYNC ? hear_sync : hear)(d, m);
    return complete;
}

/* A row ends where the next SYNC begins one, or with the log. */
int decode_next(struct decode *d, struct decode_row *row)
{
    struct log_line line;
    struct message m;
    int got = 0;
    while (!d->ended && (got = log_read_line(&d->reader, &line)) > 0) {
        d->lines++;
        bool frame = line.fault == 0 && line.way != LOG_NO_ROOM && line.way != LOG_OVERRUN;
        if (!frame || wire_decode(&d->scene, &line.frame, &m) != WIRE_OK)
            continue;
        d->ours++;
        if (decode_take(d, &m, row))
            return 1;
    }
    bool last = !d->ended && got == 0 && d->begun;
    d->ended = true;
    *row = d->row;
    return got < 0 ? -1 : last;
}
