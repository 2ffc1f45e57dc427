/* board_record.c - a log of a board, written at the other end of its wire; see board_record.h. */
#include "tests/boards/board_record.h"

#include <string.h>
#include "hal/posix/log.h"

enum { FRAME_BITS = 1 << 16 }; /* SYNC_FRAME counts modulo this */

static void write_line(struct board_record *r, const struct frame *f)
{
    char text[LOG_LINE_MAX];
    const struct log_line line = {
        .time_us = log_frame_us(r->frame, r->frame_s), .interface = "board", .frame = *f};
    log_format(text, &line);
    fputs(text, r->log);
}

static bool is_marker(const struct board_record *r, const struct frame *f, uint8_t counter)
{
    struct message m;
    return wire_decode(&r->scene, f, &m) == WIRE_OK && m.kind == WIRE_CAPTURE && m.counter == counter;
}

/* The packet of commands that ends with this marker was taken in the frame whose lines are being written. */
static void take_packet(struct board_record *r, uint8_t counter)
{
    int n = 0;
    while (n < r->n_waiting && !is_marker(r, &r->waiting[n], counter))
        write_line(r, &r->waiting[n++]);
    if (n == r->n_waiting) {
        r->out_of_order++;
        r->n_waiting = 0;
        return;
    }
    write_line(r, &r->waiting[n++]);
    r->n_waiting -= n;
    memmove(r->waiting, r->waiting + n, (size_t)r->n_waiting * sizeof r->waiting[0]);
    r->taken_frame = r->frame;
}

/* A whole packet of telemetry has come in: commands that it answers, then itself. */
static void finish_packet(struct board_record *r)
{
    struct message m;
    bool dated = false;
    for (int i = 0; i < r->n_lines; i++)
        if (wire_decode(&r->scene, &r->line[i], &m) == WIRE_OK && m.kind == WIRE_SYNC)
            dated = (uint64_t)m.value[SYNC_FRAME] == r->frame % FRAME_BITS;
    r->out_of_order += r->n_lines > 0 && !dated;
    for (int i = 0; i < r->n_lines; i++)
        if (wire_decode(&r->scene, &r->line[i], &m) == WIRE_OK && m.kind == WIRE_REPLY &&
            m.value[REPLY_MESSAGE] == WIRE_CAPTURE)
            take_packet(r, (uint8_t)m.value[REPLY_COUNTER]);
    for (int i = 0; i < r->n_lines; i++)
        write_line(r, &r->line[i]);
    r->frame += r->n_lines > 0;
    r->n_lines = 0;
}

static int receive(void *context, struct frame *f)
{
    struct board_record *r = context;
    int got = r->udp->hal.recv(r->udp->hal.context, f);
    r->out_of_order += got < 0;
    if (got <= 0)
        return got;
    if (r->udp->packets_received != r->packet)
        finish_packet(r);
    r->packet = r->udp->packets_received;
    if (r->n_lines < RECORD_LINES)
        r->line[r->n_lines++] = *f;
    else
        r->out_of_order++;
    return got;
}

static int put(struct board_record *r, const struct frame *f)
{
    if (r->n_waiting == RECORD_WAITING || !r->udp->hal.send(r->udp->hal.context, f)) {
        r->out_of_order++;
        return 0;
    }
    r->waiting[r->n_waiting++] = *f;
    return 1;
}

static int transmit(void *context, const struct frame *f)
{
    struct board_record *r = context;
    struct message m;
    if (wire_decode(&r->scene, f, &m) == WIRE_OK)
        r->session = (uint8_t)m.value[SESSION];
    return put(r, f);
}

static void flush(void *context)
{
    struct board_record *r = context;
    struct message m = {.kind = WIRE_CAPTURE, .counter = r->marker, .value = {r->session, CAPTURE_STOP}};
    struct frame f;
    wire_encode(&r->scene, &m, &f);
    r->marker = (uint8_t)((r->marker + 1) % WIRE_COUNTER_STATES);
    put(r, &f);
    r->udp->hal.flush(r->udp->hal.context);
}

void board_record_open(struct board_record *r, struct udp *udp, const struct wire_scene *scene,
                       double frame_s, FILE *log)
{
    memset(r, 0, sizeof *r);
    r->udp = udp;
    r->scene = *scene;
    r->frame_s = frame_s;
    r->log = log;
    r->hal = udp->hal;
    r->hal.context = r;
    r->hal.recv = receive;
    r->hal.send = transmit;
    r->hal.flush = flush;
}

void board_record_close(struct board_record *r)
{
    finish_packet(r);
    fflush(r->log);
}
