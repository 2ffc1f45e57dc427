/* afm_cost.c - error against cost of a tapping lever: docs/img/afm_cost.csv.
 *
 * Cases A, B, C of tests/fixture/afm/tapping.h on a repulsive orbit at 0.7 or 0.75 free amplitudes, which an
 * independent program knows to 1e-5 nm and 0.005 degrees (tests/data/tapping_orbits.txt). `modal` and `rk4`
 * as whole plants without the ledger; velocity Verlet and a loop whose force is one tick late (semi-implicit
 * Euler) as bare loops with the force inlined. A run begins on the orbit and settles for 2000 periods. The
 * worst of five runs, whose tones begin at other places of a tick: else whole ticks a period would hide where
 * the contact falls.
 *
 *   motion   complex amplitude at f0: its distance from the orbit's over the free amplitude
 *   peak     largest force over the orbit's, less 1
 *   ns       processor time of a period */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "tests/bench/classical.h"
#include "tests/bench/physics/physics.h"
#include "tests/fixture/afm/tapping.h"

#define TWO_PI 6.283185307179586

enum { SETTLE = 2000, MEASURE = 40, RUNS = 5, CASES = 3, GRIDS = 13 };
static const struct {
    const char *name;
    double ratio; /* height over the free amplitude */
} orbit_of[CASES] = {{"A", 0.7}, {"B", 0.75}, {"C", 0.75}};
static const int grid[GRIDS] = {16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024};

struct run {
    const struct tapping_case *c;
    const struct tapping_orbit *orbit;
    int ticks;
    double phase; /* the tone's, degrees */
};

struct result {
    double complex motion; /* m, of cos(wt + phase) */
    double peak, ns;
};

static struct lever lever;

/* ---- whole plants ---- */

static bool run_plant(const struct run *r, const struct method *method, struct result *out)
{
    struct plant_config config = {.model = &afm_lever,
                                  .si = lever.si,
                                  .method = method,
                                  .tick_s = 1.0 / (TAPPING_F0 * r->ticks),
                                  .dilation = 1.0,
                                  .no_ledger = true,
                                  .scratch = lever.scratch};
    tapping_set(&lever, r->c, r->orbit->ratio);
    if (plant_init(&lever.plant, &config))
        return false;
    tapping_begin(&lever, r->c, r->orbit->amplitude, r->orbit->lag, r->phase);
    double before = physics_now_ns();
    if (!plant_run(&lever.plant, (uint64_t)r->ticks * SETTLE))
        return false;
    out->ns = (physics_now_ns() - before) / SETTLE;
    out->motion = lever_lock_in(&lever, 0, r->ticks, MEASURE, &out->peak);
    return true;
}

/* ---- bare loops ---- */

/* Lengths in free amplitudes, time in 1/w0, the force in k free amplitudes. */
struct sample {
    double a0, attraction, hertz, height, tone, phase;
};

static inline double sample_force(const struct sample *s, double x)
{
    double d = s->height + x;
    if (d > s->a0)
        return -s->attraction / (d * d);
    return s->hertz * (s->a0 - d) * sqrt(s->a0 - d) - s->attraction / (s->a0 * s->a0);
}

static double force(const void *context, double t, double x)
{
    const struct sample *s = context;
    return s->tone * cos(t + s->phase) - x + sample_force(s, x);
}

static void prepare(const struct run *r, struct sample *s)
{
    const struct tapping_case *c = r->c;
    s->a0 = 0.165e-9 / c->free;
    s->attraction = c->hamaker * c->radius / 6.0 / (c->k * pow(c->free, 3.0));
    s->hertz = 4.0 / 3.0 * c->modulus * sqrt(c->radius) * pow(c->free, 1.5) / (c->k * c->free);
    s->height = r->orbit->ratio;
    s->tone = 1.0 / TAPPING_QUALITY;
    s->phase = r->phase * TWO_PI / 360.0;
}

