#include "hal/log.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

uint64_t log_frame_us(uint64_t frame, double frame_s)
{
    return LOG_START_US + (uint64_t)((double)frame * frame_s * 1e6 + 0.5);
}

/* --- writing ----------------------------------------------------------------------------------------------- */

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

int log_format(char *text, uint64_t time_us, const char *interface, const struct frame *f, int fault)
{
    struct frame shown = fault ? fault_frame(fault) : *f;
    int n = snprintf(text, LOG_LINE_MAX, "(%010llu.%06u) %.15s ", (unsigned long long)(time_us / 1000000u),
                     (unsigned)(time_us % 1000000u), interface);
    n += put_hex(text + n, shown.id, shown.flags & FRAME_EXTENDED ? 8 : 3);
    text[n++] = '#';
    for (int i = 0; i < shown.length; i++)
        n += put_hex(text + n, shown.data[i], 2);
    text[n++] = '\n';
    text[n] = 0;
    return n;
}

/* Latches the error and cuts the file after its last whole line, so that it can still be read. */
static void fail(struct log *l, int error, uint32_t written)
{
    off_t end = lseek(l->file, 0, SEEK_CUR);
    uint32_t whole = written;
    while (whole && l->buffer[whole - 1] != '\n')
        whole--;
    if (end >= (off_t)(written - whole) && ftruncate(l->file, end - (off_t)(written - whole)) != 0)
        error = error ? error : errno;
    uint32_t lost = 0;
    for (uint32_t i = whole; i < l->n_bytes; i++)
        lost += l->buffer[i] == '\n';
    l->lines -= lost;
    l->lines_lost += lost;
    l->failed = true;
    snprintf(l->reason, sizeof l->reason, "log: writing failed: %s; recorded %llu lines, the rest is missing",
             strerror(error), (unsigned long long)l->lines);
}

static void write_out(struct log *l)
{
    uint32_t written = 0;
    while (!l->failed && written < l->n_bytes) {
        ssize_t n = write(l->file, l->buffer + written, l->n_bytes - written);
        if (n > 0)
            written += (uint32_t)n;
        else if (n == 0 || errno != EINTR)
            fail(l, n == 0 ? ENOSPC : errno, written);
    }
    l->n_bytes = 0;
}

static void record(struct log *l, const struct frame *f, int fault)
{
    if (l->failed) {
        l->lines_lost++;
        return;
    }
    if (l->n_bytes + LOG_LINE_MAX > LOG_BUFFER)
        write_out(l);
    l->n_bytes += (uint32_t)log_format(l->buffer + l->n_bytes, l->time_us, l->interface, f, fault);
    l->lines++;
}

static int receive(void *context, struct frame *f)
{
    struct log *l = context;
    int got = l->inner.recv(l->inner.context, f);
    if (got > 0)
        record(l, f, 0);
    else if (got < 0)
        record(l, NULL, -got);
    return got;
}

static int transmit(void *context, const struct frame *f)
{
    struct log *l = context;
    int taken = l->inner.send(l->inner.context, f);
    if (taken)
        record(l, f, 0);
    return taken;
}

static void flush(void *context)
{
    struct log *l = context;
    l->inner.flush(l->inner.context);
    if (l->n_bytes > LOG_BUFFER / 2)
        write_out(l);
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
    l->file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (l->file >= 0)
        return NULL;
    snprintf(l->reason, sizeof l->reason, "log: cannot write %s: %s", path, strerror(errno));
    return l->reason;
}

void log_set_frame(struct log *l, uint64_t frame, double frame_s)
{
    l->time_us = log_frame_us(frame, frame_s);
}

const char *log_error(const struct log *l)
{
    return l->failed ? l->reason : NULL;
}

const char *log_close(struct log *l)
{
    write_out(l);
    if (close(l->file) != 0 && !l->failed)
        fail(l, errno, 0);
    l->file = -1;
    return log_error(l);
}
