#include "tests/packet.h"

#include <string.h>

/* cannelloni, CannelloniDataPacket: version 2, op 0, sequence, count; then id, length, data, all big endian. */
const uint8_t packet_golden[PACKET_BYTES] = {2,    0,    7,    0,    3,             /* */
                                             0,    0,    0x02, 0x41, 2, 0xAB, 0xCD, /* 241#ABCD */
                                             0x98, 0xDA, 0xF1, 0x10, 8, 1,    2,
                                             3,    4,    5,    6,    7, 8, /* 18DAF110#0102030405060708 */
                                             0,    0,    0x07, 0xFF, 0};   /* 7FF# */
const struct frame packet_frame[PACKET_FRAMES] = {{0x241, 2, 0, {0xAB, 0xCD}},
                                                  {0x18DAF110, 8, FRAME_EXTENDED, {1, 2, 3, 4, 5, 6, 7, 8}},
                                                  {0x7FF, 0, 0, {0}}};

bool packet_same(const struct frame *a, const struct frame *b)
{
    return a->id == b->id && a->flags == b->flags && a->length == b->length &&
           memcmp(a->data, b->data, a->length) == 0;
}
