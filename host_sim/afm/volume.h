/* volume.h - force volume: the curve of each n-th pixel of a scan by peak force, in files of a folder. */
#ifndef HOST_SIM_AFM_VOLUME_H
#define HOST_SIM_AFM_VOLUME_H

#include "host_sim/afm/scan.h"

enum { VOLUME_CURVES = 100000 /* at most */ };

struct volume {
    struct afm_bench *bench;
    const char *directory;
    uint32_t every;            /* pixels and lines from one curve to the next */
    size_t n, samples;         /* rows now, and in a cycle */
    double *base, *deflection; /* [samples] */
    uint32_t line, pixel;      /* place of the rows */
    bool begun, done;
};

/* The option --volume with --every, for a scan that is ready to begin; without it v->directory is NULL. 0, or
 * the exit status after a line; so for all below. */
int volume_open(struct volume *v, struct afm_bench *b);

/* After each sample of the image. The first whole cycle of a wanted pixel of the trace, from top to top, is
 * its curve: a file curve_LINE_PIXEL.tab. */
int volume_take(struct volume *v);

/* The list of the curves with what the images say of their pixels: volume.csv. */
int volume_end(struct volume *v, const struct scan_image *m);

void volume_free(struct volume *v);

#endif
