/* afm_tip_text.h - acceleration and gap of the tip; a text for models/afm_tip.h and models/flows.h, see
 * models/lanes.h. */

ALWAYS_INLINE void REAL(afm_tip_rhs)(const number *p, const struct REAL(input) * u, const real *x,
                                     real *x_dot)
{
    number b = p[TIP_P_HERTZ];
    real drive = (1.0 + b) + u[TIP_FORCE].value;
    real stiffness = b * (1.0 + u[TIP_STIFFNESS].value);
    x_dot[0] = x[1];
    x_dot[1] = ((drive - x[0]) - p[TIP_P_DAMPING] * x[1]) - stiffness * REAL(hertz_contact_force)(x[0]);
}

ALWAYS_INLINE void REAL(afm_tip_gap)(const number *p, const struct REAL(input) * u, const real *x,
                                     struct REAL(input) * gap)
{
    (void)p, (void)u;
    gap->value = -x[0];
    gap->rate = -x[1];
}
