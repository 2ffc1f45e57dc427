/* tee.h - copies the frames that a plant hears and says into memory that another process reads.
 *
 * The plant's side writes without a system call, a lock or a wait. A reader that falls behind by TEE_RECORDS
 * loses what it has not read, knows how much that is, and the plant never notices. There is one reader. */
#ifndef HOST_SIM_TEE_H
#define HOST_SIM_TEE_H

#include <stdbool.h>
#include <stdint.h>
#include "firmware/observe/timing.h"
#include "hal/hal.h"

enum { TEE_RECORDS = 1 << 16, TEE_TIMING_FRAMES = 512 };

enum tee_kind { TEE_FRAME, TEE_LATENESS, TEE_COMPUTE };

struct tee_record {
    uint64_t number; /* 1 and up; other than expected while it is being written */
    uint8_t kind, bin;
    uint32_t count; /* in a histogram's bin */
    struct frame frame;
};

/* In shared memory. */
struct tee_memory {
    uint64_t written; /* records ever */
    bool over;        /* the plant has ended */
    struct tee_record record[TEE_RECORDS];
};

/* The plant's side. */
struct tee {
    struct hal hal; /* give this to the app instead of the inner one */
    struct hal inner;
    struct tee_memory *memory;
    const struct timing *timing;
    uint32_t frames; /* flushed */
};

/* The reader's side. */
struct tee_reader {
    struct hal hal; /* gives the frames; HAL_DROPPED where some were lost */
    const struct tee_memory *memory;
    uint64_t read, lost;
    struct timing timing; /* as far as it was told */
};

/* NULL when there is no memory to share. */
struct tee_memory *tee_share(void);
void tee_unshare(struct tee_memory *m);

void tee_open(struct tee *t, struct tee_memory *m, const struct hal *inner, const struct timing *timing);

/* Tells the reader that the plant has ended. */
void tee_end(struct tee_memory *m);

void tee_read(struct tee_reader *r, const struct tee_memory *m);
bool tee_is_over(const struct tee_reader *r);

#endif
