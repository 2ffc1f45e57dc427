/* force_curve.h - a force curve in the tab-separated form of afmformats, which PyJibe and nanite read:
 * metadata as JSON in comments, the last comment names the columns. All numbers are SI. */
#ifndef HOST_SIM_AFM_FORCE_CURVE_H
#define HOST_SIM_AFM_FORCE_CURVE_H

#include <stddef.h>
#include <stdio.h>

struct force_curve {
    size_t n;                        /* points, those of the approach first: half of them */
    const double *base, *deflection; /* [n]: the undeflected tip over the sample, and the reading */
    double step_s;                   /* from one point to the next */
    double begin_s;                  /* time of the first point */
    double speed, z_range;           /* largest speed of the base, and its way */
    double stiffness;                /* the lever's: an instrument's force is stiffness times deflection */
};

void force_curve_write(FILE *f, const struct force_curve *c);

#endif
