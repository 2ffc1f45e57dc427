/* cannelloni.c - CAN frames in a packet of the cannelloni format; see cannelloni.h. */
#include "hal/link/cannelloni.h"

#include <string.h>

enum { OP_DATA = 0, SEQUENCE = 2, COUNT = 3, LENGTH_FD = 0x80 };

static const uint32_t id_extended = 0x80000000u, id_remote = 0x40000000u;

static uint32_t get_u32(const uint8_t *b)
{
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static void put_u32(uint8_t *b, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        b[i] = (uint8_t)(v >> (24 - 8 * i));
}

/* Bytes that the frame at b takes of the n that are left, whatever its kind; 0: it does not end within them.
 */
static size_t frame_bytes(const uint8_t *b, size_t n)
{
    if (n < CANNELLONI_FRAME_HEADER)
        return 0;
    size_t bytes = CANNELLONI_FRAME_HEADER + (b[4] & LENGTH_FD ? 1u : 0u); /* CAN FD: a byte of flags */
    if (!(get_u32(b) & id_remote)) /* whose length is only asked for */
        bytes += b[4] & (LENGTH_FD - 1u);
    return bytes <= n ? bytes : 0;
}

/* The frame at b, which is whole; false when it is no classic data frame. */
static bool unpack_frame(const uint8_t *b, struct frame *f)
{
    uint32_t word = get_u32(b), id = word & ~id_extended;
    bool extended = word & id_extended;
    if (id > (extended ? 0x1FFFFFFFu : 0x7FFu) || b[4] > FRAME_DATA) /* other kinds set a bit above these */
        return false;
    *f = (struct frame){.id = id, .length = b[4], .flags = extended ? FRAME_EXTENDED : 0};
    memcpy(f->data, b + CANNELLONI_FRAME_HEADER, b[4]);
    return true;
}

int cannelloni_parse(const uint8_t *packet, size_t n, struct frame *out, int max, uint32_t *passed_over)
{
    if (n < CANNELLONI_HEADER || packet[0] != CANNELLONI_VERSION || packet[1] != OP_DATA)
        return -1;
    int count = packet[COUNT] << 8 | packet[COUNT + 1], taken = 0;
    size_t at = CANNELLONI_HEADER;
    for (int i = 0; i < count; i++) { /* each takes CANNELLONI_FRAME_HEADER bytes of n or more */
        size_t bytes = frame_bytes(packet + at, n - at);
        struct frame f;
        bool ours = bytes && unpack_frame(packet + at, &f);
        if (!bytes || (ours && taken == max))
            return -1;
        if (ours)
            out[taken++] = f;
        at += bytes;
    }
    if (at != n)
        return -1;
    *passed_over += (uint32_t)(count - taken);
    return taken;
}

void cannelloni_begin(struct cannelloni *p, uint8_t sequence)
{
    const uint8_t header[CANNELLONI_HEADER] = {CANNELLONI_VERSION, OP_DATA, sequence, 0, 0};
    memcpy(p->bytes, header, sizeof header);
    p->n_bytes = sizeof header;
    p->n_frames = 0;
}

void cannelloni_next(struct cannelloni *p)
{
    cannelloni_begin(p, (uint8_t)(p->bytes[SEQUENCE] + 1));
}

bool cannelloni_has_room(const struct cannelloni *p, const struct frame *f)
{
    return p->n_bytes + CANNELLONI_FRAME_HEADER + f->length <= sizeof p->bytes;
}

void cannelloni_add(struct cannelloni *p, const struct frame *f)
{
    uint8_t *b = p->bytes + p->n_bytes;
    put_u32(b, f->id | (f->flags & FRAME_EXTENDED ? id_extended : 0));
    b[4] = f->length;
    memcpy(b + CANNELLONI_FRAME_HEADER, f->data, f->length);
    p->n_bytes += CANNELLONI_FRAME_HEADER + f->length;
    p->n_frames++;
    p->bytes[COUNT] = (uint8_t)(p->n_frames >> 8);
    p->bytes[COUNT + 1] = (uint8_t)p->n_frames;
}
