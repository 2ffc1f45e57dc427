/* test_cannelloni.c - packets against bytes written by hand, and against bytes that are none. */
#include <stdlib.h>
#include <string.h>
#include "hal/link/cannelloni.h"
#include "tests/fixture/packet.h"
#include "tests/unit/test.h"

/* Parses a copy that ends where the packet ends: an address sanitizer sees any read beyond. */
static int parse_packet(const uint8_t *packet, size_t n, struct frame *out, int max)
{
    uint8_t *copy = malloc(n ? n : 1);
    memcpy(copy, packet, n);
    int got = cannelloni_parse(copy, n, out, max);
    free(copy);
    return got;
}

TEST(cannelloni_packet)
{
    struct cannelloni p;
    struct frame out[PACKET_FRAMES];
    cannelloni_begin(&p, PACKET_SEQUENCE);
    check_int("a packet of no frames", (int64_t)p.n_bytes, CANNELLONI_HEADER);
    check_int("is valid", parse_packet(p.bytes, p.n_bytes, out, 0), 0);
    for (int i = 0; i < PACKET_FRAMES; i++)
        cannelloni_add(&p, &packet_frame[i]);
    check_int("bytes built", p.n_bytes, sizeof packet_golden);
    check_int("bytes that differ from the format", memcmp(p.bytes, packet_golden, sizeof packet_golden), 0);
    check_int("frames parsed", parse_packet(packet_golden, sizeof packet_golden, out, PACKET_FRAMES),
              PACKET_FRAMES);
    for (int i = 0; i < PACKET_FRAMES; i++)
        check_true("a parsed frame is the one written by hand", packet_same(&out[i], &packet_frame[i]));
    cannelloni_next(&p);
    check_int("the next packet is empty", p.n_bytes, CANNELLONI_HEADER);
    check_int("and counted", p.bytes[2], PACKET_SEQUENCE + 1);
}

/* 1400 bytes with a header of 5: 107 frames of 13, or 279 of 5. */
TEST(cannelloni_room)
{
    const struct frame full = {.id = 1, .length = FRAME_DATA}, empty = {.id = 1};
    struct cannelloni p;
    cannelloni_begin(&p, 255);
    while (cannelloni_has_room(&p, &full))
        cannelloni_add(&p, &full);
    check_int("full frames in a packet", p.n_frames, 107);
    check_int("count, high and low byte", p.bytes[3] << 8 | p.bytes[4], 107);
    cannelloni_next(&p);
    check_int("the sequence wraps", p.bytes[2], 0);
    while (cannelloni_has_room(&p, &empty))
        cannelloni_add(&p, &empty);
    check_int("empty frames in a packet", p.n_frames, 279);
    check_int("bytes", p.n_bytes, CANNELLONI_PAYLOAD);
    check_int("count, high and low byte", p.bytes[3] << 8 | p.bytes[4], 279);
}

static void refused(const char *name, size_t at, uint8_t value)
{
    uint8_t packet[sizeof packet_golden];
    struct frame out[3];
    memcpy(packet, packet_golden, sizeof packet_golden);
    packet[at] = value;
    check_int(name, parse_packet(packet, sizeof packet, out, 3), -1);
}

TEST(cannelloni_malformed)
{
    struct frame out[3];
    uint8_t longer[sizeof packet_golden + 1] = {0};
    int64_t taken = 0;
    for (size_t n = 0; n < sizeof packet_golden; n++)
        taken += parse_packet(packet_golden, n, out, 3) >= 0;
    check_int("truncated packets taken", taken, 0);
    memcpy(longer, packet_golden, sizeof packet_golden);
    check_int("a byte too many", parse_packet(longer, sizeof longer, out, 3), -1);
    check_int("more frames than there is room", parse_packet(packet_golden, sizeof packet_golden, out, 2),
              -1);
    refused("wrong version", 0, 1);
    refused("wrong op code", 1, 1);
    refused("count too small", 4, 2);
    refused("count too large", 4, 4);
    refused("count huge", 3, 0xFF);
    refused("remote frame", 5, 0x40);
    refused("error frame", 5, 0x20);
    refused("11-bit identifier above 7FF", 7, 0x08);
    refused("29-bit identifier above 1FFFFFFF", 12, 0xB8);
    refused("length 9", 16, 9);
    refused("CAN FD frame", 16, 0x88);
    /* any bytes at all: never more frames than asked for, never a length above 8 */
    uint32_t random = 1;
    int64_t bad = 0, parsed = 0;
    for (int i = 0; i < 200000; i++) {
        uint8_t packet[sizeof packet_golden];
        memcpy(packet, packet_golden, sizeof packet_golden);
        for (int k = 0; k < 3; k++) {
            random = random * 1664525u + 1013904223u;
            packet[(random >> 8) % sizeof packet_golden] = (uint8_t)(random >> 24);
        }
        int n = cannelloni_parse(packet, (random >> 4) % (sizeof packet_golden + 1), out, 3);
        parsed += n > 0;
        bad += n > 3;
        for (int k = 0; k < n; k++)
            bad += out[k].length > FRAME_DATA;
    }
    check_int("random packets parsed to something impossible", bad, 0);
    check_above("random packets that were valid", (double)parsed, 1);
}
