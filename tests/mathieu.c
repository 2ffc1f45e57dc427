/* mathieu.c - see mathieu.h. */
#include "tests/mathieu.h"

#include <math.h>
#include "host_sim/stability_floquet.h"
#include "tests/test.h"

#define TWO_PI 6.283185307179586477

void mathieu_map(const struct mathieu *m, const struct method *method, double tol, int n, double map[2][2])
{
    const struct stability_tangent t = {
        .damping = m->damping, .stiffness = m->k0, .modulation = m->k1, .omega = m->omega};
    if (!stability_map(&t, method, tol, 1, n, map))
        check_true("the plant stays finite", 0);
}

static double slope(const void *context, double t, double x)
{
    const struct mathieu *m = context;
    (void)x;
    return -m->k0 - m->k1 * cos(m->omega * t);
}

static double force(const void *context, double t, double x)
{
    return slope(context, t, x) * x;
}

void mathieu_classical(const struct mathieu *m, classical_step *step, int n, double map[2][2])
{
    struct classical c = {force, slope, m->damping, m};
    double h = TWO_PI / m->omega / n;
    for (int j = 0; j < 2; j++) {
        struct classical_state s = {1.0 - j, j, 0.0};
        classical_begin(&c, 0.0, &s);
        for (int i = 0; i < n; i++)
            step(&c, i * h, h, &s);
        map[0][j] = s.x;
        map[1][j] = s.v;
    }
}

void mathieu_multipliers(double map[2][2], double complex mu[2])
{
    double half = 0.5 * (map[0][0] + map[1][1]), det = map[0][0] * map[1][1] - map[0][1] * map[1][0];
    double complex root = csqrt(half * half - det);
    mu[0] = half < 0.0 ? half - root : half + root;
    mu[1] = half < 0.0 ? half + root : half - root;
    if (cimag(mu[0]) < 0.0)
        mu[0] = conj(mu[0]), mu[1] = conj(mu[1]);
}
