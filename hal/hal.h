/* hal.h - the only seam between the plant and a device, a socket or a clock.
 *
 * A bus is one const struct of function pointers and a context. All pointers must be set. No function may
 * block, allocate or call back; hal/posix/udp.h in lockstep is the one exception. A hal never reorders
 * frames of one identifier. It keeps no history: a frame that it cannot take at once is refused. All calls
 * come from one thread, in each plant frame in this order: recv until it returns 0 or the caller has
 * enough, send as often as needed, flush, healthy.
 *
 *     struct frame f;
 *     int got;
 *     while ((got = hal->recv(hal->context, &f)) != 0)
 *         got > 0 ? take(&f) : count_faults(-got);
 *     if (!hal->send(hal->context, &answer))
 *         keep(&answer);    (no room: try again in the next plant frame)
 *     hal->flush(hal->context); */
#ifndef HAL_HAL_H
#define HAL_HAL_H

#include <stdint.h>

enum {
    FRAME_EXTENDED = 1 << 0, /* 29-bit identifier */
    FRAME_DATA = 8,          /* bytes of a classic CAN frame */
    FRAME_IDS = 0x40 /* identifiers that a plant owns: a block aligned to its size; drivers filter for it */
};

/* One frame as it travels; never remote, never an error frame (those become fault bits). */
struct frame {
    uint32_t id;    /* 11 or 29 bits, without flags */
    uint8_t length; /* 0..8 */
    uint8_t flags;  /* FRAME_EXTENDED */
    uint8_t data[FRAME_DATA];
};

/* Faults that recv may report instead of a frame: -(sum of these). Each is counted by the app under its own
 * name. */
enum hal_fault {
    HAL_DROPPED = 1 << 0, /* the receive path lost frames (queue overflow) */
    HAL_FOREIGN = 1 << 1, /* a sender or packet that is not allowed was dropped: unlisted peer, bad packet */
    HAL_BUS_OFF = 1 << 2, /* the controller left the bus */
    HAL_ERROR_PASSIVE = 1 << 3, /* the controller is error passive or warning */
    HAL_DOWN = 1 << 4,          /* interface down, socket error */
    HAL_UNSENT = 1 << 5,        /* one of several peers could not be sent to; the others were */
    HAL_LOG_ENDED = 1 << 6      /* a recorder around the device can write no more: disk full, limit reached */
};

struct hal {
    void *context;
    /* Takes the next frame that has arrived. Returns 1 with *f filled. Returns 0 when there is none, or
     * when a bound of the device is reached for this plant frame. Returns the negated fault bits (< 0) to
     * report trouble; then *f means nothing, and more frames may wait. */
    int (*recv)(void *context, struct frame *f);
    /* Returns 1 when the frame was taken, 0 when there is no room now. The caller then keeps the newest
     * frame of each identifier. Failures that are found later are reported by recv. */
    int (*send)(void *context, const struct frame *f);
    /* Ends one plant frame: frames that were batched go out now. */
    void (*flush)(void *context);
    /* A free-running microsecond clock, wrapping. For timing reports only; physics never sees it. */
    uint32_t (*now_us)(void *context);
    /* Feeds a watchdog, if there is one. Called once per frame whose work was done, also while a plant fault
     * is latched: the plant then still answers, and a reboot would lose the reason. */
    void (*healthy)(void *context);
};

#endif
