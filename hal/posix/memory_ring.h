/* memory_ring.h - a ring of packets in memory that two processes share: one writes, the other reads.
 *
 * - The writer fills slot[written % MEMORY_SLOTS] where written - taken < MEMORY_SLOTS, says in `processor`
 *   where it runs, then adds 1 to `written`. Where the reader has set `asleep`, it wakes the reader by a
 *   futex on `written`.
 * - The reader empties slot[taken % MEMORY_SLOTS] where written != taken, then adds 1 to `taken`. Before it
 *   sleeps it sets `asleep`, and looks once more.
 *
 * Both reach these words by sequentially consistent loads and stores.
 *
 * A reader looks for memory_ring_patience_ns before it sleeps. Where that was in vain, the next wait sleeps
 * at once, then the next 3, 7 and at most 63, until a look finds a packet. So a reader whose packets come
 * late does not keep its processor busy. */
#ifndef HAL_MEMORY_RING_H
#define HAL_MEMORY_RING_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/link/cannelloni.h"

enum {
    MEMORY_SLOTS = 32,
    MEMORY_BYTES = CANNELLONI_PACKET_MAX - 4 /* a packet has at most: a slot is 2048 bytes long */
};

/* Both processes see it. Every field is little endian, as the machine is, and zero at first. The words of one
 * process are a line of the cache from those of the other. */
struct memory_ring {
    uint32_t written, processor, gap[14]; /* processor: the writer's, plus 1; 0: not told */
    uint32_t taken, gap2[15], asleep, gap3[15];
    struct {
        uint32_t n; /* bytes */
        uint8_t bytes[MEMORY_BYTES];
    } slot[MEMORY_SLOTS];
};

/* A reader's waits. All zero at first. */
struct memory_wait {
    uint32_t at_once; /* waits to come that sleep at once */
    uint32_t in_vain; /* so many did after the last look in vain; 0: it was not */
    uint32_t sleeps;  /* so far */
};

/* For how long a reader on the processor `here` looks for a packet of a writer on `there`. On the same one
 * the writer waits for it: 0. On another one it is longer than a sleeper takes to wake, so that the two do
 * not settle in sleeping: 400 us. Where that is not known: 20 us. */
int64_t memory_ring_patience_ns(uint32_t there, uint32_t here);

/* Into the next slot; false where the ring is full. */
bool memory_ring_put(struct memory_ring *r, const void *bytes, uint32_t n);

/* True when there is a packet; sleeps at most `ms` for it, less when a signal comes. */
bool memory_ring_await(struct memory_ring *r, struct memory_wait *w, int ms);

/* Where there is one: the next packet into bytes[MEMORY_BYTES], and its length; -1 where it is malformed. The
 * writer may change the length while it is read, so it is read once. More packets than there are slots were
 * never written: all are left out. */
int memory_ring_take(struct memory_ring *r, uint8_t *bytes);

#endif
