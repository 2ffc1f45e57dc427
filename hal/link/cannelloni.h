/* cannelloni.h - CAN frames in a packet of the cannelloni format, version 2, so that any cannelloni peer can
 * tie the plant to a real bus. Bytes only: UDP sockets (hal/posix/udp.h) and a board's own Ethernet
 * (hal/ethernet/net.h) share it.
 *
 * A packet, big endian: version (1 byte) 2, op code (1) 0 = data, sequence number (1), frame count (2). For
 * each frame follow identifier (4; bit 31 extended, bit 30 remote, bit 29 error), length (1) and data. Bit 7
 * of the length announces CAN FD, and a byte of flags behind it. A remote frame has no data. The plant speaks
 * classic data frames only. A gateway packs what its bus carries, so frames of other kinds are passed over
 * one by one. A packet whose bytes do not end exactly with its last frame is refused whole: half a batch of
 * commands is worse than none. */
#ifndef HAL_CANNELLONI_H
#define HAL_CANNELLONI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "hal/hal.h"

enum {
    CANNELLONI_VERSION = 2,
    CANNELLONI_HEADER = 5,
    CANNELLONI_FRAME_HEADER = 5,
    CANNELLONI_PAYLOAD = 1400,    /* bytes we send at most: below every usual MTU */
    CANNELLONI_PACKET_MAX = 2048, /* bytes we accept at most */
    CANNELLONI_FRAMES_MAX = (CANNELLONI_PACKET_MAX - CANNELLONI_HEADER) / CANNELLONI_FRAME_HEADER,
    /* In lockstep: a packet of so many bytes has no room for another frame, so that the bus frame goes on in
     * the next. */
    CANNELLONI_MORE = CANNELLONI_PAYLOAD - (CANNELLONI_FRAME_HEADER + FRAME_DATA) + 1
};

/* A packet being filled: `bytes` is a valid packet after every call below. */
struct cannelloni {
    uint8_t bytes[CANNELLONI_PAYLOAD];
    uint32_t n_bytes, n_frames;
};

/* Empties it; `sequence` counts the packets of a sender. */
void cannelloni_begin(struct cannelloni *p, uint8_t sequence);

/* Empties it for the next sequence number. */
void cannelloni_next(struct cannelloni *p);

/* True when this frame still fits. */
bool cannelloni_has_room(const struct cannelloni *p, const struct frame *f);

/* Adds a frame. The caller has asked cannelloni_has_room: without room this writes past the packet. */
void cannelloni_add(struct cannelloni *p, const struct frame *f);

/* Takes the classic data frames of a packet of n bytes into out[max]; returns how many. Adds the frames of
 * other kinds to *passed_over. Returns -1 when the packet is malformed or holds more than max; then `out` may
 * be partly written, and *passed_over is as it was. It reads n bytes at most and has no state. */
int cannelloni_parse(const uint8_t *packet, size_t n, struct frame *out, int max, uint32_t *passed_over);

#endif
