/* shaft_text.h - forces and powers of the shaft; a text for models/shaft_bearing.h and models/flows.h, see
 * lanes.h. */

/* How far x is beyond a gap on either side, with its sign. */
SHAFT_INLINE real REAL(shaft_bearing_over)(real x, double gap)
{
    real above = x - gap, below = x + gap;
    return REAL(real_positive)(above) + REAL(real_negative)(below);
}

/* Force of the gap spring on mass i, 0 or 2, with the sign of x. */
SHAFT_INLINE real REAL(shaft_bearing_contact)(const double *p, const real *x, int i)
{
    return p[SHAFT_P_CONTACT + i] * REAL(shaft_bearing_over)(x[i], p[SHAFT_P_GAP + i]);
}

/* The force on each mass without gap springs. */
SHAFT_INLINE void REAL(shaft_bearing_force)(const double *p, const struct REAL(input) * u, const real *x,
                                            real *force)
{
    real bend = (x[0] + x[2]) - 2.0 * x[1];
    force[0] = (u[0].value - p[SHAFT_P_DAMPING] * x[3]) - (p[SHAFT_P_SUPPORT] * x[0] + bend);
    force[1] = (u[1].value - p[SHAFT_P_DAMPING + 1] * x[4]) + 2.0 * bend;
    force[2] = (u[2].value - p[SHAFT_P_DAMPING + 2] * x[5]) - (p[SHAFT_P_SUPPORT + 2] * x[2] + bend);
}

SHAFT_INLINE void REAL(shaft_bearing_accelerate)(const double *p, const real *force, const real *x,
                                                 real *x_dot)
{
    for (int i = 0; i < 3; i++) {
        x_dot[i] = x[3 + i];
        x_dot[3 + i] = p[SHAFT_P_INVERSE_MASS + i] * force[i];
    }
}

SHAFT_INLINE void REAL(shaft_bearing_rhs)(const double *p, const struct REAL(input) * u, const real *x,
                                          real *x_dot)
{
    real force[3];
    REAL(shaft_bearing_force)(p, u, x, force);
    force[0] -= REAL(shaft_bearing_contact)(p, x, 0);
    force[2] -= REAL(shaft_bearing_contact)(p, x, 2);
    REAL(shaft_bearing_accelerate)(p, force, x, x_dot);
}

/* rhs of shaft_bearing_linear. */
SHAFT_INLINE void REAL(shaft_bearing_rhs_open)(const double *p, const struct REAL(input) * u, const real *x,
                                               real *x_dot)
{
    real force[3];
    REAL(shaft_bearing_force)(p, u, x, force);
    REAL(shaft_bearing_accelerate)(p, force, x, x_dot);
}

SHAFT_INLINE void REAL(shaft_bearing_powers)(const double *p, const struct REAL(input) * u, const real *x,
                                             struct REAL(flow) * f)
{
    f->damping = (real){0.0};
    for (int i = 0; i < 3; i++) {
        f->work[i] = u[i].value * x[3 + i];
        f->damping += p[SHAFT_P_DAMPING + i] * x[3 + i] * x[3 + i];
    }
}

SHAFT_INLINE void REAL(shaft_bearing_flow)(const double *p, const struct REAL(input) * u, const real *x,
                                           struct REAL(flow) * f)
{
    real contact1 = REAL(fabs)(REAL(shaft_bearing_contact)(p, x, 0)),
         contact3 = REAL(fabs)(REAL(shaft_bearing_contact)(p, x, 2));
    REAL(shaft_bearing_rhs)(p, u, x, f->x_dot);
    REAL(shaft_bearing_powers)(p, u, x, f);
    f->force = REAL(real_larger)(contact1, contact3);
}

SHAFT_INLINE void REAL(shaft_bearing_flow_open)(const double *p, const struct REAL(input) * u, const real *x,
                                                struct REAL(flow) * f)
{
    REAL(shaft_bearing_rhs_open)(p, u, x, f->x_dot);
    REAL(shaft_bearing_powers)(p, u, x, f);
    f->force = (real){0.0};
}

/* ---- one mode: positions phi_i q ---- */

/* Force of the gap spring on mass i, 0 or 2. */
SHAFT_INLINE real REAL(shaft_mode_contact)(const double *p, real q, int i)
{
    return p[SHAFT_P_CONTACT + i] * REAL(shaft_bearing_over)(p[SHAFT_P_SHAPE + i] * q, p[SHAFT_P_GAP + i]);
}

SHAFT_INLINE void REAL(shaft_mode_rhs)(const double *p, const struct REAL(input) * u, const real *x,
                                       real *x_dot)
{
    const double *phi = &p[SHAFT_P_SHAPE];
    real push = (phi[0] * u[0].value + phi[2] * u[2].value) + phi[1] * u[1].value;
    real contact =
        phi[0] * REAL(shaft_mode_contact)(p, x[0], 0) + phi[2] * REAL(shaft_mode_contact)(p, x[0], 2);
    real own = p[SHAFT_P_MODE_DAMPING] * x[1] + p[SHAFT_P_MODE_STIFFNESS] * x[0];
    x_dot[0] = x[1];
    x_dot[1] = p[SHAFT_P_MODE_INVERSE_MASS] * ((push - own) - contact);
}

SHAFT_INLINE void REAL(shaft_mode_flow)(const double *p, const struct REAL(input) * u, const real *x,
                                        struct REAL(flow) * f)
{
    real contact1 = REAL(fabs)(REAL(shaft_mode_contact)(p, x[0], 0)),
         contact3 = REAL(fabs)(REAL(shaft_mode_contact)(p, x[0], 2));
    REAL(shaft_mode_rhs)(p, u, x, f->x_dot);
    for (int i = 0; i < 3; i++)
        f->work[i] = u[i].value * (p[SHAFT_P_SHAPE + i] * x[1]);
    f->damping = p[SHAFT_P_MODE_DAMPING] * x[1] * x[1];
    f->force = REAL(real_larger)(contact1, contact3);
}
