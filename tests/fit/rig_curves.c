/* rig_curves.c - response curves of a preloaded Hertzian rig by an integrator of its own, for tests of fits.
 *
 *   rig_curves MASS STIFFNESS PRELOAD DAMPING AMPLITUDE FROM TO N up|down NOISE SEED
 *
 * It shares nothing with the plant: m z'' + c z' + k z_+^1.5 = N + F cos wt by the classical Runge-Kutta
 * method in fixed steps, from point to point as a rig is swept, until the motion has settled. NOISE is the
 * standard deviation of real and imaginary part over the amplitude. SI; a CSV on standard output. */
#include <complex.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 256, SETTLED_FALLS = 14, ARGUMENTS = 12 };

struct rig {
    double mass, stiffness, preload, damping, amplitude, omega;
};

static double acceleration(const struct rig *r, double z, double v, double phase)
{
    double spring = z > 0.0 ? r->stiffness * z * sqrt(z) : 0.0;
    return (r->preload + r->amplitude * cos(phase) - r->damping * v - spring) / r->mass;
}

static void step(const struct rig *r, double *z, double *v, int i)
{
    double h = 2.0 * M_PI / r->omega / STEPS, turn = 2.0 * M_PI / STEPS, p = turn * i;
    double v1 = *v, a1 = acceleration(r, *z, v1, p);
    double v2 = *v + 0.5 * h * a1, a2 = acceleration(r, *z + 0.5 * h * v1, v2, p + 0.5 * turn);
    double v3 = *v + 0.5 * h * a2, a3 = acceleration(r, *z + 0.5 * h * v2, v3, p + 0.5 * turn);
    double v4 = *v + h * a3, a4 = acceleration(r, *z + h * v3, v4, p + turn);
    *z += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    *v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
}

/* A period; the first harmonic of the position. */
static double complex period(const struct rig *r, double *z, double *v)
{
    double complex sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        sum += 2.0 / STEPS * *z * cexp(-I * 2.0 * M_PI * i / STEPS);
        step(r, z, v, i);
    }
    return sum;
}

/* Standard normal, by Box and Muller from a linear congruence. */
static double normal(uint64_t *seed)
{
    double u[2];
    for (int i = 0; i < 2; i++) {
        *seed = *seed * 6364136223846793005u + 1442695040888963407u;
        u[i] = ((double)(*seed >> 11) + 0.5) / 9007199254740992.0;
    }
    return sqrt(-2.0 * log(u[0])) * cos(2.0 * M_PI * u[1]);
}

int main(int argc, char **argv)
{
    if (argc != ARGUMENTS)
        return 2;
    struct rig r = {atof(argv[1]), atof(argv[2]), atof(argv[3]), atof(argv[4]), atof(argv[5]), 0.0};
    double from = atof(argv[6]), to = atof(argv[7]), noise = atof(argv[10]);
    double z = pow(r.preload / r.stiffness, 2.0 / 3.0), v = 0.0;
    int n = atoi(argv[8]), down = !strcmp(argv[9], "down");
    uint64_t seed = strtoull(argv[11], NULL, 10) * 2654435761u + 1;
    printf("# amplitude = %.17g N\n# output = displacement\n# direction = %s\n", r.amplitude, argv[9]);
    if (noise > 0.0)
        printf("# noise = %.17g\n", noise);
    printf("frequency_Hz,amplitude_m,phase_rad\n");
    for (int i = 0; i < n; i++) {
        double f = from + (to - from) * (down ? n - 1 - i : i) / (n - 1);
        r.omega = 2.0 * M_PI * f;
        double falls = r.damping / (2.0 * r.mass) / f; /* e-folds a period */
        double complex y = 0.0;
        for (int k = 0; k < SETTLED_FALLS / falls; k++)
            y = period(&r, &z, &v);
        double a = normal(&seed), b = normal(&seed);
        y += noise * cabs(y) * (a + I * b);
        printf("%.10g,%.10g,%.10g\n", f, cabs(y), carg(y));
    }
    return 0;
}
