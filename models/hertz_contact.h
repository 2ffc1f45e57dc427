/* hertz_contact.h - the single-sided Hertzian contact in normalised units (Hertz 1882: F = k z^{3/2}).
 *
 * eta is the compression in units of the static one. The force is 1 at eta = 1, and 0 for eta <= 0. One
 * square root, no errors. */
#ifndef MODELS_HERTZ_CONTACT_H
#define MODELS_HERTZ_CONTACT_H

#include <math.h>

/* eta_+^{3/2} */
static inline double hertz_contact_force(double eta)
{
    double e = eta > 0.0 ? eta : 0.0;
    return e * sqrt(e);
}

/* The integral of the force over eta, (2/5) eta_+^{5/2}. */
static inline double hertz_contact_energy(double eta)
{
    double e = eta > 0.0 ? eta : 0.0;
    return 0.4 * e * hertz_contact_force(e);
}

/* (2/3) (1 + d)^{3/2} = 2/3 + d + d^2/4 - d^3/24 + O(d^4): coefficient of d^k, for the cubic models. */
#define HERTZ_CUBIC                                                                                          \
    {                                                                                                        \
        2.0 / 3.0, 1.0, 0.25, -1.0 / 24.0                                                                    \
    }

#endif
