/* log_bus.c - which bus frame each line of a log belongs to; see log_bus.h. */
#include "host_sim/replay/log_bus.h"

#include <string.h>
#include "hal/posix/log_read.h"

void log_bus_start(struct log_bus *b, struct plant_log *log, double frame_s)
{
    memset(b, 0, sizeof *b);
    b->log = log;
    b->scene = &log->scene;
    b->frame_s = frame_s;
}

static int refuse(struct log_bus *b, const char *what)
{
    struct log_reader *r = &b->log->reader;
    snprintf(r->reason, sizeof r->reason, "%.100s:%llu: %s", r->path, (unsigned long long)r->line, what);
    return -1;
}

/* The plant's message in this line; kind WIRE_KINDS when it is none. */
static struct message read_message(const struct log_bus *b, const struct log_line *line)
{
    struct message m = {.kind = WIRE_KINDS};
    if (line->fault || wire_decode(b->scene, &line->frame, &m) != WIRE_OK)
        m.kind = WIRE_KINDS;
    return m;
}

static bool is_ours(const struct log_bus *b, const struct log_line *line)
{
    bool extended = (line->frame.flags & FRAME_EXTENDED) != 0;
    return extended == b->scene->extended && line->frame.id - b->scene->base_id < WIRE_KINDS;
}

/* Messages that the plant takes or sends before the report that its SYNC begins. */
static bool stands_before_sync(const struct log_bus *b, const struct log_line *line)
{
    uint32_t kind = line->frame.id - b->scene->base_id;
    return line->fault || (is_ours(b, line) && (kind < WIRE_COMMANDS || kind == WIRE_REPLY));
}

static int add_to_list(struct log_bus *b, struct log_bus_list *list, const struct log_bus_line *line)
{
    if (list->n == LOG_BUS_LINES)
        return refuse(b, "more than 1024 lines without a SYNC of the plant; see --base-id and --extended");
    list->at[list->n++] = *line;
    return 1;
}

static bool is_command(const struct log_bus *b, const struct log_bus_line *line)
{
    return !line->line.fault && line->line.frame.id - b->scene->base_id < WIRE_COMMANDS;
}

/* Whether the caller's list names the line more often than it was held back. */
static bool is_deferred(const struct log_bus *b, const struct log_bus_line *line)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < b->n_deferred; i++)
        n += b->deferred[i] == line->number;
    return line->held < n;
}

static bool answers(const struct message *reply, const struct message *command)
{
    return reply->kind == WIRE_REPLY && reply->value[REPLY_MESSAGE] == (double)command->kind &&
           reply->value[REPLY_COUNTER] == (double)command->counter;
}

/* How many of `later` come up to the last command that has its REPLY behind it. */
static uint32_t beyond_doubt(const struct log_bus *b)
{
    uint32_t end = 0;
    for (uint32_t i = 0; i < b->later.n; i++) {
        struct message reply = read_message(b, &b->later.at[i].line);
        for (uint32_t k = i; reply.kind == WIRE_REPLY && k > end; k--) {
            struct message command = read_message(b, &b->later.at[k - 1].line);
            if (answers(&reply, &command))
                end = k;
        }
    }
    return end;
}

/* Moves to `open` what the frame of this SYNC has of `later`: all but a command that is deferred and those
 * behind it. The others that no REPLY puts beyond doubt are noted as doubtful. */
static void take_lines(struct log_bus *b, uint64_t time_us, uint64_t overrun_us)
{
    uint32_t n = b->later.n, certain = beyond_doubt(b);
    bool deferred = false;
    b->open.n = b->later.n = 0;
    for (uint32_t i = 0; i < n; i++) {
        struct log_bus_line *line = &b->later.at[i];
        bool command = is_command(b, line), doubtful = command && i >= certain;
        deferred = deferred || (doubtful && is_deferred(b, line));
        if (command && deferred) {
            line->held++;
            b->later.at[b->later.n++] = *line;
            continue;
        }
        if (doubtful)
            b->doubtful[b->n_doubtful++ % LOG_BUS_DOUBTFUL] = line->number;
        bool overrun = line->line.frame.id == b->scene->base_id + WIRE_OVERRUN;
        line->line.time_us = overrun ? overrun_us : time_us;
        b->open.at[b->open.n++] = *line;
    }
}

