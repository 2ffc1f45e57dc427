/* physics_observables.c - cost against the error of each observable: is Verlet the cheapest for any?
 *
 * The free Hertz rig over 100 periods with contact loss (tests/fixture/orbit.h). energy: largest error at any
 * step; contact_time and peak_force: worst of the 100 contacts; state: at the end. All relative, median of a
 * few runs with random phase and step. Contacts and peaks of classical methods come from the Hermite cubic
 * through each step's ends; rk4 and taylor locate their contacts. ns: a period of the method alone, shortest
 * of a few repeats, everything inlined. */
#include <math.h>
#include <stdio.h>
#include "models/hertz_rig.h"
#include "tests/bench/physics/physics.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/orbit.h"

enum { PERIODS = 100, RUNS = 7, REPEATS = 5, BISECTIONS = 50, PIECES = 10 };
enum observable { ENERGY, CONTACT_TIME, PEAK_FORCE, STATE, OBSERVABLES };
static const char *const observable_name[OBSERVABLES] = {"energy", "contact_time", "peak_force", "state"};

static double force(const void *context, double t, double x)
{
    (void)context, (void)t;
    return (2.0 / 3.0) * (1.0 - hertz_contact_force(x));
}

static const struct classical rig = {force, orbit_hertz_slope, 0.0, NULL};

/* ---- what is observed ---- */

struct observer {
    double contact_time, peak, start_energy; /* true values */
    double touch;                            /* time of the last touchdown */
    double worst[OBSERVABLES];
};

static double energy(double x, double v)
{
    return 0.5 * v * v + (2.0 / 3.0) * (hertz_contact_energy(x) - x + 0.6);
}

static void note(struct observer *o, enum observable which, double error)
{
    o->worst[which] = fmax(o->worst[which], fabs(error));
}

/* One step's ends and the cubic through them, u in [0, 1]. */
struct piece {
    double h, x0, v0, x1, v1;
};

static double cubic(const struct piece *p, double u)
{
    double w = 1.0 - u;
    return w * w * ((1.0 + 2.0 * u) * p->x0 + u * p->h * p->v0) +
           u * u * ((3.0 - 2.0 * u) * p->x1 - w * p->h * p->v1);
}

static double cubic_rate(const struct piece *p, double u)
{
    return 6.0 * u * (1.0 - u) * (p->x1 - p->x0) / p->h + (1.0 - u) * (1.0 - 3.0 * u) * p->v0 +
           u * (3.0 * u - 2.0) * p->v1;
}

static double root(double (*f)(const struct piece *, double), const struct piece *p)
{
    double lo = 0.0, hi = 1.0;
    bool rises = f(p, 1.0) > 0.0;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (lo + hi);
        *((f(p, middle) > 0.0) == rises ? &hi : &lo) = middle;
    }
    return 0.5 * (lo + hi);
}

static void observe_switch(struct observer *o, double t, bool touch)
{
    if (touch)
        o->touch = t;
    else if (o->touch > 0.0)
        note(o, CONTACT_TIME, (t - o->touch) / o->contact_time - 1.0);
}

static void observe_step(struct observer *o, const struct piece *p)
{
    note(o, ENERGY, energy(p->x1, p->v1) / o->start_energy - 1.0);
    if (p->v0 > 0.0 && p->v1 <= 0.0)
        note(o, PEAK_FORCE, hertz_contact_force(cubic(p, root(cubic_rate, p))) / o->peak - 1.0);
}

/* ---- one way to run ---- */

struct way {
    const char *name;
    classical_step *step;
    const struct method *method;
    double tol;
};

static void run_classical(const struct way *w, const struct orbit *orbit, int n, struct observer *o)
{
    double h = orbit->period / n;
    struct classical_state s = {orbit->start[0], orbit->start[1], 0.0};
    classical_begin(&rig, 0.0, &s);
    for (int i = 0; i < n * PERIODS; i++) {
        struct piece p = {h, s.x, s.v, 0.0, 0.0};
        w->step(&rig, 0.0, h, &s);
        p.x1 = s.x;
        p.v1 = s.v;
        observe_step(o, &p);
        if ((p.x0 > 0.0) != (p.x1 > 0.0))
            observe_switch(o, (i + root(cubic, &p)) * h, p.x1 > 0.0);
    }
    note(o, STATE,
         fmax(fabs(s.x - orbit->start[0]) / orbit->size[0], fabs(s.v - orbit->start[1]) / orbit->size[1]));
}

/* A method of ours alone, one tick with its switches; *at: where the last switch was. */
struct ours {
    step_function *step;
    double scratch[METHOD_SCRATCH], p[MODEL_DERIVED], x[2], h;
    struct segment e;
    unsigned regime;
};

