/* flows_text.h - the powers of models with a Hertzian contact, for the ledger; a text for models/flows.h. */

ALWAYS_INLINE void REAL(hertz_rig_flow)(const number *p, const struct REAL(input) * u, const real *x,
                                        struct REAL(flow) * f)
{
    real modulation = u[RIG_STIFFNESS].value;
    real contact = (2.0 / 3.0) * REAL(hertz_contact_force)(x[0] - u[RIG_BASE].value);
    real relative = x[1] - u[RIG_BASE].rate; /* penetration rate */
    real damper = p[RIG_P_TWO_XI] * relative;
    real elastic = (1.0 + modulation) * contact;
    real drive = (2.0 / 3.0) * (1.0 + (u[RIG_FORCE].value + u[RIG_FAST_FORCE].value));
    f->x_dot[0] = x[1];
    f->x_dot[1] = drive - elastic - damper;
    f->work[RIG_FORCE] = (2.0 / 3.0) * u[RIG_FORCE].value * x[1];
    f->work[RIG_FAST_FORCE] = (2.0 / 3.0) * u[RIG_FAST_FORCE].value * x[1];
    f->work[RIG_BASE] = -(elastic + damper) * u[RIG_BASE].rate;
    f->work[RIG_STIFFNESS] = -modulation * contact * relative;
    f->damping = damper * relative;
    f->force = 1.5 * elastic;
}

/* flow where base and stiffness are at rest: the same bits; their work, which is 0, is not written. */
ALWAYS_INLINE void REAL(hertz_rig_flow_forced)(const number *p, const struct REAL(input) * u, const real *x,
                                               struct REAL(flow) * f)
{
    real contact = (2.0 / 3.0) * REAL(hertz_contact_force)(x[0]);
    real damper = p[RIG_P_TWO_XI] * x[1];
    real drive = (2.0 / 3.0) * (1.0 + (u[RIG_FORCE].value + u[RIG_FAST_FORCE].value));
    f->x_dot[0] = x[1];
    f->x_dot[1] = drive - contact - damper;
    f->work[RIG_FORCE] = (2.0 / 3.0) * u[RIG_FORCE].value * x[1];
    f->work[RIG_FAST_FORCE] = (2.0 / 3.0) * u[RIG_FAST_FORCE].value * x[1];
    f->damping = damper * x[1];
    f->force = 1.5 * contact;
}

ALWAYS_INLINE void REAL(rolling_contact_flow)(const number *p, const struct REAL(input) * u, const real *x,
                                              struct REAL(flow) * f)
{
    real contact = (2.0 / 3.0) * REAL(hertz_contact_force)(x[0] + u[ROLLING_WAVINESS].value);
    real damper = p[ROLLING_P_TWO_ZETA] * x[1];
    real drive = (2.0 / 3.0) * u[ROLLING_FORCE].value;
    f->x_dot[0] = x[1];
    f->x_dot[1] = (2.0 / 3.0) + drive - contact - damper;
    f->work[ROLLING_FORCE] = drive * x[1];
    f->work[ROLLING_WAVINESS] = contact * u[ROLLING_WAVINESS].rate;
    f->damping = damper * x[1];
    f->force = 1.5 * contact;
}

ALWAYS_INLINE void REAL(afm_tip_flow)(const number *p, const struct REAL(input) * u, const real *x,
                                      struct REAL(flow) * f)
{
    real modulation = u[TIP_STIFFNESS].value;
    real hertz = REAL(hertz_contact_force)(x[0]), contact = p[TIP_P_HERTZ] * hertz;
    real drive = (1.0 + p[TIP_P_HERTZ]) + u[TIP_FORCE].value;
    f->x_dot[0] = x[1];
    f->x_dot[1] = ((drive - x[0]) - p[TIP_P_DAMPING] * x[1]) - p[TIP_P_HERTZ] * (1.0 + modulation) * hertz;
    f->work[TIP_FORCE] = u[TIP_FORCE].value * x[1];
    f->work[TIP_STIFFNESS] = -modulation * contact * x[1];
    f->damping = p[TIP_P_DAMPING] * x[1] * x[1];
    f->force = REAL(fabs)((1.0 + modulation) * contact);
}
