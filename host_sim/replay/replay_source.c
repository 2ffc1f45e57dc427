/* replay_source.c - a recorded log as a hal; see replay_source.h. */
#include "host_sim/replay/replay_source.h"

#include <string.h>
#include "hal/posix/clock.h"

static bool same_frame(const struct frame *a, const struct frame *b)
{
    return a->id == b->id && a->flags == b->flags && a->length == b->length &&
           memcmp(a->data, b->data, a->length) == 0;
}

/* ---- what the app receives and sends ---- */

static int receive(void *context, struct frame *f)
{
    struct replay *r = context;
    if (r->i_command == r->n_commands)
        return 0;
    const struct replay_line *line = &r->command[r->i_command++];
    *f = line->frame;
    return line->fault ? -line->fault : 1;
}

static bool is_excluded(const struct replay *r, const struct frame *sent, const struct frame *recorded)
{
    struct message a, b;
    return r->excluded && sent->id == recorded->id && wire_decode(&r->scene, sent, &a) == WIRE_OK &&
           wire_decode(&r->scene, recorded, &b) == WIRE_OK && r->excluded(&a) && r->excluded(&b);
}

/* "ID#DATA": a log line without what stands before it and its end. */
static void describe(char *text, const struct frame *f)
{
    const struct log_line line = {.interface = "x", .frame = *f};
    int n = log_format(text, &line);
    const char *at = strrchr(text, ' ') + 1;
    text[n - 1] = 0;
    memmove(text, at, strlen(at) + 1);
}

static void differ(struct replay *r, const struct frame *sent, const struct replay_line *line)
{
    char was[LOG_LINE_MAX] = "nothing", now[LOG_LINE_MAX] = "nothing";
    if (r->differs)
        return;
    r->differs = true;
    if (line && line->refused)
        snprintf(was, sizeof was, "message 0x%02X, which was refused", (unsigned)line->frame.id);
    else if (line)
        describe(was, &line->frame);
    if (sent)
        describe(now, sent);
    uint64_t number = line ? line->number : r->number;
    snprintf(r->reason, sizeof r->reason, "%.200s:%llu: frame %llu: recorded %s, replay sent %s",
             r->log.reader.path, (unsigned long long)number, (unsigned long long)r->frame, was, now);
}

/* Whether the frame is the one that was refused: by number and bytes 2 to 7, or by number where it may
 * differ. */
static bool is_refused(const struct replay *r, const struct frame *f, const struct replay_line *line)
{
    struct message m;
    if (f->id - r->scene.base_id != line->frame.id)
        return false;
    bool excluded = wire_decode(&r->scene, f, &m) == WIRE_OK && r->excluded && r->excluded(&m);
    return excluded || memcmp(f->data + 2, line->frame.data + 2, FRAME_DATA - 2) == 0;
}

static int transmit(void *context, const struct frame *f)
{
    struct replay *r = context;
    if (r->i_telemetry == r->n_telemetry) {
        differ(r, f, NULL);
        return 1;
    }
    const struct replay_line *line = &r->telemetry[r->i_telemetry++];
    if (line->refused) {
        if (!is_refused(r, f, line))
            differ(r, f, line);
        r->compared++;
        return 0;
    }
    if (is_excluded(r, f, &line->frame))
        r->excluded_lines++;
    else if (same_frame(f, &line->frame))
        r->compared++;
    else
        differ(r, f, line);
    return 1;
}

static void flush(void *context)
{
    (void)context;
}

/* ---- loading ---- */

static int bad(struct replay *r, const char *what)
{
    snprintf(r->reason, sizeof r->reason, "%.200s:%llu: %s", r->log.reader.path,
             (unsigned long long)r->number, what);
    return -1;
}

/* Makes r->next the next line: 1, 0 at the end, -1 bad. */
static int read_ahead(struct replay *r)
{
    if (r->has_next || r->ended)
        return r->has_next;
    struct message m;
    int got = r->log.on_bus ? log_bus_read(&r->bus, &r->next) : plant_log_next(&r->log, &r->next, &m);
    r->number = r->log.on_bus ? r->bus.number : r->log.reader.line;
    r->passed_over += r->log.on_bus ? r->bus.passed_over : 0;
    r->bus.passed_over = 0;
    r->has_next = got > 0;
    r->ended = got == 0;
    if (got < 0)
        snprintf(r->reason, sizeof r->reason, "%s", r->log.reader.reason);
    return got;
}

