/* hertz_rig.h - a mass on a preloaded, single-sided Hertzian contact (Nayak 1972; Bichri, Belhaq & Perret-Liaudet 2011).
 *
 *   m z'' + c (z' - ze') + k (1 + u_stiffness) (z - ze)_+^{3/2} = N + F_force + F_fast
 *
 * z is the mass position measured from the point where the unloaded contact just touches, positive into the contact;
 * ze is the base displacement. In units of the static compression zs = (N/k)^{2/3}, the preload N and the time 1/nu,
 * nu^2 = 3 N/(2 m zs), xi = c/(2 m nu), with y = z/zs, b = ze/zs, eta = y - b:
 *
 *   y'' = (2/3) (1 + u_force + u_fast - (1 + u_stiffness) eta_+^{3/2}) - 2 xi (y' - b')
 *
 * Contact is lost for eta < 0; at rest y = 1. The paper's q = (3/2)(y - 1). */
#ifndef MODELS_HERTZ_RIG_H
#define MODELS_HERTZ_RIG_H

#include <math.h>
#include "models/model.h"

extern const struct model hertz_rig;

/* Inputs, SI parameters and prepared numbers, in the order of their tables. */
enum { RIG_FORCE, RIG_FAST_FORCE, RIG_BASE, RIG_STIFFNESS };
enum { RIG_MASS, RIG_CONTACT_STIFFNESS, RIG_PRELOAD, RIG_DAMPING };
enum { RIG_P_TWO_XI };

/* Contact force in units of the preload at unmodulated stiffness; 0 apart. */
static inline double hertz_rig_contact(double eta)
{
    double e = eta > 0.0 ? eta : 0.0;
    return e * sqrt(e);
}

static inline void hertz_rig_rhs(const double *p, const struct input *u, const double *x, double *x_dot)
{
    double two_xi = p[RIG_P_TWO_XI];
    /* What does not depend on the state stands first: it is ready before the square root chain needs it. */
    double drive =
        (2.0 / 3.0) * (1.0 + (u[RIG_FORCE].value + u[RIG_FAST_FORCE].value)) + two_xi * u[RIG_BASE].rate;
    double stiffness = (2.0 / 3.0) * (1.0 + u[RIG_STIFFNESS].value);
    double eta = x[0] - u[RIG_BASE].value;
    x_dot[0] = x[1];
    x_dot[1] = (drive - two_xi * x[1]) - stiffness * hertz_rig_contact(eta);
}

static inline void hertz_rig_gap(const double *p, const struct input *u, const double *x, struct input *gap)
{
    (void)p;
    gap->value = u[RIG_BASE].value - x[0];
    gap->rate = u[RIG_BASE].rate - x[1];
}

#endif
