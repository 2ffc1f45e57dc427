/* scan.h - an image of the microscope: pixels of trace and retrace, one channel each. */
#ifndef HOST_SIM_SCAN_H
#define HOST_SIM_SCAN_H

#include "host_sim/afm/afm_bench.h"

enum scan_channel {
    SCAN_HEIGHT,
    SCAN_ERROR,
    SCAN_AMPLITUDE,
    SCAN_PHASE,
    SCAN_PEAK,
    SCAN_FREQUENCY,
    SCAN_FORCE_ERROR,
    SCAN_ADHESION,
    SCAN_MODULUS,
    SCAN_DEFORMATION,
    SCAN_DISSIPATION,
    SCAN_SURFACE, /* the truth: no file, for the picture and the verdict */
    SCAN_CHANNELS
};

struct scan_image {
    size_t pixels, lines;
    float *value[2][SCAN_CHANNELS]; /* trace, retrace: [lines][pixels] */
};

/* Memory for an image of the station's numbers; false without. */
bool scan_alloc(struct scan_image *m, const double *number);
void scan_free(struct scan_image *m);

/* Runs the image from where it is, with progress on stderr. `part`: keeps it now and then, and when it is
 * interrupted; or NULL. `volume`: takes curves; or NULL. station_begin_scan comes before. */
struct scan_part;
struct volume;
int scan_run(struct afm_bench *b, struct scan_image *m, struct scan_part *part, struct volume *volume);

/* One line about it: largest force, crashes, share of pixels off the surface, error, the piezo's limit. */
enum { SCAN_VERDICT = 400 };
void scan_verdict(const struct afm_bench *b, const struct scan_image *m, char text[SCAN_VERDICT]);

/* True where a pixel's amplitude says that the tip is off the sample, on its way down. */
bool scan_is_parachute(const double *number, double amplitude_m);

#endif