static void ours_start(struct ours *c, const struct way *w, const struct orbit *orbit, int n)
{
    struct scale scale;
    hertz_rig.prepare(orbit->si, c->p, &scale);
    c->step = w->method->bind(&hertz_rig);
    c->h = orbit->period / n;
    c->e = (struct segment){.length = c->h};
    for (int i = 0; i < RIG_INPUTS; i++)
        c->e.wave[i].cosine = 1.0;
    c->regime = orbit->start[0] > 0.0;
    c->x[0] = orbit->start[0];
    c->x[1] = orbit->start[1];
    w->method->prepare(&hertz_rig, c->p, c->h, w->tol, c->scratch);
}

static inline void ours_tick(struct ours *c, double t, struct observer *o)
{
    struct crossing cross = {0.0, 0, 0, 0.0};
    c->e.length = c->h;
    for (int i = 0; i < PIECES; i++) {
        enum step_status status = c->step(&hertz_rig, c->p, c->scratch, &c->e, c->regime, c->x, &cross);
        if (status != STEP_SWITCH && status != STEP_BUDGET)
            return;
        c->e.length -= cross.done;
        if (status == STEP_BUDGET)
            continue;
        c->regime ^= 1u;
        if (o)
            observe_switch(o, t + c->h - c->e.length, c->regime);
    }
}

static void run_ours(const struct way *w, const struct orbit *orbit, int n, struct observer *o)
{
    static struct ours c;
    ours_start(&c, w, orbit, n);
    for (int i = 0; i < n * PERIODS; i++) {
        struct piece p = {c.h, c.x[0], c.x[1], 0.0, 0.0};
        ours_tick(&c, i * c.h, o);
        p.x1 = c.x[0];
        p.v1 = c.x[1];
        observe_step(o, &p);
    }
    note(o, STATE,
         fmax(fabs(c.x[0] - orbit->start[0]) / orbit->size[0],
              fabs(c.x[1] - orbit->start[1]) / orbit->size[1]));
}

/* ---- cost ---- */

static volatile double sink;

static void spin(const struct way *w, const struct orbit *orbit, int n)
{
    static struct ours c;
    double h = orbit->period / n;
    struct classical_state s = {orbit->start[0], orbit->start[1], 0.0};
    classical_begin(&rig, 0.0, &s);
    if (w->step == classical_table[CLASSICAL_VERLET].step) {
        for (int i = 0; i < n * PERIODS; i++)
            classical_verlet(&rig, 0.0, h, &s);
    } else if (w->step) {
        for (int i = 0; i < n * PERIODS; i++)
            classical_rk4(&rig, 0.0, h, &s);
    } else {
        ours_start(&c, w, orbit, n);
        for (int i = 0; i < n * PERIODS; i++)
            ours_tick(&c, 0.0, NULL);
        s.x = c.x[0];
    }
    sink = s.x;
}

static double cost(const struct way *w, const struct orbit *orbit, int n)
{
    double best = (double)INFINITY;
    for (int i = 0; i < REPEATS; i++) {
        double begin = physics_now_ns();
        spin(w, orbit, n);
        best = fmin(best, (physics_now_ns() - begin) / PERIODS);
    }
    return best;
}

static void print_way(const struct way *w, int n)
{
    static double error[OBSERVABLES][RUNS];
    struct orbit orbit;
    uint64_t seed = 4;
    for (int i = 0; i < RUNS; i++) {
        double speed, phase = exact_uniform(&seed);
        int steps = (int)(n * (0.95 + 0.1 * exact_uniform(&seed)));
        orbit_make(&orbit, ORBIT_HERTZ, phase);
        double flight = orbit_hertz_period(ORBIT_ETA, &speed);
        struct observer o = {.contact_time = flight - 3.0 * speed,
                             .peak = hertz_contact_force(ORBIT_ETA),
                             .start_energy = energy(ORBIT_ETA, 0.0)};
        if (w->step)
            run_classical(w, &orbit, steps, &o);
        else
            run_ours(w, &orbit, steps, &o);
        for (int k = 0; k < OBSERVABLES; k++)
            error[k][i] = o.worst[k];
    }
    printf("%s,%g,%d,%.4g", w->name, w->tol, n, cost(w, &orbit, n));
    for (int k = 0; k < OBSERVABLES; k++)
        printf(",%.3g", physics_quantile(error[k], RUNS, 0.5));
    printf("\n");
}

int main(void)
{
    const struct way classical[2] = {{"Verlet", classical_table[CLASSICAL_VERLET].step, NULL, 0.0},
                                     {"plain RK4", classical_table[CLASSICAL_RK4].step, NULL, 0.0}};
    const struct way located = {"rk4", NULL, &rk4, 0.0};
    printf("method,tol,steps,ns_per_period");
    for (int k = 0; k < OBSERVABLES; k++)
        printf(",%s", observable_name[k]);
    printf("\n");
    for (double n = 12.0; n < 8000.0; n *= 1.4) {
        print_way(&classical[0], (int)n);
        print_way(&classical[1], (int)n);
        print_way(&located, (int)n);
    }
    for (int k = 4; k <= 24; k++) {
        struct way series = {"taylor", NULL, &taylor, pow(10.0, -0.5 * k)};
        for (int n = 8; n <= 128; n *= 2)
            print_way(&series, n);
    }
    return 0;
}
