/* timing.c - logarithmic histograms; see timing.h. */
#include "firmware/observe/timing.h"

void histogram_add(struct histogram *h, uint32_t us, uint64_t frame)
{
    int k = 0;
    while (k < TIMING_BINS - 1 && us >> k != 0)
        k++;
    h->bin[k]++;
    if (us > h->max_us) {
        h->max_us = us;
        h->max_frame = frame;
    }
}
