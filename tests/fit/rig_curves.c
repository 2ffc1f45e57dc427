/* rig_curves.c - response curves and records of a preloaded Hertzian rig by an integrator of its own, for
 * tests of fits.
 *
 *   rig_curves MASS STIFFNESS PRELOAD DAMPING AMPLITUDE FROM TO N up|down NOISE SEED
 *   rig_curves MASS STIFFNESS PRELOAD DAMPING AMPLITUDE FREQUENCY BEGIN N STEP NOISE SEED record
 *
 * A record begins at rest, BEGIN away from the static position; without a drive (AMPLITUDE 0) it is free. Its
 * NOISE is in metres. It shares nothing with the plant: m z'' + c z' + k z_+^1.5 = N + F cos wt by the
 * classical Runge-Kutta method in fixed steps, from point to point as a rig is swept, until the motion has
 * settled. NOISE is the standard deviation of real and imaginary part over the amplitude. SI; a CSV on
 * standard output. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 256, SETTLED_FALLS = 14, ARGUMENTS = 12, RECORD_STEPS = 64 };

struct rig {
    double mass, stiffness, preload, damping, amplitude, omega;
};

static double acceleration(const struct rig *r, double z, double v, double phase)
{
    double spring = z > 0.0 ? r->stiffness * z * sqrt(z) : 0.0;
    return (r->preload + r->amplitude * cos(phase) - r->damping * v - spring) / r->mass;
}

static void step(const struct rig *r, double h, double *z, double *v, int i)
{
    double turn = r->omega * h, p = turn * i;
    double v1 = *v, a1 = acceleration(r, *z, v1, p);
    double v2 = *v + 0.5 * h * a1, a2 = acceleration(r, *z + 0.5 * h * v1, v2, p + 0.5 * turn);
    double v3 = *v + 0.5 * h * a2, a3 = acceleration(r, *z + 0.5 * h * v2, v3, p + 0.5 * turn);
    double v4 = *v + h * a3, a4 = acceleration(r, *z + h * v3, v4, p + turn);
    *z += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    *v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
}

/* A period; real and imaginary part of the first harmonic of the position. */
static void period(const struct rig *r, double *z, double *v, double y[2])
{
    y[0] = y[1] = 0.0;
    for (int i = 0; i < STEPS; i++) {
        y[0] += 2.0 / STEPS * *z * cos(2.0 * M_PI * i / STEPS);
        y[1] -= 2.0 / STEPS * *z * sin(2.0 * M_PI * i / STEPS);
        step(r, 2.0 * M_PI / r->omega / STEPS, z, v, i);
    }
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

static void record(struct rig *r, char **argv, uint64_t seed)
{
    double h = atof(argv[9]), noise = atof(argv[10]);
    double z = pow(r->preload / r->stiffness, 2.0 / 3.0) + atof(argv[7]), v = 0.0;
    bool driven = r->amplitude > 0.0;
    r->omega = 2.0 * M_PI * atof(argv[6]);
    printf("# noise = %.17g m\ntime_s,displacement_m%s\n", noise, driven ? ",force_N" : "");
    for (int i = 0; i < atoi(argv[8]); i++) {
        printf("%.10g,%.10g", i * h, z + noise * normal(&seed));
        printf(driven ? ",%.10g\n" : "\n", r->amplitude * cos(r->omega * i * h));
        for (int k = 0; k < RECORD_STEPS; k++)
            step(r, h / RECORD_STEPS, &z, &v, i * RECORD_STEPS + k);
    }
}

int main(int argc, char **argv)
{
    if (argc != ARGUMENTS && argc != ARGUMENTS + 1)
        return 2;
    struct rig r = {atof(argv[1]), atof(argv[2]), atof(argv[3]), atof(argv[4]), atof(argv[5]), 0.0};
    double from = atof(argv[6]), to = atof(argv[7]), noise = atof(argv[10]);
    double z = pow(r.preload / r.stiffness, 2.0 / 3.0), v = 0.0;
    int n = atoi(argv[8]), down = !strcmp(argv[9], "down");
    uint64_t seed = strtoull(argv[11], NULL, 10) * 2654435761u + 1;
    if (argc > ARGUMENTS) {
        record(&r, argv, seed);
        return 0;
    }
    printf("# amplitude = %.17g N\n# output = displacement\n# direction = %s\n", r.amplitude, argv[9]);
    if (noise > 0.0)
        printf("# noise = %.17g\n", noise);
    printf("frequency_Hz,amplitude_m,phase_rad\n");
    for (int i = 0; i < n; i++) {
        double f = from + (to - from) * (down ? n - 1 - i : i) / (n - 1);
        r.omega = 2.0 * M_PI * f;
        double falls = r.damping / (2.0 * r.mass) / f; /* e-folds a period */
        double y[2] = {0.0, 0.0};
        for (int k = 0; k < SETTLED_FALLS / falls; k++)
            period(&r, &z, &v, y);
        double size = noise * hypot(y[0], y[1]);
        y[0] += size * normal(&seed);
        y[1] += size * normal(&seed);
        printf("%.10g,%.10g,%.10g\n", f, hypot(y[0], y[1]), atan2(y[1], y[0]));
    }
    return 0;
}