/* Without marks: how many frame periods were missed, if this is an OVERRUN. */
static void note_overrun(struct replay *r, const struct frame *f)
{
    struct message m;
    if (wire_decode(&r->scene, f, &m) == WIRE_OK && m.kind == WIRE_OVERRUN)
        r->missed = (uint32_t)m.value[OVERRUN_MISSED];
}

static int append(struct replay *r, const struct replay_line *line, bool command)
{
    uint32_t *n = command ? &r->n_commands : &r->n_telemetry;
    if (*n == REPLAY_LINES)
        return bad(r, "more than 262144 lines in one bus frame");
    (command ? r->command : r->telemetry)[(*n)++] = *line;
    r->commands += command;
    if (!command && !r->log.marked)
        note_overrun(r, &line->frame);
    return 1;
}

/* Sorts r->next into the frame; 1, or -1 when it has too many lines. */
static int take_next(struct replay *r)
{
    const struct log_line *l = &r->next;
    uint32_t number = l->way == LOG_NO_ROOM ? l->frame.id : l->frame.id - r->scene.base_id;
    bool extended = (l->frame.flags & FRAME_EXTENDED) != 0;
    bool ours = l->way == LOG_NO_ROOM || (extended == r->scene.extended && number < WIRE_KINDS);
    bool received = r->log.marked && l->way == LOG_RECEIVED;
    bool sent = r->log.marked && (l->way == LOG_SENT || l->way == LOG_NO_ROOM);
    struct replay_line line = {r->number, l->frame, l->fault, l->way == LOG_NO_ROOM};
    r->has_next = false;
    if (l->way == LOG_OVERRUN) {
        r->missed = l->missed;
        return 1;
    }
    r->passed_over += !ours && !l->fault;
    if (!ours && !l->fault && !received)
        return 1;
    if (!l->fault && !r->log.marked && number == WIRE_SELF_TEST) {
        r->excluded_lines++;
        return 1;
    }
    return append(r, &line, l->fault || received || (!sent && number < WIRE_COMMANDS));
}

int replay_frame(struct replay *r, uint64_t frame)
{
    uint64_t stamp = log_frame_us(frame, r->frame_s);
    int got = read_ahead(r);
    r->frame = frame;
    r->n_commands = r->i_command = r->n_telemetry = r->i_telemetry = r->missed = 0;
    if (got <= 0)
        return got;
    while (got > 0 && r->next.time_us == stamp) { /* bounded by REPLAY_LINES and the file's end */
        if (take_next(r) < 0)
            return -1;
        got = read_ahead(r);
    }
    if (r->ended && r->log.reader.count[LOG_CUT])
        return 0; /* the rest of this bus frame is cut off */
    if (got > 0 && r->next.time_us < stamp)
        return bad(
            r, "the time stamp goes back, or is no multiple of the frame period: not recorded by a plant");
    return got < 0 ? -1 : 1;
}

const char *replay_check(struct replay *r)
{
    if (r->i_telemetry < r->n_telemetry)
        differ(r, NULL, &r->telemetry[r->i_telemetry]);
    return r->differs ? r->reason : NULL;
}

const char *replay_open(struct replay *r, const char *path, const char *interface,
                        const struct wire_scene *scene, double frame_s,
                        bool (*excluded)(const struct message *m))
{
    memset(r, 0, sizeof *r);
    r->hal = (struct hal){r, receive, transmit, flush, clock_now_us, clock_no_watchdog};
    r->scene = *scene;
    r->frame_s = frame_s;
    r->excluded = excluded;
    const char *reason = plant_log_open(&r->log, path, interface, scene);
    log_bus_start(&r->bus, &r->log, frame_s);
    return reason;
}

void replay_defer(struct replay *r, const uint64_t *number, uint32_t n)
{
    r->bus.deferred = number;
    r->bus.n_deferred = n;
}

void replay_close(struct replay *r)
{
    plant_log_close(&r->log);
}
