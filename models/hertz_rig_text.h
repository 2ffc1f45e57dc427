/* hertz_rig_text.h - acceleration and gap of the rig; a text for models/hertz_rig.h and models/flows.h, see
 * models/lanes.h. */

ALWAYS_INLINE void REAL(hertz_rig_rhs)(const number *p, const struct REAL(input) * u, const real *x,
                                       real *x_dot)
{
    number two_xi = p[RIG_P_TWO_XI];
    /* Terms without the state stand first: they are ready before the square root. */
    real drive =
        (2.0 / 3.0) * (1.0 + (u[RIG_FORCE].value + u[RIG_FAST_FORCE].value)) + two_xi * u[RIG_BASE].rate;
    real stiffness = (2.0 / 3.0) * (1.0 + u[RIG_STIFFNESS].value);
    real eta = x[0] - u[RIG_BASE].value;
    x_dot[0] = x[1];
    x_dot[1] = (drive - two_xi * x[1]) - stiffness * REAL(hertz_contact_force)(eta);
}

/* rhs where base and stiffness are at rest: the same bits, a quarter fewer instructions. */
ALWAYS_INLINE void REAL(hertz_rig_rhs_forced)(const number *p, const struct REAL(input) * u, const real *x,
                                              real *x_dot)
{
    real drive = (2.0 / 3.0) * (1.0 + (u[RIG_FORCE].value + u[RIG_FAST_FORCE].value));
    x_dot[0] = x[1];
    x_dot[1] = (drive - p[RIG_P_TWO_XI] * x[1]) - (2.0 / 3.0) * REAL(hertz_contact_force)(x[0]);
}

ALWAYS_INLINE void REAL(hertz_rig_gap)(const number *p, const struct REAL(input) * u, const real *x,
                                       struct REAL(input) * gap)
{
    (void)p;
    gap->value = u[RIG_BASE].value - x[0];
    gap->rate = u[RIG_BASE].rate - x[1];
}

ALWAYS_INLINE void REAL(hertz_rig_gap_forced)(const number *p, const struct REAL(input) * u, const real *x,
                                              struct REAL(input) * gap)
{
    (void)p, (void)u;
    gap->value = -x[0];
    gap->rate = -x[1];
}
