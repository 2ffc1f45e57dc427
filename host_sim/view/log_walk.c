/* log_walk.c - see log_walk.h. */
#include "host_sim/view/log_walk.h"

#include <math.h>
#include <string.h>

static void put_mark(const struct log_walk *w, struct log_mark m)
{
    if (w->mark)
        w->mark(w->context, &m);
}

/* A mark at the row that is being read. */
static struct log_mark mark_here(const struct log_walk *w, enum log_mark_kind kind, unsigned what)
{
    return (struct log_mark){.kind = kind,
                             .t_s = w->log.rows.row.t_s,
                             .what = what,
                             .n = 1.0,
                             .speed = (double)NAN,
                             .peak_force_N = (double)NAN};
}

static void take_event(void *context, const struct listen_event *e)
{
    struct log_walk *w = context;
    struct log_mark m = mark_here(w, e->touch ? LOG_MARK_TOUCHDOWN : LOG_MARK_LIFTOFF, e->contact);
    m.t_s = e->t_s;
    m.speed = e->speed;
    m.peak_force_N = e->peak_force_N;
    put_mark(w, m);
}

static void take_status(struct log_walk *w, const struct message *m)
{
    struct log_walk_plant now = w->plant;
    now.session = (unsigned)m->value[SESSION];
    now.faults = (unsigned)m->value[STATUS_FAULTS];
    now.state = (int)m->value[STATUS_STATE];
    if (now.session != w->plant.session)
        put_mark(w, mark_here(w, LOG_MARK_SESSION, now.session));
    if (now.state != w->plant.state)
        put_mark(w, mark_here(w, LOG_MARK_STATE, (unsigned)now.state));
    if (now.faults & ~w->plant.faults)
        put_mark(w, mark_here(w, LOG_MARK_FAULT, now.faults & ~w->plant.faults));
    w->plant = now;
}

static void take_reply(const struct log_walk *w, const struct message *m)
{
    struct log_mark mark = mark_here(w, LOG_MARK_REFUSAL, (unsigned)m->value[REPLY_MESSAGE]);
    mark.cause = (unsigned)m->value[REPLY_CAUSE];
    if (mark.cause != CAUSE_OK)
        put_mark(w, mark);
}

static void take_overrun(const struct log_walk *w, const struct message *m)
{
    struct log_mark mark = mark_here(w, LOG_MARK_OVERRUN, 0);
    mark.n = m->value[OVERRUN_MISSED];
    put_mark(w, mark);
}

/* Frames that were missing before the last message. */
static void tell_missing(struct log_walk *w)
{
    struct log_mark m = mark_here(w, LOG_MARK_MISSING, 0);
    m.n = (double)(w->log.rows.missing - w->plant.missing);
    w->plant.missing = w->log.rows.missing;
    if (m.n > 0.0)
        put_mark(w, m);
}

static void hear(void *context, const struct message *m)
{
    struct log_walk *w = context;
    tell_missing(w);
    if (m->kind == WIRE_STATUS)
        take_status(w, m);
    if (m->kind == WIRE_REPLY)
        take_reply(w, m);
    if (m->kind == WIRE_OVERRUN)
        take_overrun(w, m);
}

/* A copy of a walk hears for itself. */
static void listen_here(struct log_walk *w)
{
    w->log.hear = hear;
    w->log.rows.events.take = take_event;
    w->log.context = w->log.rows.events.context = w;
}

const char *log_walk_open(struct log_walk *w, const char *path, const char *interface,
                          const struct wire_scene *scene, double tick_s)
{
    memset(w, 0, sizeof *w);
    w->plant.state = -1;
    return decode_log_open(&w->log, path, interface, scene, tick_s);
}

int log_walk_next(struct log_walk *w, struct decode_row *row)
{
    listen_here(w);
    return decode_log_next(&w->log, row);
}

void log_walk_tell(const struct log_walk *w, struct log_walk_place *p)
{
    log_reader_tell(&w->log.log.reader, &p->file);
    p->rows = w->log.rows;
    p->plant = w->plant;
}

bool log_walk_go(struct log_walk *w, const struct log_walk_place *p)
{
    w->log.rows = p->rows;
    w->log.ended = false;
    w->plant = p->plant;
    return log_reader_seek(&w->log.log.reader, &p->file);
}
