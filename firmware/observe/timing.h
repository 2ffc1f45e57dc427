/* timing.h - how long frames take and how late they start: histograms and maxima with their frame. Reports
 * only. */
#ifndef FIRMWARE_TIMING_H
#define FIRMWARE_TIMING_H

#include <stdint.h>

enum { TIMING_BINS = 20 }; /* bin k holds [2^(k-1), 2^k) us, bin 0 holds 0; the last bin everything above */

struct histogram {
    uint32_t bin[TIMING_BINS];
    uint32_t max_us;
    uint64_t max_frame; /* bus frame at which the maximum happened */
};

struct timing {
    struct histogram compute;  /* app_frame, begin to end */
    struct histogram lateness; /* start of a frame after its due time, reported by the scheduler */
};

/* Adds the time of one bus frame, in microseconds, to its bin. A new maximum is kept with its frame; an
 * equal one does not replace it. Bins wrap after 2^32 frames. */
void histogram_add(struct histogram *h, uint32_t us, uint64_t frame);

#endif
