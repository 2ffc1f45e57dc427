/* physics_energy_drift.c - error of the energy of a free Hertz rig over 10,000 periods at 32 steps each.
 *
 * Steps of 2 pi/32, where rk4's guard still lets pass, from eta_max = 1.5 (contact kept) to 3.5 (lost for
 * half of the time). The error is the largest since the row before, relative to the energy above rest. */
#include <math.h>
#include <stdio.h>
#include "firmware/plant/plant_change.h"
#include "models/hertz_rig.h"
#include "tests/bench/physics/physics.h"
#include "tests/fixture/orbit.h"

enum { STEPS = 32, PERIODS = 10000 };
static const double h = 6.283185307179586477 / STEPS;

static double energy(double x, double v)
{
    return 0.5 * v * v + (2.0 / 3.0) * (hertz_contact_energy(x) - x + 0.6);
}

/* One run by either. */
struct run {
    const char *name;
    classical_step *step;
    struct classical_state s;
    struct plant pl;
    double start, worst;
};

static void advance(struct run *r)
{
    static const struct classical rig = {orbit_hertz_force, orbit_hertz_slope, 0.0, NULL};
    if (r->step) {
        r->step(&rig, 0.0, h, &r->s);
    } else {
        if (!plant_run(&r->pl, 1))
            r->worst = (double)NAN;
        r->s.x = r->pl.x[0];
        r->s.v = r->pl.x[1];
    }
    r->worst = fmax(r->worst, fabs(energy(r->s.x, r->s.v) / r->start - 1.0));
}

static void print_run(struct run *r, double eta_max)
{
    int next = 1;
    r->start = energy(eta_max, 0.0);
    r->worst = 0.0;
    for (int period = 1; period <= PERIODS; period++) {
        for (int i = 0; i < STEPS; i++)
            advance(r);
        if (period < next)
            continue;
        printf("%s,%g,%d,%.3g\n", r->name, eta_max, period, r->worst);
        r->worst = 0.0;
        next *= 2 * next <= PERIODS || next == PERIODS ? 2 : 1;
        next = period == next ? PERIODS : next;
    }
}

static void print_classical(const struct classical_method *m, double eta_max)
{
    static const struct classical rig = {orbit_hertz_force, orbit_hertz_slope, 0.0, NULL};
    static struct run r;
    r = (struct run){.name = m->name, .step = m->step, .s = {eta_max, 0.0, 0.0}};
    classical_begin(&rig, 0.0, &r.s);
    print_run(&r, eta_max);
}

static void print_ours(const char *name, const struct method *method, double tol, double eta_max)
{
    static double scratch[METHOD_SCRATCH];
    static struct run r;
    double si[MODEL_PARAMETERS];
    struct plant_config c = {.model = &hertz_rig,
                             .si = si,
                             .method = method,
                             .tick_s = h,
                             .dilation = 1.0,
                             .tol = tol,
                             .scratch = scratch};
    r = (struct run){.name = name};
    hertz_rig_unit_scale(0.0, si);
    if (plant_init(&r.pl, &c) != NULL)
        return;
    plant_set_state(&r.pl, (const double[2]){eta_max, 0.0});
    print_run(&r, eta_max);
}

int main(void)
{
    static const double eta_max[] = {1.5, 2.0, 2.5, 3.0, 3.5};
    printf("method,eta_max,periods,energy_error\n");
    for (int k = 0; k < 5; k++) {
        for (int i = 0; i < CLASSICAL_METHODS; i++)
            print_classical(&classical_table[i], eta_max[k]);
        print_ours("rk4", &rk4, 0.0, eta_max[k]);
        print_ours("taylor 1e-9", &taylor, 1e-9, eta_max[k]);
        print_ours("taylor 1e-12", &taylor, 1e-12, eta_max[k]);
    }
    return 0;
}
