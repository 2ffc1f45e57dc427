/* fit.c - see fit.h. */
#include "host_sim/trial/fit.h"

#include <math.h>
#include "models/math/elementary.h"

void fit_add(struct fit *f, uint64_t turns, double x)
{
    double c, s;
    cos_sin_turns(turns, &c, &s);
    f->n++;
    f->c += c, f->s += s;
    f->cc += c * c, f->ss += s * s, f->cs += c * s;
    f->x += x, f->xc += x * c, f->xs += x * s;
}

/* The mean is taken out first; two equations are left. */
bool fit_solve(const struct fit *f, double *amplitude, double *phase_deg)
{
    double n = (double)f->n;
    if (f->n < 4)
        return false;
    double cc = f->cc - f->c * f->c / n, ss = f->ss - f->s * f->s / n, cs = f->cs - f->c * f->s / n;
    double xc = f->xc - f->x * f->c / n, xs = f->xs - f->x * f->s / n;
    double determinant = cc * ss - cs * cs;
    if (!(determinant > 1e-6 * n * n))
        return false;
    double a = (xc * ss - xs * cs) / determinant, b = (xs * cc - xc * cs) / determinant;
    *amplitude = sqrt(a * a + b * b);
    *phase_deg = arc_tangent(-b, a) * 180.0 / ELEMENTARY_PI;
    return true;
}
