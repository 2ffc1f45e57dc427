/* lever_law.c - see lever_law.h. */
#include "host_sim/fit/motion/lever_law.h"

#include <math.h>
#include "host_sim/afm/thermal.h"
#include "models/afm_lever.h"

enum { STEPS = 60 };
static const double near = 1e-13; /* share of a step that is none */

double lever_law_density(const double *si, double white, double frequency_Hz)
{
    const struct resonance r = {.f0_Hz = si[LEVER_F0],
                                .quality = si[LEVER_Q],
                                .low = thermal_square(si) /
                                       (0.5 * 3.14159265358979 * si[LEVER_F0] * si[LEVER_Q]),
                                .white = white};
    return resonance_density(&r, frequency_Hz);
}

static double attraction_of(const double *si, bool out)
{
    return si[out ? LEVER_HAMAKER_OUT : LEVER_HAMAKER] * si[LEVER_RADIUS] / 6.0;
}

/* d^3 - b d^2 + A/k = 0 for the gap d: Newton's method falls from b to the largest root. The last one is at
 * the fold b = f, where d = 2/3 (f + sqrt(f (b - f))) to lowest order; below it the root's sign turns. */
bool lever_law_outside(const double *si, bool out, double base_m, double *x)
{
    double share = attraction_of(si, out) / si[LEVER_K], d = base_m, fold = cbrt(6.75 * share);
    if (!(base_m > si[LEVER_A0]) || base_m < fold) {
        *x = 2.0 / 3.0 * (fold - sqrt(fold * fmax(fold - base_m, 0.0))) - base_m;
        return false;
    }
    for (int i = 0; i < STEPS; i++) {
        double slope = d * (3.0 * d - 2.0 * base_m), step = (d * d * (d - base_m) + share) / slope;
        if (!(slope > 0.0) || fabs(step) <= near * d)
            break;
        d -= step;
    }
    *x = d - base_m;
    return d > si[LEVER_A0];
}

/* h s^3 + k s^2 = k (a0 - b) + F_ad for the root s of the depth; below 0 without h. */
bool lever_law_contact(const double *si, bool out, double base_m, double *x)
{
    double k = si[LEVER_K], a0 = si[LEVER_A0], h = 4.0 / 3.0 * si[LEVER_MODULUS] * sqrt(si[LEVER_RADIUS]);
    double load = k * (a0 - base_m) + attraction_of(si, out) / (a0 * a0);
    if (!(load >= 0.0)) {
        *x = a0 - load / k - base_m;
        return false;
    }
    double s = fmin(sqrt(load / k), cbrt(load / h));
    for (int i = 0; i < STEPS && s > 0.0; i++) {
        double step = (s * s * (h * s + k) - load) / (s * (3.0 * h * s + 2.0 * k));
        s -= step;
        if (fabs(step) <= near * s)
            break;
    }
    *x = a0 - s * s - base_m;
    return true;
}
