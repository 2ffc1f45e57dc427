/* rig_curves.c - response curves and records of a preloaded Hertzian rig, and curves of a shaft between gaps,
 * by an integrator of its own, for tests of fits.
 *
 *   rig_curves MASS STIFFNESS PRELOAD DAMPING AMPLITUDE FROM TO N up|down NOISE SEED
 *   rig_curves MASS STIFFNESS PRELOAD DAMPING AMPLITUDE FREQUENCY BEGIN N STEP NOISE SEED record
 *
 *   rig_curves shaft M1 M2 M3 C1 C2 C3 S1 S3 BEND G1 G3 K1 K3 SEEN AMPLITUDE FROM TO N up|down NOISE SEED
 *
 * A record begins at rest, BEGIN away from the static position; without a drive (AMPLITUDE 0) it is free. Its
 * NOISE is in metres. It shares nothing with the plant: m z'' + c z' + k z_+^1.5 = N + F cos wt by the
 * classical Runge-Kutta method in fixed steps, from point to point as a rig is swept, until the motion has
 * settled. The shaft has three masses, 2 S to the ground and a spring K behind a gap G at both ends, and BEND
 * (z1 - 2 z2 + z3) between; it is driven at mass 1 and SEEN is 1 or 3. NOISE is the standard deviation of
 * real and imaginary part over the amplitude. SI; a CSV on standard output, without the motions that do
 * not repeat with their drive. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MASSES = 3, STEPS = 256, SHAFT_STEPS = 1024, SETTLED_FALLS = 14, ARGUMENTS = 12, RECORD_STEPS = 64 };
enum { SHAFT_ARGUMENTS = 23 };
static const double repeats = 1e-3; /* difference of two periods, of the amplitude */

struct rig {
    int n, seen, steps; /* masses, the one that is seen, steps a period */
    double mass[MASSES], damping[MASSES], stiffness, preload;
    double support[MASSES], bend, gap[MASSES], gap_stiffness[MASSES];
    double amplitude, omega;
};

/* Force of the springs on the masses. */
static void pull(const struct rig *r, const double *z, double *force)
{
    static const double shape[MASSES] = {1.0, -2.0, 1.0};
    force[0] = r->preload - (z[0] > 0.0 ? r->stiffness * z[0] * sqrt(z[0]) : 0.0);
    if (r->n < MASSES)
        return;
    double bend = r->bend * (z[0] - 2.0 * z[1] + z[2]);
    for (int i = 0; i < MASSES; i++) {
        double over = fmax(fabs(z[i]) - r->gap[i], 0.0);
        force[i] = -2.0 * r->support[i] * z[i] - shape[i] * bend - r->gap_stiffness[i] * copysign(over, z[i]);
    }
}

static void accelerate(const struct rig *r, const double *z, const double *v, double phase, double *a)
{
    pull(r, z, a);
    a[0] += r->amplitude * cos(phase);
    for (int i = 0; i < r->n; i++)
        a[i] = (a[i] - r->damping[i] * v[i]) / r->mass[i];
}

static void step(const struct rig *r, double h, double *z, double *v, int i)
{
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double turn = r->omega * h, z0[MASSES], v0[MASSES], zs[MASSES], vs[MASSES], a[MASSES] = {0.0};
    memcpy(z0, z, sizeof z0);
    memcpy(v0, v, sizeof v0);
    memcpy(vs, v, sizeof vs);
    for (int k = 0; k < 4; k++) {
        for (int j = 0; j < r->n; j++) {
            zs[j] = z0[j] + at[k] * h * vs[j];
            vs[j] = v0[j] + at[k] * h * a[j];
        }
        accelerate(r, zs, vs, turn * (i + at[k]), a);
        for (int j = 0; j < r->n; j++) {
            z[j] += h / 6.0 * weight[k] * vs[j];
            v[j] += h / 6.0 * weight[k] * a[j];
        }
    }
}

