/* ledger_middle.h - the ledger's rule over a piece; a text for ledger.c and host_sim/beside/ledger_beside.h,
 * see models/lanes.h. */

/* The state in the middle of a piece from positions q, velocities v and accelerations a at its ends: of the
 * quintic Hermite polynomial
 *
 *   q = (q0 + q1)/2 + 5 h (v0 - v1)/32 + h^2 (a0 + a1)/64
 *
 *   v = 15/8 (q1 - q0)/h - 7 (v0 + v1)/16 + h (a1 - a0)/32 */
ALWAYS_INLINE void REAL(middle_of)(int n, const struct NUMBER(ledger_rule) * r, const real *a0,
                                   const real *a1, const real *x0, const real *x1, real *x)
{
    EACH for (int i = 0, k = n / 2; k < n; i++, k++)
    {
        real mean = 0.5 * (x0[k] + x1[k]), secant = (x1[i] - x0[i]) * r->inverse;
        x[i] = (unfused(0.5 * (x0[i] + x1[i])) + unfused(r->a * (x0[k] - x1[k]))) +
               unfused(r->b * (a0[k] + a1[k]));
        x[k] = (unfused(1.875 * secant) + unfused(r->mean * mean)) + unfused(r->c * (a1[k] - a0[k]));
    }
}

/* Simpson's rule over a power at both ends and in the middle. */
ALWAYS_INLINE real REAL(simpson)(number sixth, real begin, real middle, real end)
{
    return sixth * ((begin + end) + 4.0 * middle);
}
