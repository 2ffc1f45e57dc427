/* demodulator.c - see demodulator.h. */
#include "firmware/afm/demodulator.h"

#include <math.h>
#include "models/math/elementary.h"

void demodulator_init(struct demodulator *d, double bandwidth_Hz, double sample_s)
{
    *d = (struct demodulator){.share = 1.0 - exponential(-2.0 * ELEMENTARY_PI * bandwidth_Hz * sample_s)};
}

static double low_pass(double share, double *pole, double value)
{
    pole[0] += share * (value - pole[0]);
    pole[1] += share * (pole[0] - pole[1]);
    return pole[1];
}

void demodulator_run(struct demodulator *d, double reading, double cosine, double sine)
{
    double in_phase = low_pass(d->share, d->i, 2.0 * cosine * reading);
    double quadrature = low_pass(d->share, d->q, -2.0 * sine * reading);
    d->amplitude = sqrt(in_phase * in_phase + quadrature * quadrature);
}

double demodulator_phase(const struct demodulator *d)
{
    return arc_tangent(d->q[1], d->i[1]);
}
