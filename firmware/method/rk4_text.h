/* rk4_text.h - a step of rk4; a text for rk4.c and host_sim/beside/rk4_beside.c, see models/lanes.h. */

typedef void REAL(rhs_function)(const real *p, const struct REAL(input) * u, const real *x, real *x_dot);
typedef void REAL(gap_function)(const real *p, const struct REAL(input) * u, const real *x,
                                struct REAL(input) * gap);

/* The model as compile-time constants of one instantiation. */
struct REAL(inlined) {
    REAL(rhs_function) * rhs;
    REAL(gap_function) * gap;
    int n, n_contacts;
};

/* Classical RK4 of x'' = f(t, x, x'), positions first in the state, then velocities, from the slope k1 at its
 * begin. The stage velocities are put into the stage positions. So the chain from one force to the next is
 * two operations shorter, and the positions need the sum of three accelerations only. */
ALWAYS_INLINE void REAL(advance_from)(struct REAL(inlined) m, const real *p, real h, const real *k1,
                                      const struct REAL(input) * middle, const struct REAL(input) * end,
                                      const real *x, real *x1)
{
    real k2[MODEL_STATES], k3[MODEL_STATES], k4[MODEL_STATES], y[MODEL_STATES];
    real half = 0.5 * h, quarter = half * half, square = half * h;
    int n = m.n / 2;
    for (int i = 0; i < n; i++) {
        y[i] = x[i] + half * x[n + i];
        y[n + i] = x[n + i] + half * k1[n + i];
    }
    m.rhs(p, middle, y, k2);
    for (int i = 0; i < n; i++) {
        y[i] = (x[i] + half * x[n + i]) + quarter * k1[n + i];
        y[n + i] = x[n + i] + half * k2[n + i];
    }
    m.rhs(p, middle, y, k3);
    for (int i = 0; i < n; i++) {
        y[i] = (x[i] + h * x[n + i]) + square * k2[n + i];
        y[n + i] = x[n + i] + h * k3[n + i];
    }
    m.rhs(p, end, y, k4);
    real sixth = h * (1.0 / 6.0), sixth_square = h * sixth;
    for (int i = 0; i < n; i++) {
        real twice = k2[n + i] + k3[n + i];
        x1[i] = (x[i] + h * x[n + i]) + sixth_square * (k1[n + i] + twice);
        x1[n + i] = x[n + i] + sixth * ((k1[n + i] + k4[n + i]) + 2.0 * twice);
    }
}

ALWAYS_INLINE void REAL(advance)(struct REAL(inlined) m, const real *p, real h,
                                 const struct REAL(input) * begin, const struct REAL(input) * middle,
                                 const struct REAL(input) * end, const real *x, real *x1)
{
    real k1[MODEL_STATES];
    m.rhs(p, begin, x, k1);
    REAL(advance_from)(m, p, h, k1, middle, end, x, x1);
}
