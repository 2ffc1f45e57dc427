/* decode_rows.c - see decode_rows.h. */
#include "host_sim/listen/decode_rows.h"
#include "host_sim/out/plural.h"
#include "models/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void decode_begin(struct decode *d, const struct wire_scene *scene, double tick_s)
{
    memset(d, 0, sizeof *d);
    d->scene = *scene;
    d->tick_s = d->events.tick_s = tick_s;
    d->row.state = -1;
    for (int i = 0; i < DECODE_SIGNALS; i++)
        d->row.value[i] = (double)NAN;
}

/* ---- missing frames ---- */

static bool is_echo(unsigned kind)
{
    return kind >= WIRE_STREAM_ECHO && kind < WIRE_STREAM_ECHO + MODEL_INPUTS;
}

/* SYNC, MOTION, CONTACT and STREAM_ECHO come at a steady pace. */
static bool is_steady(unsigned kind)
{
    return kind == WIRE_SYNC || kind == WIRE_MOTION || kind == WIRE_CONTACT || is_echo(kind);
}

/* Frames from the last one of this kind to one in this bus frame, at this tick. The plant's frames count
 * while its time runs, those of the bus while it stands. */
static double steps(const struct decode *d, const struct decode_counter *c, uint64_t frame, uint64_t tick)
{
    double ticks = (double)tick - (double)c->tick;
    return ticks != 0.0 || !d->scene.substeps ? ticks / fmax(1.0, d->scene.substeps)
                                              : (double)frame - (double)c->frame;
}

/* How many of a kind are missing before this one; below 0: it is none newer, but repeated or overtaken.
 * COUNTER tells it modulo 15, and where the pace is known, that tells the rest. */
static int64_t count_missing(const struct decode_counter *c, const struct message *m, double n_steps)
{
    int base = (m->counter + 2 * WIRE_COUNTER_STATES - c->counter - 1) % WIRE_COUNTER_STATES;
    if (!c->heard)
        return 0;
    if (!(c->every > 0.0))
        return base == WIRE_COUNTER_STATES - 1 ? -1 : base;
    double turns = floor((n_steps / c->every - 1.0 - base) / WIRE_COUNTER_STATES + 0.5);
    return base + (int64_t)fmax(turns, -1.0) * WIRE_COUNTER_STATES;
}

/* A pace that ends, or may: periods were missed, a setting was changed, the plant goes on or stands. */
static void note_pace(struct decode *d, const struct message *m)
{
    bool other = m->kind == WIRE_STATUS && (int)m->value[STATUS_STATE] != d->row.state;
    if (!other && m->kind != WIRE_OVERRUN && m->kind != WIRE_PARAM_ECHO)
        return;
    for (unsigned kind = 0; kind < WIRE_KINDS; kind++)
        if (is_steady(kind))
            d->counter[kind].every = -1.0;
}

/* A message of the plant in this bus frame, at this tick. Frames missing before it; -1: it is none newer. */
static int64_t note_counter(struct decode *d, const struct message *m, uint64_t frame, uint64_t tick)
{
    struct decode_counter *c = &d->counter[m->kind];
    double n_steps = steps(d, c, frame, tick);
    int64_t missing = count_missing(c, m, n_steps);
    if (missing < 0)
        return -1;
    if (is_steady(m->kind) && c->heard)
        c->every = c->every < 0.0 ? 0.0 : n_steps / (double)(missing + 1);
    d->missing += (uint64_t)missing;
    c->missing += (uint64_t)missing;
    c->heard = true;
    c->counter = m->counter;
    c->frame = frame;
    c->tick = tick;
    return missing;
}

/* ---- messages ---- */

/* The first one is the row's own. With SYNCs missing behind it, that is sure only where each has one. */
static bool is_sure(const struct decode_pair *p, int64_t missing_syncs)
{
    return p->came > 0 && (missing_syncs == 0 || p->came == 1 + (uint64_t)missing_syncs);
}

/* True where by its pace one of this kind was due at the row. */
static bool was_due(const struct decode *d, unsigned kind)
{
    const struct decode_counter *c = &d->counter[kind];
    return c->heard && c->every > 0.0 && steps(d, c, d->row.frame, d->row.tick) > c->every - 0.5;
}

static void finish_pair(const struct decode *d, int i, bool sure, struct decode_row *row)
{
    row->said[i] = sure;
    if (sure) {
        row->closed = d->pair[i].closed;
        row->contact_known = true;
        return;
    }
    row->due = row->due || was_due(d, WIRE_MOTION + (unsigned)i);
    row->value[2 * i] = row->value[2 * i + 1] = (double)NAN;
    row->beyond &= ~(3u << 2 * i);
}

/* The row as it is complete: without the pairs that may belong to a SYNC that is missing. */
static void finish_row(struct decode *d, int64_t missing_syncs, struct decode_row *row)
{
    *row = d->row;
    for (int i = 0; i < DECODE_PAIRS; i++)
        finish_pair(d, i, is_sure(&d->pair[i], missing_syncs), row);
}

