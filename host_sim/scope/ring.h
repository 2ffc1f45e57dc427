/* ring.h - copies the frames that a plant receives and sends into memory that another process reads.
 *
 * The plant's side writes without a system call, a lock or a wait. A reader that falls behind by RING_RECORDS
 * loses what it has not read, knows how much that is, and the plant never notices. There is one reader. */
#ifndef HOST_SIM_RING_H
#define HOST_SIM_RING_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/observe/timing.h"
#include "hal/hal.h"

enum { RING_RECORDS = 1 << 16, RING_TIMING_FRAMES = 512 };

enum ring_kind { RING_FRAME, RING_LATENESS, RING_COMPUTE };

struct ring_record {
    uint64_t number; /* 1 and up; other than expected while it is being written */
    uint8_t kind, bin;
    uint32_t count; /* in a histogram's bin */
    struct frame frame;
};

/* In shared memory. */
struct ring {
    uint64_t written; /* records ever */
    bool over;        /* the plant has ended */
    struct ring_record record[RING_RECORDS];
};

/* The plant's side. */
struct ring_writer {
    struct hal hal; /* give this to the app instead of the inner one */
    struct hal inner;
    struct ring *memory;
    const struct timing *timing;
    uint32_t frames; /* flushed */
};

/* The reader's side. */
struct ring_reader {
    struct hal hal; /* gives the frames; HAL_DROPPED where some were lost */
    const struct ring *memory;
    uint64_t read, lost;
    struct timing timing; /* as far as it has come */
};

/* NULL when there is no memory to share. */
struct ring *ring_share(void);
void ring_unshare(struct ring *m);

void ring_writer_open(struct ring_writer *t, struct ring *m, const struct hal *inner,
                      const struct timing *timing);

/* Tells the reader that the plant has ended. */
void ring_end(struct ring *m);

void ring_reader_open(struct ring_reader *r, const struct ring *m);
bool ring_is_over(const struct ring_reader *r);

#endif
