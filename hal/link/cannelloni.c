/* cannelloni.c - CAN frames in a packet of the cannelloni format; see cannelloni.h. */
#include "hal/link/cannelloni.h"

#include <string.h>

enum { OP_DATA = 0, SEQUENCE = 2, COUNT = 3 };

static const uint32_t id_extended = 0x80000000u, id_remote = 0x40000000u, id_error = 0x20000000u;

static uint32_t get_u32(const uint8_t *b)
{
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static void put_u32(uint8_t *b, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        b[i] = (uint8_t)(v >> (24 - 8 * i));
}

/* Bytes taken by the frame at b, of n that are left; 0 when it is none of ours. */
static size_t unpack_frame(const uint8_t *b, size_t n, struct frame *f)
{
    if (n < CANNELLONI_FRAME_HEADER)
        return 0;
    uint32_t word = get_u32(b);
    bool extended = word & id_extended;
    uint32_t id = word & ~id_extended;
    uint8_t length = b[4];
    if (word & (id_remote | id_error) || id > (extended ? 0x1FFFFFFFu : 0x7FFu))
        return 0;
    if (length > FRAME_DATA || n < CANNELLONI_FRAME_HEADER + (size_t)length) /* CAN FD has bit 7 set */
        return 0;
    *f = (struct frame){.id = id, .length = length, .flags = extended ? FRAME_EXTENDED : 0};
    memcpy(f->data, b + CANNELLONI_FRAME_HEADER, length);
    return CANNELLONI_FRAME_HEADER + (size_t)length;
}

int cannelloni_parse(const uint8_t *packet, size_t n, struct frame *out, int max)
{
    if (n < CANNELLONI_HEADER || packet[0] != CANNELLONI_VERSION || packet[1] != OP_DATA)
        return -1;
    int count = packet[COUNT] << 8 | packet[COUNT + 1];
    if (count > max)
        return -1;
    size_t at = CANNELLONI_HEADER;
    for (int i = 0; i < count; i++) {
        size_t taken = unpack_frame(packet + at, n - at, &out[i]);
        if (!taken)
            return -1;
        at += taken;
    }
    return at == n ? count : -1;
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
