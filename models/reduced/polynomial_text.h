/* polynomial_text.h - force and powers of the reduced models; a text for polynomial.h and models/flows.h, see
 * models/lanes.h. */

POLYNOMIAL_INLINE real REAL(polynomial_at)(const double *c, real x)
{
    return ((c[3] * x + c[2]) * x + c[1]) * x + c[0];
}

/* C(x) */
POLYNOMIAL_INLINE real REAL(polynomial_restore)(struct polynomial_shape s, const double *p, real x)
{
    const double *c = &p[POLYNOMIAL_C];
    return s.degree == 1 ? c[1] * x + c[0] : REAL(polynomial_at)(c, x);
}

/* LOAD - LEVER x - C(x), the contact's part of C. A relative change of its stiffness scales it: M = -this. */
POLYNOMIAL_INLINE real REAL(polynomial_contact)(struct polynomial_shape s, const double *p, real x)
{
    double load = p[POLYNOMIAL_LOAD];
    if (s.n_forces != 1)
        return load - REAL(polynomial_restore)(s, p, x);
    real left = load - (s.degree == 3 && s.n_inputs == 2 ? x : p[POLYNOMIAL_LEVER] * x);
    return left - REAL(polynomial_restore)(s, p, x);
}

/* M_i(x) u_i */
POLYNOMIAL_INLINE real REAL(polynomial_product)(struct polynomial_shape s, const double *p,
                                                const struct REAL(input) * u, int i, real x)
{
    const double *m = &p[POLYNOMIAL_M + 4 * i];
    if (POLYNOMIAL_STIFFNESS(s, i))
        return -(REAL(polynomial_contact)(s, p, x) * u[i].value);
    if (i < s.n_forces || s.degree == 1)
        return m[0] * u[i].value;
    return REAL(polynomial_at)(m, x) * u[i].value;
}

/* M_i(x) u_i + R_i u_i' */
POLYNOMIAL_INLINE real REAL(polynomial_push)(struct polynomial_shape s, const double *p,
                                             const struct REAL(input) * u, int i, real x)
{
    real product = REAL(polynomial_product)(s, p, u, i, x);
    return i < s.n_forces || POLYNOMIAL_STIFFNESS(s, i) ? product : product + p[POLYNOMIAL_R + i] * u[i].rate;
}

POLYNOMIAL_INLINE void REAL(polynomial_rhs)(struct polynomial_shape s, const double *p,
                                            const struct REAL(input) * u, const real *x, real *x_dot)
{
    real force = REAL(polynomial_restore)(s, p, x[0]) + REAL(polynomial_push)(s, p, u, 0, x[0]);
    if (s.n_inputs > 1)
        force += REAL(polynomial_push)(s, p, u, 1, x[0]);
    if (s.n_inputs > 2 && !s.silent)
        force += REAL(polynomial_push)(s, p, u, 2, x[0]);
    if (s.n_inputs > 2)
        force += REAL(polynomial_push)(s, p, u, 3, x[0]);
    x_dot[0] = x[1];
    x_dot[1] = force - p[POLYNOMIAL_DAMPING] * x[1];
}

/* The contact force, in units of force. */
POLYNOMIAL_INLINE real REAL(polynomial_contact_force)(struct polynomial_shape s, const double *p,
                                                      const struct REAL(input) * u, real x)
{
    real rest = REAL(polynomial_contact)(s, p, x);
    if (s.n_forces < s.n_inputs && !s.silent)
        rest -= REAL(polynomial_product)(s, p, u, s.n_forces, x);
    if (s.n_forces + 1 < s.n_inputs)
        rest -= REAL(polynomial_product)(s, p, u, s.n_forces + 1, x);
    return p[POLYNOMIAL_GAIN] * rest;
}

POLYNOMIAL_INLINE void REAL(polynomial_flow)(struct polynomial_shape s, const double *p,
                                             const struct REAL(input) * u, const real *x,
                                             struct REAL(flow) * f)
{
    REAL(polynomial_rhs)(s, p, u, x, f->x_dot);
    f->work[0] = x[1] * REAL(polynomial_push)(s, p, u, 0, x[0]);
    if (s.n_inputs > 1)
        f->work[1] = x[1] * REAL(polynomial_push)(s, p, u, 1, x[0]);
    if (s.n_inputs > 2) {
        f->work[2] = s.silent ? (real){0.0} : x[1] * REAL(polynomial_push)(s, p, u, 2, x[0]);
        f->work[3] = x[1] * REAL(polynomial_push)(s, p, u, 3, x[0]);
    }
    f->damping = p[POLYNOMIAL_DAMPING] * x[1] * x[1];
    f->force = REAL(polynomial_contact_force)(s, p, u, x[0]);
}
