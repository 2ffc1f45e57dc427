/* log.c - records the traffic of another hal as a candump log; see log.h. */
#include "hal/posix/log.h"
#include "hal/posix/file.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

uint64_t log_frame_us(uint64_t frame, double frame_s)
{
    return LOG_START_US + (uint64_t)((double)frame * frame_s * 1e6 + 0.5);
}

/* ---- writing ---- */

static int put_hex(char *text, uint32_t value, int digits)
{
    for (int i = digits - 1; i >= 0; i--, value >>= 4)
        text[i] = "0123456789ABCDEF"[value & 15];
    return digits;
}

/* The error frame that stands for hal_fault bits. */
static struct frame fault_frame(int fault)
{
    uint32_t class = fault & HAL_BUS_OFF ? LOG_ERROR_BUS_OFF : LOG_ERROR_CONTROLLER;
    struct frame f = {.id = LOG_ERROR_FRAME | class, .length = FRAME_DATA, .flags = FRAME_EXTENDED};
    f.data[LOG_FAULT_BYTE] = (uint8_t)fault;
    return f;
}

static struct frame refusal_frame(const struct frame *f)
{
    const uint8_t *d = f->data;
    uint8_t number = LOG_REFUSED | (uint8_t)(f->id % LOG_NUMBERS);
    return (struct frame){.id = LOG_ERROR_FRAME | LOG_ERROR_CONTROLLER,
                          .length = FRAME_DATA,
                          .flags = FRAME_EXTENDED,
                          .data = {d[2], LOG_REFUSED_CAUSE, d[3], d[4], d[5], number, d[6], d[7]}};
}

/* A word of the recorder with a number. */
static struct frame word_frame(uint8_t word, uint32_t number)
{
    const uint8_t low = (uint8_t)number, second = (uint8_t)(number >> 8), third = (uint8_t)(number >> 16);
    return (struct frame){.id = LOG_ERROR_FRAME | LOG_ERROR_CONTROLLER,
                          .length = FRAME_DATA,
                          .flags = FRAME_EXTENDED,
                          .data = {low, 0, second, third, (uint8_t)(number >> 24), word, 0, 0}};
}

/* The frame that stands in the line. */
static struct frame shown_frame(const struct log_line *line)
{
    if (line->fault)
        return fault_frame(line->fault);
    switch (line->way) {
    case LOG_NO_ROOM:
        return refusal_frame(&line->frame);
    case LOG_OVERRUN:
        return word_frame(LOG_MISSED, line->missed);
    case LOG_BEGIN:
        return word_frame(LOG_PLANT, 0);
    case LOG_TURN:
        return word_frame(LOG_AGAINST, 0);
    default:
        return line->frame;
    }
}

int log_format(char *text, const struct log_line *line)
{
    struct frame shown = shown_frame(line);
    int n =
        snprintf(text, LOG_LINE_MAX, "(%010llu.%06u) %.15s ", (unsigned long long)(line->time_us / 1000000u),
                 (unsigned)(line->time_us % 1000000u), line->interface);
    n += put_hex(text + n, shown.id, shown.flags & FRAME_EXTENDED ? 8 : 3);
    text[n++] = '#';
    for (int i = 0; i < shown.length; i++)
        n += put_hex(text + n, shown.data[i], 2);
    text[n++] = '\n';
    text[n] = 0;
    return n;
}

/* Bytes of the buffer up to the last line of a whole bus frame among the first n: the line there has
 * another stamp than the one behind it. 0: there is none. */
static uint32_t whole_frames(const struct log *l, uint32_t n)
{
    uint32_t begin = n;
    while (begin && l->buffer[begin - 1] != '\n')
        begin--;
    if (begin == l->n_bytes)
        return begin;
    size_t stamp = strcspn(l->buffer + begin, " ");
    while (begin) {
        uint32_t before = begin - 1;
        while (before && l->buffer[before - 1] != '\n')
            before--;
        if (strncmp(l->buffer + before, l->buffer + begin, stamp) != 0)
            break;
        begin = before;
    }
    return begin;
}

static uint32_t count_lines(const char *text, uint32_t n)
{
    uint32_t lines = 0;
    for (uint32_t i = 0; i < n; i++)
        lines += text[i] == '\n';
    return lines;
}

/* Latches the end of the recording, `in_file` bytes of the buffer being in the file, and cuts the file
 * after its last whole bus frame, so that it replays. */
static void fail(struct log *l, const char *why, uint32_t in_file)
{
    uint32_t keep = whole_frames(l, in_file);
    uint64_t end = keep ? l->written + keep : l->whole;
    bool cut = end == l->written + in_file || ftruncate(l->file, (off_t)end) == 0;
    uint32_t lost = count_lines(l->buffer + keep, l->n_bytes - keep);
    l->lines -= lost;
    l->lines_lost += lost;
    l->failed = true;
    snprintf(l->reason, sizeof l->reason, "log: %s; recorded %llu lines, the rest is missing%s", why,
             (unsigned long long)l->lines, cut ? "" : ", and the last bus frame is not whole");
}