/* Whether the plant says that it missed frames from this one on; sort_line has put that first. */
static bool tells_overrun(const struct log_bus *b, uint64_t frame)
{
    struct message m = {.kind = WIRE_KINDS};
    if (b->later.n > 0)
        m = read_message(b, &b->later.at[0].line);
    return m.kind == WIRE_OVERRUN && (uint32_t)m.value[OVERRUN_FRAME] == (uint32_t)frame;
}

/* The bus frame of a SYNC, extended from 16 bits; -1 when it does not follow the one before. */
static int number_frame(struct log_bus *b, const struct message *sync)
{
    uint64_t expected = b->n_syncs ? b->frame + 1 : 0;
    uint16_t ahead = (uint16_t)((uint16_t)sync->value[SYNC_FRAME] - (uint16_t)expected);
    if (ahead && !tells_overrun(b, expected))
        return refuse(b, b->n_syncs
                             ? "a frame without SYNC: the setting sync_every must be 1, and no line lost"
                             : "the plant is past its first frame: start candump before the plant");
    b->frame = expected + ahead;
    b->n_syncs++;
    return 1;
}

/* A SYNC: the frame before is complete, that of the SYNC begins with what came before it. */
static int turn_frame(struct log_bus *b, struct log_bus_line *sync, const struct message *m)
{
    uint64_t overrun_us = log_frame_us(b->n_syncs ? b->frame + 1 : 0, b->frame_s);
    if (number_frame(b, m) < 0)
        return -1;
    uint64_t time_us = log_frame_us(b->frame, b->frame_s);
    b->out = b->open;
    b->i_out = 0;
    take_lines(b, time_us, overrun_us);
    sync->line.time_us = time_us;
    return add_to_list(b, &b->open, sync);
}

/* OVERRUN: it is told before the commands that came meanwhile are taken. */
static int put_first(struct log_bus *b, const struct log_bus_line *overrun)
{
    if (add_to_list(b, &b->later, overrun) < 0)
        return -1;
    memmove(b->later.at + 1, b->later.at, (b->later.n - 1) * sizeof b->later.at[0]);
    b->later.at[0] = *overrun;
    return 1;
}

/* Puts one line where it belongs; -1 and a reason when it cannot. */
static int sort_line(struct log_bus *b, struct log_bus_line *line)
{
    struct message m = read_message(b, &line->line);
    if (m.kind == WIRE_SYNC)
        return turn_frame(b, line, &m);
    if (m.kind == WIRE_OVERRUN)
        return put_first(b, line);
    if (stands_before_sync(b, &line->line))
        return add_to_list(b, &b->later, line);
    if (!is_ours(b, &line->line)) {
        b->passed_over++;
        return 1;
    }
    if (!b->n_syncs)
        return 1; /* the end of an earlier run */
    line->line.time_us = log_frame_us(b->frame, b->frame_s);
    return add_to_list(b, &b->open, line);
}

int log_bus_read(struct log_bus *b, struct log_line *out)
{
    struct log_bus_line line;
    while (b->i_out == b->out.n) { /* bounded by the file */
        struct message m;
        int got = plant_log_next(b->log, &line.line, &m);
        bool word = line.line.way == LOG_NO_ROOM || line.line.way == LOG_OVERRUN; /* not heard on a bus */
        line.number = b->log->reader.line;
        line.held = 0;
        if (got > 0 && !word)
            got = sort_line(b, &line);
        if (got <= 0)
            return got;
    }
    *out = b->out.at[b->i_out].line;
    b->number = b->out.at[b->i_out++].number;
    return 1;
}
