/* share.h - one bus for many plants: each frame goes to the plant that owns its identifier.
 *
 * Plant i owns the FRAME_IDS identifiers from base_id + i * FRAME_IDS on, and has a hal of its own. A plant
 * frame of all of them goes so:
 *
 *     share_collect(&s);                         (takes what has arrived, once for all)
 *     for each plant: app_frame                  (on s.part[i].hal)
 *     share_flush(&s);                           (one flush of the bus)
 *
 * A frame of nobody's identifiers is passed over. Each plant hears a fault of the bus. A plant that gets
 * more than SHARE_QUEUE frames between two of its turns loses the newest ones and hears HAL_DROPPED. The
 * others lose nothing. SHARE_URGENT further places are kept for its urgent identifiers, so a flood does not
 * hide a STOP. No heap: the owner gives the parts. */
#ifndef HAL_SHARE_H
#define HAL_SHARE_H

#include <stdint.h>
#include "hal/hal.h"

enum {
    SHARE_QUEUE = 256,    /* frames that wait for one plant */
    SHARE_URGENT = 16,    /* and urgent ones beyond */
    SHARE_LOOKS = 1 << 17 /* frames and faults taken from the bus in one turn */
};

/* One plant's side. */
struct share_part {
    struct hal hal; /* give this to the app */
    const struct hal *bus;
    struct frame queue[SHARE_QUEUE + SHARE_URGENT];
    uint32_t n, i; /* frames in the queue, and the next one to hand out */
    int fault;     /* hal_fault bits for the next recv */
};

struct share {
    const struct hal *bus; /* the device; it must outlive this */
    struct share_part *part;
    uint32_t n_parts, base_id, n_urgent;
    uint8_t flags; /* FRAME_EXTENDED: the plants' identifiers have 29 bits */
};

/* Sets up n parts, whose memory is the caller's. `n_urgent`: so many of the lowest identifiers of each plant
 * are urgent. Neither *s nor the parts may be moved. */
void share_init(struct share *s, const struct hal *bus, struct share_part *part, uint32_t n, uint32_t base_id,
                uint8_t flags, uint32_t n_urgent);

/* Takes what waits on the bus and hands it out. */
void share_collect(struct share *s);

/* Ends the plant frame of all parts: what they sent goes out, and a watchdog is fed. */
void share_flush(const struct share *s);

#endif
