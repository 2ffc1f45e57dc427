/* thermal.h - the heat of a free lever: spectrum, fit, calibration. */
#ifndef HOST_SIM_THERMAL_H
#define HOST_SIM_THERMAL_H

#include "host_sim/afm/afm_bench.h"
#include "host_sim/afm/spectrum.h"
#include "host_sim/cli/chart.h"

struct thermal {
    struct spectrum spectrum; /* to be freed */
    struct resonance fit;
    double factor;    /* share of kT/k that the first mode has at the sensor */
    double square_m2; /* mean square of the first mode, by the fit */
    double stiffness; /* by equipartition, N/m */
};

/* The mean square of the first mode at the sensor by equipartition, m^2; si in the order of afm_lever. */
double thermal_square(const double *si);

/* Before afm_bench_start: no drive, no loop, far from the sample. */
void thermal_prepare(struct afm_bench *b);

/* Listens for so long. 0, or the exit status after a line. */
int thermal_listen(struct afm_bench *b, double seconds, struct thermal *t);

/* The part around the resonance, with the fit, as a panel with its own axis. 1 without memory. */
int thermal_panel(struct chart *c, const struct thermal *t, double height);

#endif
