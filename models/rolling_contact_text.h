/* rolling_contact_text.h - acceleration and gap of the rolling contact; a text for models/rolling_contact.h
 * and models/flows.h, see models/lanes.h. */

ALWAYS_INLINE void REAL(rolling_contact_rhs)(const number *p, const struct REAL(input) * u, const real *x,
                                             real *x_dot)
{
    real drive = (2.0 / 3.0) * (1.0 + u[ROLLING_FORCE].value);
    real eta = x[0] + u[ROLLING_WAVINESS].value;
    x_dot[0] = x[1];
    x_dot[1] = (drive - p[ROLLING_P_TWO_ZETA] * x[1]) - (2.0 / 3.0) * REAL(hertz_contact_force)(eta);
}

ALWAYS_INLINE void REAL(rolling_contact_gap)(const number *p, const struct REAL(input) * u, const real *x,
                                             struct REAL(input) * gap)
{
    (void)p;
    gap->value = -(x[0] + u[ROLLING_WAVINESS].value);
    gap->rate = -(x[1] + u[ROLLING_WAVINESS].rate);
}
