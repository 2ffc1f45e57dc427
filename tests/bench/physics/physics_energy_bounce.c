/* physics_energy_bounce.c - energy change over 350 bounces of a mass against h omega of the contact.
 *
 * spring: x'' = -1 - k min(x, 0), k = 1e4, dropped from about 1. hertz: the rig without damping, dropped so
 * that it dives to about eta = 35; omega there is pi over the contact time. The change of energy is relative
 * to that at the start above rest: -1 is a mass that lies still, inf out of all bounds. Each point is the
 * median of runs whose height and step differ by a few per cent, beside it the lowest and the highest. */
#include <math.h>
#include <stdio.h>
#include "firmware/plant/plant_change.h"
#include "models/hertz_rig.h"
#include "tests/bench/physics/physics.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/gap_oscillator.h"
#include "tests/fixture/orbit.h"

enum { RUNS = 7, BOUNCES = 350 };
static const double stiffness = 1e4;
static const double wall =
    4.0; /* the wall of the gap oscillator that is hit: the other one is out of reach */
static const double out_of_bounds = 1e12;

/* A drop of height `height` (1 is nominal) onto either contact. */
struct drop {
    const struct model *model;
    double si[MODEL_PARAMETERS], push; /* constant force of input 0 */
    double start[2], omega, time;      /* contact's, and of all bounces */
    double rest;                       /* energy at rest */
    double (*energy)(double x, double v);
    struct classical free;
    double origin, sign; /* origin and sign of the classical coordinate in the model's */
};

static double spring_force(const void *context, double t, double x)
{
    (void)context, (void)t;
    return -1.0 - (x < 0.0 ? stiffness * x : 0.0);
}

static double spring_slope(const void *context, double t, double x)
{
    (void)context, (void)t;
    return x < 0.0 ? -stiffness : 0.0;
}

static double spring_energy(double x, double v)
{
    return 0.5 * v * v + x + (x < 0.0 ? 0.5 * stiffness * x * x : 0.0);
}

static double hertz_energy(double x, double v)
{
    return 0.5 * v * v + (2.0 / 3.0) * (hertz_contact_energy(x) - x);
}

static void drop_spring(struct drop *d, double height)
{
    *d = (struct drop){.model = &gap_oscillator, .push = 1.0, .energy = spring_energy};
    d->si[GAP_KAPPA] = stiffness;
    d->si[GAP_G] = wall;
    d->omega = sqrt(stiffness);
    d->origin = wall;
    d->sign = -1.0;
    d->start[0] = height;
    d->time = BOUNCES * (2.0 * sqrt(2.0 * height) + 3.14159 / d->omega);
    d->rest = -0.5 / stiffness;
    d->free = (struct classical){spring_force, spring_slope, 0.0, NULL};
}

static void drop_hertz(struct drop *d, double height)
{
    double speed, period = orbit_hertz_period(35.0 * height, &speed);
    *d = (struct drop){.model = &hertz_rig, .energy = hertz_energy, .sign = 1.0};
    hertz_rig_unit_scale(0.0, d->si);
    d->omega = 3.14159265 / (period - 3.0 * speed);
    d->start[0] = -0.75 * speed * speed;
    d->time = BOUNCES * period;
    d->rest = hertz_energy(1.0, 0.0);
    d->free = (struct classical){orbit_hertz_force, orbit_hertz_slope, 0.0, NULL};
}

/* Energy change over the energy at the start, above rest. */
static double change_of(const struct drop *d, double x, double v)
{
    double start = d->energy(d->start[0], d->start[1]),
           change = (d->energy(x, v) - start) / (start - d->rest);
    return change < out_of_bounds ? change : (double)INFINITY;
}

static double run_classical(const struct drop *d, classical_step *step, double h)
{
    struct classical_state s = {d->start[0], d->start[1], 0.0};
    long n = (long)(d->time / h);
    classical_begin(&d->free, 0.0, &s);
    for (long i = 0; i < n && fabs(s.v) < out_of_bounds; i++)
        step(&d->free, 0.0, h, &s);
    return change_of(d, s.x, s.v);
}

static double run_ours(const struct drop *d, const struct method *method, double h)
{
    static double scratch[METHOD_SCRATCH];
    static struct plant pl;
    struct plant_config c = {.model = d->model,
                             .si = d->si,
                             .method = method,
                             .tick_s = h,
                             .dilation = 1.0,
                             .tol = 1e-10,
                             .force = true,
                             .scratch = scratch};
    if (plant_init(&pl, &c) != NULL)
        return (double)NAN;
    if (d->push != 0.0)
        plant_sample(&pl, 0, d->push, 0);
    plant_set_state(&pl, (const double[2]){d->origin + d->sign * d->start[0], d->sign * d->start[1]});
    if (!plant_run(&pl, (uint64_t)(d->time / h)))
        return (double)NAN;
    return change_of(d, d->sign * (pl.x[0] - d->origin), d->sign * pl.x[1]);
}

static void print_point(const char *plant, void (*make)(struct drop *, double), const char *name,
                        classical_step *step, const struct method *method, double h_omega)
{
    double left[RUNS];
    uint64_t seed = 2;
    for (int i = 0; i < RUNS; i++) {
        struct drop d;
        make(&d, 0.98 + 0.04 * exact_uniform(&seed));
        double h = h_omega / d.omega * (0.98 + 0.04 * exact_uniform(&seed));
        left[i] = step ? run_classical(&d, step, h) : run_ours(&d, method, h);
    }
    double low = physics_quantile(left, RUNS, 0.0), high = physics_quantile(left, RUNS, 1.0);
    printf("%s,%s,%.4g,%.5g,%.5g,%.5g\n", plant, name, h_omega, physics_quantile(left, RUNS, 0.5), low, high);
}

static void print_plant(const char *plant, void (*make)(struct drop *, double), const struct method *other)
{
    const struct method *const ours[2] = {&rk4, other};
    for (int i = 0; i < CLASSICAL_METHODS + 2; i++) {
        bool classical = i < CLASSICAL_METHODS;
        for (double h_omega = 0.1; h_omega <= 3.2; h_omega *= pow(2.0, 1.0 / 3.0))
            print_point(plant, make, classical ? classical_table[i].name : ours[i - CLASSICAL_METHODS]->name,
                        classical ? classical_table[i].step : NULL,
                        classical ? NULL : ours[i - CLASSICAL_METHODS], h_omega);
    }
}

int main(void)
{
    printf("plant,method,h_omega,energy_change,lowest,highest\n");
    print_plant("spring", drop_spring, &exact);
    print_plant("hertz", drop_hertz, &taylor);
    return 0;
}
