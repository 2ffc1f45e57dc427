/* record.h - a measured motion at equal times: free (a ring-down), or under a drive that was measured, too.
 * Where a number of the motion is missing it is NaN, and counts nowhere.
 *
 * A file has lines `# key = value unit` (output, input, noise), then a header. Its rows are time_s and the
 * output by its name (displacement_um, velocity_m_per_s). The drive follows by its name (force_N) where there
 * is one. */
#ifndef HOST_SIM_FIT_RECORD_H
#define HOST_SIM_FIT_RECORD_H

#include "host_sim/fit/data/table.h"
#include "models/scenes/scenes.h"

enum { RECORDS = 2, RECORD_POINTS = 100000 };

/* amplitude cos(2 pi frequency t + phase) from the begin of the record on; amplitude 0: none. */
struct record_tone {
    double amplitude, frequency_Hz, phase_rad;
    bool phase_known; /* else it is found, too */
};

struct record {
    const char *path;
    int output, input; /* input -1: no drive */
    int n;
    double step_s;
    double *y, *u; /* [n] output and drive, SI */
    bool jumps;    /* the drive jumps to u[i + 1] behind time i, else it goes there in a straight line */
    struct record_tone tone;
    double noise; /* standard deviation, SI; 0: not given */
    double floor; /* the noise is no smaller: that of rounding */
    bool assumed; /* the noise was not given */
    double size;  /* standard deviation of y: how large the motion is */
    double frequency_Hz,
        decay_per_s; /* seen in the later half of a free motion, roughly: a sine, e^(-decay t) */
};

struct records {
    int n;
    struct record record[RECORDS];
};

/* Adds the record of a file of the rig of this scene; driven: with a drive. *crc goes on. 0, or the exit
 * status after a line. */
int records_read(const struct usage *u, const char *path, const struct scene *s, bool driven, uint32_t *crc,
                 struct records *all);

void records_free(struct records *r);

/* Numbers of the motion, and their standard deviation. */
int record_count(const double *y, int n);
double record_deviation(const double *y, int n);

#endif
