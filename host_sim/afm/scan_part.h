/* scan_part.h - a scan that was cut off: DIR/scan.part has the whole microscope and the image so far, and the
 * same command goes on from there, to the same bytes. */
#ifndef HOST_SIM_AFM_SCAN_PART_H
#define HOST_SIM_AFM_SCAN_PART_H

#include "host_sim/afm/scan.h"

enum { SCAN_PATH = 4096 };

struct scan_part {
    char path[SCAN_PATH]; /* "": none is kept */
    int lock;             /* the directory, or -1 */
    double kept_s;        /* when it was written last */
};

/* Takes the directory for this process. 0, or the exit status after a line; so for all below. */
int scan_part_open(struct scan_part *p, const struct afm_bench *b, const char *directory);

/* Takes up a scan of these numbers, after afm_bench_start. *found: there was one, and the bench is in the
 * midst of it. A file of another scan or one that is damaged is refused, and left as it is. */
int scan_part_read(const struct scan_part *p, struct afm_bench *b, struct scan_image *m, bool *found);

/* Keeps the scan as it is now, in the place of what was kept before: all of it, or nothing. */
int scan_part_write(struct scan_part *p, const struct afm_bench *b, const struct scan_image *m);

/* The scan is complete. */
void scan_part_end(struct scan_part *p);

#endif
