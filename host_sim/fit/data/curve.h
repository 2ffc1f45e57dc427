/* curve.h - a measured response curve: the first harmonic of an output at rising frequencies, at one
 * amplitude of a drive.
 *
 * A file has lines `# key = value unit` (amplitude, input, output, direction, noise), then a header, then
 * rows: frequency_Hz, amplitude_m and phase_rad, or re_m_per_N and im_m_per_N, and sigma_m where it is known.
 * The rows of contactplant sweep are taken as they are: a curve for each direction and value of the family.
 */
#ifndef HOST_SIM_FIT_CURVE_H
#define HOST_SIM_FIT_CURVE_H

#include "host_sim/fit/data/table.h"
#include "models/scenes/scenes.h"

enum { CURVES = 32, CURVE_POINTS = 5000 };

struct curve_point {
    double frequency_Hz;
    double re, im; /* the parts of A e^(i phase), SI; without phase re is A */
    double sigma;  /* standard deviation of each of the two; 0: not known */
    int line;      /* line of the file */
};

struct curve {
    const char *path;
    double amplitude; /* amplitude of the drive */
    int input, output, derivatives;
    bool down;      /* swept from high to low frequencies */
    bool has_phase; /* else only A is known */
    double noise;   /* share of the amplitude; 0: not given */
    bool assumed;   /* a point has no standard deviation of its own */
    int n;
    struct curve_point *point; /* from low to high frequencies */
};

struct curves {
    int n;
    struct curve curve[CURVES];
};

/* Adds the curves of a file, measured on the rig of this scene. *crc, CRC-32 of all data files, goes on. 0,
 * or the exit status after a line. */
int curves_read(const struct usage *u, const char *path, const struct scene *s, uint32_t *crc,
                struct curves *c);

void curves_free(struct curves *c);

/* The unit of what was measured: that of the output, or of its derivative. */
const char *curve_unit(const struct curve *c, const struct model *m);

/* The quantity that was measured: "displacement", "acceleration". */
const char *curve_name(const struct curve *c, const struct model *m);

#endif
