/* test_cannelloni.c - packets against bytes written by hand, and against bytes that are none. */
#include <stdlib.h>
#include <string.h>
#include "hal/link/cannelloni.h"
#include "tests/fixture/packet.h"
#include "tests/unit/test.h"

static uint32_t passed_over; /* frames of other kinds, so far */

/* Parses a copy that ends where the packet ends: an address sanitizer sees any read beyond. */
static int parse_packet(const uint8_t *packet, size_t n, struct frame *out, int max)
{
    uint8_t *copy = malloc(n ? n : 1);
    memcpy(copy, packet, n);
    int got = cannelloni_parse(copy, n, out, max, &passed_over);
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

/* A gateway may pack these beside a command: 4 bytes of identifier, length, and for CAN FD flags; 0xEE is
 * data. Each stands before, between and behind two commands, which are taken. */
static const struct {
    const char *name;
    size_t n;
    uint8_t bytes[70];
} other_kind[] = {
    {"CAN FD, 12 bytes", 18, {0, 0, 3, 0x45, 0x8C, 1, [6] = 0xEE, [17] = 0xEE}},
    {"CAN FD, 64 bytes", 70, {0, 0, 3, 0x45, 0xC0, 1, [69] = 0xEE}},
    {"CAN FD, no data", 6, {0, 0, 3, 0x45, 0x80, 0}},
    {"CAN FD, 29 bits", 8, {0x98, 0xFE, 0xF1, 0, 0x82, 0, 0xEE, 0xEE}},
    {"CAN FD under a command's identifier", 14, {0, 0, 2, 0x41, 0x88, 1, [6] = 0xEE}},
    {"remote, which has no data", 5, {0x40, 0, 2, 0x41, 8}},
    {"remote, 29 bits", 5, {0xD8, 0xFE, 0xF1, 0, 0}},
    {"error", 13, {0x20, 0, 0, 0x80, 8, [5] = 0xEE}},
    {"length 9", 14, {0, 0, 3, 0x45, 9, [13] = 0xEE}},
    {"length 15 under a command's identifier", 20, {0, 0, 2, 0x41, 15}},
    {"11 bits above 7FF", 6, {0, 0, 0x08, 0x41, 1, 0xEE}},
    {"an identifier with every bit", 5, {0xFF, 0xFF, 0xFF, 0xFF, 8}},
};

TEST(cannelloni_others)
{
    static const uint8_t command[8] = {0, 0, 2, 0x41, 3, 1, 2, 3};
    for (size_t i = 0; i < sizeof other_kind / sizeof other_kind[0]; i++) {
        uint8_t packet[CANNELLONI_HEADER + 3 * 70 + 17] = {CANNELLONI_VERSION, 0, 0, 0, 5};
        size_t at = CANNELLONI_HEADER, n = other_kind[i].n;
        struct frame out[2];
        uint32_t before = passed_over;
        for (int k = 0; k < 5; k++) {
            memcpy(packet + at, k % 2 ? command : other_kind[i].bytes, k % 2 ? sizeof command : n);
            at += k % 2 ? sizeof command : n;
        }
        check_int(other_kind[i].name, parse_packet(packet, at, out, 2), 2);
        check_int("  passed over", passed_over - before, 3);
        for (int k = 0; k < 2; k++)
            check_true("  the commands", out[k].id == 0x241 && out[k].length == 3 && out[k].data[2] == 3);
        check_int("  without its last byte", parse_packet(packet, at - 1, out, 2), -1);
        check_int("  with one more", parse_packet(packet, at + 1, out, 2), -1);
        check_int("  with room for one", parse_packet(packet, at, out, 1), -1);
        check_int("  and then none counts", passed_over - before, 3);
    }
    passed_over = 0;
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
    refused("a remote frame has no data: two bytes too many", 5, 0x40);
    refused("a length of one more", 16, 9);
    refused("a CAN FD frame has a byte of flags more", 16, 0x88);
    check_int("nothing of these counts", passed_over, 0);
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
        int n = cannelloni_parse(packet, (random >> 4) % (sizeof packet_golden + 1), out, 3, &passed_over);
        parsed += n > 0;
        bad += n > 3;
        for (int k = 0; k < n; k++)
            bad += out[k].length > FRAME_DATA;
    }
    check_int("random packets parsed to something impossible", bad, 0);
    check_above("random packets that were valid", (double)parsed, 1);
}