/* The loop of a textbook: the force of this tick's place moves the tip in the next. */
static void late_step(const struct classical *c, double t, double h, struct classical_state *s)
{
    s->v += h * (force(c->context, t, s->x) - c->damping * s->v);
    s->x += h * s->v;
}

static void verlet_step(const struct classical *c, double t, double h, struct classical_state *s)
{
    classical_verlet(c, t, h, s);
}

static bool run_loop(const struct run *r, classical_step *step, struct result *out)
{
    struct sample s;
    prepare(r, &s);
    const struct classical c = {force, NULL, 1.0 / TAPPING_QUALITY, &s};
    double h = TWO_PI / r->ticks, angle = (r->orbit->lag - r->phase) * TWO_PI / 360.0, peak = 0.0;
    double size = r->orbit->amplitude * 1e-9 / r->c->free;
    struct classical_state x = {size * cos(angle), size * sin(angle), 0.0};
    double complex sum = 0.0;
    classical_begin(&c, 0.0, &x);
    double before = physics_now_ns();
    for (long i = 0; i < (long)r->ticks * SETTLE; i++)
        step(&c, h * (double)(i % r->ticks), h, &x);
    out->ns = (physics_now_ns() - before) / SETTLE;
    for (long i = 0; i < (long)r->ticks * MEASURE; i++) {
        double t = h * (double)(i % r->ticks);
        sum += 2.0 / (r->ticks * (double)MEASURE) * x.x * cexp((double complex)I * t);
        step(&c, t, h, &x);
        peak = fmax(peak, sample_force(&s, x.x));
    }
    out->motion = sum * r->c->free;
    out->peak = peak * r->c->k * r->c->free;
    return isfinite(cabs(sum));
}

/* ---- all of them ---- */

enum { MODAL, RK4, VERLET, LATE, WAYS };
static const char *const way_name[WAYS] = {"modal", "rk4", "velocity Verlet", "one tick late"};

static bool run_way(int way, const struct run *r, struct result *out)
{
    switch (way) {
    case MODAL:
        return run_plant(r, &modal, out);
    case RK4:
        return run_plant(r, &rk4, out);
    case VERLET:
        return run_loop(r, verlet_step, out);
    default:
        return run_loop(r, late_step, out);
    }
}

static void print(const struct tapping_case *c, const struct tapping_orbit *o, int way, int ticks)
{
    double motion = 0.0, peak = 0.0, ns[RUNS];
    double complex truth = o->amplitude * 1e-9 * cexp((double complex)I * o->lag * TWO_PI / 360.0);
    for (int k = 0; k < RUNS; k++) {
        struct run r = {c, o, ticks, 360.0 / ticks * k / RUNS};
        struct result out;
        if (!run_way(way, &r, &out))
            return; /* refused, or it left the finite numbers */
        out.motion *= cexp((double complex)I * r.phase * TWO_PI / 360.0);
        motion = fmax(motion, cabs(out.motion - truth) / c->free);
        peak = fmax(peak, fabs(out.peak * 1e9 / o->peak - 1.0));
        ns[k] = out.ns;
    }
    printf("%s,%s,%d,%.3g,%.3g,%.4g\n", c->name, way_name[way], ticks, motion, peak,
           physics_quantile(ns, RUNS, 0.5));
}

static bool find_orbit(int k, struct tapping_orbit *o)
{
    FILE *file = fopen("tests/data/tapping_orbits.txt", "r");
    bool found = false;
    while (file && !found && tapping_read(file, o))
        found = !strcmp(o->name, orbit_of[k].name) && o->branch == 1 && o->ratio == orbit_of[k].ratio;
    if (file)
        fclose(file);
    return found;
}

int main(void)
{
    printf("case,method,ticks,motion,peak,ns\n");
    for (int k = 0; k < CASES; k++) {
        struct tapping_orbit o;
        if (!find_orbit(k, &o))
            return 1;
        for (int way = 0; way < WAYS; way++)
            for (int i = 0; i < GRIDS; i++)
                print(tapping_find(orbit_of[k].name), &o, way, grid[i]);
    }
    return 0;
}