/* The first n bytes of the buffer. An error is latched. */
static void write_bytes(struct log *l, uint32_t n)
{
    uint32_t done = 0;
    while (!l->failed && done < n) {
        ssize_t got = write(l->file, l->buffer + done, n - done);
        char why[LOG_REASON / 2];
        if (got > 0) {
            done += (uint32_t)got;
        } else if (got == 0 || errno != EINTR) {
            snprintf(why, sizeof why, "writing failed: %s", strerror(got == 0 ? ENOSPC : errno));
            fail(l, why, done);
        }
    }
}

/* Writes the buffer out. `in_frame`: more lines of its last bus frame may come. */
static void write_out(struct log *l, bool in_frame)
{
    uint64_t room = l->limit ? l->limit - l->written : UINT64_MAX;
    uint32_t n = l->n_bytes <= room ? l->n_bytes : (uint32_t)room;
    uint64_t whole = l->whole;
    if (in_frame &&
        l->n_bytes) { /* the last frame may go on: it begins behind the whole ones before its last line */
        uint32_t before = whole_frames(l, l->n_bytes - 1);
        whole = before ? l->written + before : l->whole;
    }
    write_bytes(l, n);
    if (!l->failed && n < l->n_bytes) {
        l->limited = true;
        fail(l, "its limit is reached", n);
    }
    l->written += n;
    l->whole = in_frame ? whole : l->written;
    l->n_bytes = 0;
}

enum log_way log_way_of(const struct frame *f)
{
    return f->id % FRAME_IDS < LOG_COMMANDS ? LOG_RECEIVED : LOG_SENT;
}

/* The line, with stamp and interface filled in. */
static void put_line(struct log *l, struct log_line *line)
{
    if (l->failed) {
        l->lines_lost++;
        return;
    }
    if (l->n_bytes + LOG_LINE_MAX > LOG_BUFFER)
        write_out(l, true);
    line->time_us = l->time_us;
    memcpy(line->interface, l->interface, sizeof line->interface);
    l->n_bytes += (uint32_t)log_format(l->buffer + l->n_bytes, line);
    l->lines++;
}

/* The line, and before it the words that it needs. */
static void record(struct log *l, struct log_line *line)
{
    bool frame = !line->fault && (line->way == LOG_RECEIVED || line->way == LOG_SENT);
    if (!l->begun && !l->listens)
        put_line(l, &(struct log_line){.way = LOG_BEGIN});
    l->begun = true;
    if (frame && line->way != log_way_of(&line->frame) && !l->listens)
        put_line(l, &(struct log_line){.way = LOG_TURN});
    put_line(l, line);
}

static int receive(void *context, struct frame *f)
{
    struct log *l = context;
    if (l->failed && !l->reported) {
        l->reported = true;
        return -HAL_LOG_ENDED;
    }
    int got = l->inner.recv(l->inner.context, f);
    if (got > 0)
        record(l, &(struct log_line){.frame = *f, .way = LOG_RECEIVED});
    else if (got < 0)
        record(l, &(struct log_line){.fault = -got});
    return got;
}

static int transmit(void *context, const struct frame *f)
{
    struct log *l = context;
    int taken = l->inner.send(l->inner.context, f);
    record(l, &(struct log_line){.frame = *f, .way = taken ? LOG_SENT : LOG_NO_ROOM});
    return taken;
}

static void flush(void *context)
{
    struct log *l = context;
    l->inner.flush(l->inner.context);
    if (l->n_bytes > LOG_BUFFER / 2)
        write_out(l, false);
}

static uint32_t now_us(void *context)
{
    const struct log *l = context;
    return l->inner.now_us(l->inner.context);
}

static void healthy(void *context)
{
    const struct log *l = context;
    l->inner.healthy(l->inner.context);
}

const char *log_open(struct log *l, const char *path, const char *interface, const struct hal *inner)
{
    memset(l, 0, sizeof *l);
    l->inner = *inner;
    l->hal = (struct hal){l, receive, transmit, flush, now_us, healthy};
    size_t n = strlen(interface);
    if (n < 1 || n >= LOG_INTERFACE || strcspn(interface, " \t\r\n") != n) {
        snprintf(l->reason, sizeof l->reason, "log: \"%.32s\" is no interface name of 1 to 15 characters",
                 interface);
        return l->reason;
    }
    memcpy(l->interface, interface, n);
    l->file = file_create(path);
    if (l->file >= 0)
        return NULL;
    snprintf(l->reason, sizeof l->reason, "log: cannot write %s: %s", path,
             errno == EBUSY ? "another process writes it" : strerror(errno));
    return l->reason;
}

void log_set_frame(struct log *l, uint64_t frame, double frame_s)
{
    l->time_us = log_frame_us(frame, frame_s);
}

void log_missed(struct log *l, uint32_t missed)
{
    if (missed)
        record(l, &(struct log_line){.way = LOG_OVERRUN, .missed = missed});
}

const char *log_error(const struct log *l)
{
    return l->failed ? l->reason : NULL;
}

const char *log_close(struct log *l)
{
    write_out(l, false);
    if (close(l->file) != 0 && !l->failed)
        fail(l, strerror(errno), 0);
    l->file = -1;
    return log_error(l);
}