static void begin_row(struct decode *d, uint64_t frame, uint64_t tick)
{
    d->row.frame = frame;
    d->row.tick = tick;
    d->row.t_s = (double)tick * d->tick_s;
    d->begun = true;
    memset(d->pair, 0, sizeof d->pair);
    for (int i = 0; i < MODEL_INPUTS; i++)
        if (d->row.echoed >> i & 1u)
            d->row.value[DECODE_OUTPUTS + i] = (double)NAN;
}

/* True where it completes a row. */
static bool take_sync(struct decode *d, const struct message *m, struct decode_row *row)
{
    uint64_t frame = d->row.frame, tick = d->row.tick;
    bool complete = d->begun, anew = listen_sync(d->scene.substeps, m, &frame, &tick);
    if (anew)
        memset(d->counter, 0, sizeof d->counter);
    int64_t missing = note_counter(d, m, frame, tick);
    if (missing < 0)
        return false;
    finish_row(d, missing, row);
    begin_row(d, frame, tick);
    d->row.run += anew;
    return complete;
}

/* Output i, or that it is not available. */
static void put_output(struct decode_row *row, int i, double value)
{
    row->value[i] = value;
    row->beyond &= ~(1u << i);
    row->beyond |= isnan(value) ? 1u << i : 0u;
}

STATIC_ASSERT((int)MOTION_IN_CONTACT == (int)CONTACT_IN_CONTACT &&
                  (int)MOTION_DISPLACEMENT == (int)CONTACT_PENETRATION &&
                  (int)MOTION_VELOCITY == (int)CONTACT_FORCE,
              pairs_are_alike);

static void take_pair(struct decode *d, const struct message *m, int i, int64_t missing)
{
    struct decode_pair *p = &d->pair[i];
    if (missing < 0)
        return;
    p->came += (p->came ? (unsigned)missing : 0) + 1;
    if (p->came > 1)
        return; /* it is a later SYNC's, which is missing */
    p->closed = (unsigned)m->value[MOTION_IN_CONTACT];
    put_output(&d->row, 2 * i, m->value[MOTION_DISPLACEMENT]);
    put_output(&d->row, 2 * i + 1, m->value[MOTION_VELOCITY]);
}

/* A sample on its way to input i. */
static void take_sample(struct decode *d, int i, double value)
{
    d->row.value[DECODE_OUTPUTS + i] = value;
    d->row.echoed &= ~(1u << i);
    d->streamed |= 1u << i;
}

/* The sample that the plant took, where nobody else tells it. */
static void take_echo(struct decode *d, const struct message *m, int i)
{
    uint64_t frame = d->row.tick / (d->scene.substeps ? d->scene.substeps : 1);
    if (d->streamed >> i & 1u)
        return;
    d->row.echoed |= 1u << i;
    if ((uint16_t)(frame - 1) == (uint16_t)m->value[STREAM_ECHO_FRAME])
        d->row.value[DECODE_OUTPUTS + i] = m->value[STREAM_ECHO_SAMPLE];
}

static void take_other(struct decode *d, const struct message *m)
{
    log_tally_take(&d->tally, m);
    if (m->kind < WIRE_COMMANDS) {
        if (m->kind >= WIRE_STREAM && m->kind < WIRE_STREAM + MODEL_INPUTS)
            take_sample(d, m->kind - WIRE_STREAM, m->value[STREAM_SAMPLE]);
        return;
    }
    note_pace(d, m);
    int64_t missing = note_counter(d, m, d->row.frame, d->row.tick);
    if (m->kind == WIRE_MOTION || m->kind == WIRE_CONTACT)
        take_pair(d, m, m->kind - WIRE_MOTION, missing);
    else if (is_echo(m->kind))
        take_echo(d, m, m->kind - WIRE_STREAM_ECHO);
    else if (m->kind == WIRE_STATUS)
        d->row.state = (int)m->value[STATUS_STATE];
    else
        listen_events_take(&d->events, m, d->row.tick);
}

bool decode_take(struct decode *d, const struct message *m, struct decode_row *row)
{
    if (m->kind == WIRE_SYNC)
        return take_sync(d, m, row);
    take_other(d, m);
    return false;
}

void decode_end(struct decode *d, struct decode_row *row)
{
    listen_events_end(&d->events);
    finish_row(d, 0, row);
}

void decode_tell_missing(const struct decode *d, const char *command, const char *where)
{
    if (d->missing)
        fprintf(stderr,
                "contactplant %s: %s: %llu frame%s of the plant %s missing (COUNTER, FRAME); their cells "
                "are empty\n",
                command, where, (unsigned long long)d->missing, plural((double)d->missing),
                d->missing == 1 ? "is" : "are");
}