/* A period; real and imaginary part of the first harmonic of the position that is seen. */
static void period(const struct rig *r, double *z, double *v, double y[2])
{
    y[0] = y[1] = 0.0;
    for (int i = 0; i < r->steps; i++) {
        y[0] += 2.0 / r->steps * z[r->seen] * cos(2.0 * M_PI * i / r->steps);
        y[1] -= 2.0 / r->steps * z[r->seen] * sin(2.0 * M_PI * i / r->steps);
        step(r, 2.0 * M_PI / r->omega / r->steps, z, v, i);
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

static double rest_of(const struct rig *r)
{
    return r->n == 1 ? pow(r->preload / r->stiffness, 2.0 / 3.0) : 0.0;
}

static void record(struct rig *r, char **argv, uint64_t seed)
{
    double h = atof(argv[9]), noise = atof(argv[10]);
    double z = rest_of(r) + atof(argv[7]), v = 0.0;
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

/* Periods until the slowest motion has settled. */
static double settling(const struct rig *r, double frequency)
{
    double falls = HUGE_VAL; /* e-folds a period */
    for (int i = 0; i < r->n; i++)
        falls = fmin(falls, r->damping[i] / (2.0 * r->mass[i]) / frequency);
    return SETTLED_FALLS / falls;
}

/* From AMPLITUDE on: the curve. */
static int curve(struct rig *r, char **argv)
{
    double from = atof(argv[1]), to = atof(argv[2]), noise = atof(argv[5]);
    double z[MASSES] = {rest_of(r)}, v[MASSES] = {0.0};
    int n = atoi(argv[3]), down = !strcmp(argv[4], "down");
    uint64_t seed = strtoull(argv[6], NULL, 10) * 2654435761u + 1;
    r->amplitude = atof(argv[0]);
    printf("# amplitude = %.17g N\n# output = %s\n# direction = %s\n", r->amplitude,
           r->n == 1 ? "displacement"
           : r->seen ? "position3"
                     : "position1",
           argv[4]);
    if (noise > 0.0)
        printf("# noise = %.17g\n", noise);
    printf("frequency_Hz,amplitude_m,phase_rad\n");
    for (int i = 0; i < n; i++) {
        double f = from + (to - from) * (down ? n - 1 - i : i) / (n - 1);
        r->omega = 2.0 * M_PI * f;
        double y[2] = {0.0, 0.0}, before[2] = {0.0, 0.0};
        for (int k = 0; k < settling(r, f); k++) {
            memcpy(before, y, sizeof y);
            period(r, z, v, y);
        }
        if (hypot(y[0] - before[0], y[1] - before[1]) > repeats * hypot(y[0], y[1]))
            continue;
        double size = noise * hypot(y[0], y[1]);
        y[0] += size * normal(&seed);
        y[1] += size * normal(&seed);
        printf("%.10g,%.10g,%.10g\n", f, hypot(y[0], y[1]), atan2(y[1], y[0]));
    }
    return 0;
}

static int shaft(char **argv)
{
    struct rig r = {.n = MASSES, .steps = SHAFT_STEPS, .seen = atoi(argv[15]) - 1};
    for (int i = 0; i < MASSES; i++) {
        r.mass[i] = atof(argv[2 + i]);
        r.damping[i] = atof(argv[5 + i]);
    }
    for (int i = 0; i < 2; i++) {
        r.support[2 * i] = atof(argv[8 + i]);
        r.gap[2 * i] = atof(argv[11 + i]);
        r.gap_stiffness[2 * i] = atof(argv[13 + i]);
    }
    r.bend = atof(argv[10]);
    return curve(&r, argv + 16);
}

int main(int argc, char **argv)
{
    if (argc == SHAFT_ARGUMENTS && !strcmp(argv[1], "shaft"))
        return shaft(argv);
    if (argc != ARGUMENTS && argc != ARGUMENTS + 1)
        return 2;
    struct rig r = {.n = 1,
                    .steps = STEPS,
                    .mass = {atof(argv[1])},
                    .stiffness = atof(argv[2]),
                    .preload = atof(argv[3]),
                    .damping = {atof(argv[4])},
                    .amplitude = atof(argv[5])};
    if (argc == ARGUMENTS)
        return curve(&r, argv + 5);
    record(&r, argv, strtoull(argv[11], NULL, 10) * 2654435761u + 1);
    return 0;
}
