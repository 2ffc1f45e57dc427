/* library_bus.c - the app on a bus in memory, and frames in packets. */
#include "host_sim/library/library_bus.h"

#include <string.h>
#include "hal/link/cannelloni.h"

STATIC_ASSERT((int)CONTACTPLANT_PACKET == CANNELLONI_PAYLOAD, packet_of_the_header);
STATIC_ASSERT((int)CONTACTPLANT_PACKET_FRAMES == CANNELLONI_FRAMES_MAX, frames_of_the_header);

enum { ROOM_IN = 256 }; /* frames that one bus frame reads */

bool library_frame_in(const struct contactplant_frame *from, struct frame *to)
{
    if (from->length > FRAME_DATA || from->extended > 1 || from->id > (from->extended ? 0x1FFFFFFFu : 0x7FFu))
        return false;
    *to =
        (struct frame){.id = from->id, .length = from->length, .flags = from->extended ? FRAME_EXTENDED : 0};
    memcpy(to->data, from->data, from->length);
    return true;
}

void library_frame_out(const struct frame *from, struct contactplant_frame *to)
{
    *to = (struct contactplant_frame){
        .id = from->id, .length = from->length, .extended = (from->flags & FRAME_EXTENDED) != 0};
    memcpy(to->data, from->data, sizeof to->data);
}

static int begin_on_bus(struct contactplant *p)
{
    if (!library_is_plant(p))
        return CONTACTPLANT_BAD_HANDLE;
    if (p->on_bus)
        return CONTACTPLANT_OK;
    return library_fail(&p->error, CONTACTPLANT_BAD_ORDER,
                        "this plant is alone; contactplant_open_bus gives one on a bus");
}

int contactplant_bus_put(struct contactplant *p, const struct contactplant_frame *frame)
{
    struct frame f;
    int code = begin_on_bus(p);
    if (code != CONTACTPLANT_OK)
        return code;
    if (!frame || !library_frame_in(frame, &f))
        return library_fail(&p->error, CONTACTPLANT_BAD_VALUE,
                            "not a classic CAN frame: 8 bytes at most, an identifier of 11 or 29 bits");
    if (!library_ring_put(&p->in, ROOM_IN, &f))
        return library_fail(&p->error, CONTACTPLANT_FULL, "%d frames wait; run contactplant_bus_frame",
                            ROOM_IN);
    return CONTACTPLANT_OK;
}

int contactplant_bus_frame(struct contactplant *p)
{
    int code = begin_on_bus(p);
    if (code == CONTACTPLANT_OK)
        app_frame(&p->scene.app);
    return code;
}

int contactplant_bus_take(struct contactplant *p, struct contactplant_frame *frame)
{
    struct frame f;
    if (begin_on_bus(p) != CONTACTPLANT_OK)
        return 0;
    if (!frame) {
        (void)library_fail(&p->error, CONTACTPLANT_BAD_VALUE, "contactplant_bus_take: frame is NULL");
        return 0;
    }
    if (!library_ring_take(&p->out, &f))
        return 0;
    library_frame_out(&f, frame);
    return 1;
}

/* ---- packets ---- */

size_t contactplant_pack(uint8_t sequence, const struct contactplant_frame *frame, int n,
                         uint8_t packet[CONTACTPLANT_PACKET], int *taken)
{
    struct cannelloni c;
    struct frame f;
    int i = 0;
    cannelloni_begin(&c, sequence);
    for (; frame && i < n && library_frame_in(&frame[i], &f) && cannelloni_has_room(&c, &f); i++)
        cannelloni_add(&c, &f);
    if (taken)
        *taken = i;
    if (!packet)
        return 0;
    memcpy(packet, c.bytes, c.n_bytes);
    return c.n_bytes;
}

int contactplant_unpack(const uint8_t *packet, size_t size, struct contactplant_frame *frame, int n)
{
    struct frame f[CANNELLONI_FRAMES_MAX];
    uint32_t passed_over = 0;
    if (!packet || (n > 0 && !frame) || size > CANNELLONI_PACKET_MAX)
        return -1;
    int got = cannelloni_parse(packet, size, f, n < CANNELLONI_FRAMES_MAX ? n : CANNELLONI_FRAMES_MAX,
                               &passed_over);
    for (int i = 0; i < got; i++)
        library_frame_out(&f[i], &frame[i]);
    return got;
}
