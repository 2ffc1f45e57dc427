/* fit.c - see fit.h. */
#include "host_sim/trial/fit.h"

#include <math.h>
#include "models/math/elementary.h"

void fit_add(struct fit *f, double place, uint64_t turns, double x)
{
    double c, s, w_c, w_s;
    cos_sin_turns(turns, &c, &s);
    cos_sin_turns(turns_of(place), &w_c, &w_s);
    double w = 0.5 * (1.0 - w_c), wc = w * c, ws = w * s;
    f->n++;
    f->w += w;
    f->c += wc, f->s += ws;
    f->cc += wc * c, f->ss += ws * s, f->cs += wc * s;
    f->x += w * x, f->xc += wc * x, f->xs += ws * x;
}

/* The mean is taken out first; two equations are left. At least half of the wave's power must be left in
 * them, less rounding: one period has so much. */
bool fit_solve(const struct fit *f, double *amplitude, double *phase_deg)
{
    double w = f->w;
    if (f->n < 4)
        return false;
    double cc = f->cc - f->c * f->c / w, ss = f->ss - f->s * f->s / w, cs = f->cs - f->c * f->s / w;
    double xc = f->xc - f->x * f->c / w, xs = f->xs - f->x * f->s / w;
    double determinant = cc * ss - cs * cs, half = 0.5 * (cc - ss);
    if (!(0.5 * (cc + ss) - sqrt(half * half + cs * cs) > 0.24 * w))
        return false;
    double a = (xc * ss - xs * cs) / determinant, b = (xs * cc - xc * cs) / determinant;
    *amplitude = sqrt(a * a + b * b);
    *phase_deg = arc_tangent(-b, a) * 180.0 / ELEMENTARY_PI;
    return true;
}
