/* lever.h - data measured of an AFM lever: a spectrum of its thermal motion, and a force curve.
 *
 * A spectrum has columns frequency_Hz and density_m2_per_Hz, as contactplant thermal writes them. A force
 * curve has columns base_m, deflection_m and retract (0 or 1), or is a .tab of afmformats with `height
 * (measured)`, `tip position` and `segment`: both as contactplant approach writes them. */
#ifndef HOST_SIM_FIT_LEVER_H
#define HOST_SIM_FIT_LEVER_H

#include "host_sim/fit/data/table.h"

enum { LEVER_DATA = 2, LEVER_ROWS_MOST = 1 << 20, LEVER_LAG = 4 };
enum lever_kind { LEVER_SPECTRUM, LEVER_CURVE };

/* The side of a number: outside or in contact; LEVER_SKIPPED does not count. */
enum lever_side { LEVER_OUTSIDE, LEVER_CONTACT, LEVER_SIDES, LEVER_SKIPPED = LEVER_SIDES };

struct lever_data {
    enum lever_kind kind;
    const char *path;
    int n;
    double *x, *y; /* [n] Hz and m^2/Hz, or base and deflection in m */
    bool *back;    /* [n] on the way back, of a force curve */
    bool has_back;
    uint8_t *side;             /* [n] as the last residuals took it */
    bool sides_told[2];        /* on the way in, and back: the data say which rows are in contact */
    double sigma[LEVER_SIDES]; /* standard deviation: share of the density, or m */
    double widen;              /* intervals are this much wider than those of independent numbers */
    /* seen without a plant: of a spectrum f0, Q, the mean square, the noise of the sensor; of a curve the
     * deflection outside */
    double f0_Hz, quality, square_m2, white, baseline_m;
};

struct lever_set {
    int n;
    bool sides_known; /* each number stays on its side */
    struct lever_data data[LEVER_DATA];
};

/* Adds a spectrum, or a force curve. *crc goes on. 0, or the exit status after a line. */
int lever_read(const struct usage *u, const char *path, enum lever_kind kind, uint32_t *crc,
               struct lever_set *set);

void lever_free(struct lever_set *set);

#endif
