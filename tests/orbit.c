/* orbit.c - see orbit.h. */
#include "tests/orbit.h"

#include <math.h>
#include <stddef.h>
#include "models/hertz_rig.h"
#include "tests/exact.h"
#include "tests/gap_oscillator.h"

#define HALF_PI 1.57079632679489661923

double orbit_hertz_force(const void *context, double t, double x)
{
    (void)context, (void)t;
    return (2.0 / 3.0) * (1.0 - hertz_contact_force(x));
}

double orbit_hertz_slope(const void *context, double t, double x)
{
    (void)context, (void)t;
    return x > 0.0 ? -sqrt(x) : 0.0;
}

static double gap_force(const void *context, double t, double x)
{
    (void)context, (void)t;
    return -x - ORBIT_KAPPA * ((x > 1.0 ? x - 1.0 : 0.0) + (x < -1.0 ? x + 1.0 : 0.0));
}

static double gap_slope(const void *context, double t, double x)
{
    (void)context, (void)t;
    return fabs(x) > 1.0 ? -1.0 - ORBIT_KAPPA : -1.0;
}

/* d(contact time)/d(angle), eta = top cos^2(angle): smooth up to both ends, since (top - eta) is divided out of the
 * energy still in the contact. */
static double contact_rate(double top, double angle)
{
    double m = sqrt(top), s = m * cos(angle), sum = 0.0, power = 1.0;
    for (int k = 0; k <= 4; k++) {
        sum = sum * s + power;
        power *= m;
    }
    return 4.0 * s * m * cos(0.5 * angle) / sqrt((8.0 / 3.0) * m * (0.4 * sum - (m + s)));
}

double orbit_hertz_period(double eta_max, double *speed)
{
    enum { PANELS = 8000 };
    double h = HALF_PI / PANELS;
    long double sum = (long double)(contact_rate(eta_max, 0.0) + contact_rate(eta_max, HALF_PI));
    for (int i = 1; i < PANELS; i++)
        sum += (long double)((i & 1 ? 4.0 : 2.0) * contact_rate(eta_max, i * h));
    *speed = sqrt((4.0 / 3.0) * (0.4 * eta_max * eta_max * sqrt(eta_max) - eta_max));
    return 2.0 * (double)sum * h / 3.0 + 3.0 * *speed;
}

static void make_hertz(struct orbit *o, double phase)
{
    double speed, t;
    *o = (struct orbit){.model = &hertz_rig, .omega = 1.0};
    hertz_rig_unit_scale(0.0, o->si);
    o->period = orbit_hertz_period(ORBIT_ETA, &speed);
    t = 3.0 * speed * phase;
    o->start[0] = t * (t / 3.0 - speed);
    o->start[1] = (2.0 / 3.0) * t - speed;
    o->size[0] = ORBIT_ETA;
    o->size[1] = speed;
    o->free = (struct classical){orbit_hertz_force, orbit_hertz_slope, 0.0, NULL};
}

/* In contact x = c + (1 - c) cos w t + (u/w) sin w t with c = kappa/w^2, from speed u at the gap. */
static void make_gap(struct orbit *o, double phase)
{
    double v = ORBIT_SPEED, w = sqrt(1.0 + ORBIT_KAPPA), u = sqrt(v * v - 1.0), c = ORBIT_KAPPA / (w * w);
    double edge = asin(1.0 / v), angle = (2.0 * phase - 1.0) * edge;
    *o = (struct orbit){.model = &gap_oscillator, .omega = w};
    o->si[GAP_K] = o->si[GAP_G] = 1.0;
    o->si[GAP_KAPPA] = ORBIT_KAPPA;
    o->period = 4.0 * (edge + atan2(u / w, 1.0 - c) / w);
    o->start[0] = v * sin(angle);
    o->start[1] = v * cos(angle);
    o->size[0] = 1.0 + u / w;
    o->size[1] = v;
    o->free = (struct classical){gap_force, gap_slope, 0.0, NULL};
}

void orbit_make(struct orbit *o, enum orbit_kind kind, double phase)
{
    (kind == ORBIT_HERTZ ? make_hertz : make_gap)(o, phase);
}

static double error_at(const struct orbit *o, double x, double v)
{
    return fmax(fabs(x - o->start[0]) / o->size[0], fabs(v - o->start[1]) / o->size[1]);
}

double orbit_error(const struct orbit *o, const struct orbit_way *w, int n)
{
    static double work[METHOD_WORK];
    static struct plant pl;
    double h = o->period / n;
    if (w->step) {
        struct classical_state s = {o->start[0], o->start[1], 0.0};
        classical_begin(&o->free, 0.0, &s);
        for (int i = 0; i < n; i++)
            w->step(&o->free, i * h, h, &s);
        return error_at(o, s.x, s.v);
    }
    struct plant_config c = {.model = o->model,
                             .si = o->si,
                             .method = w->method,
                             .tick_s = h,
                             .dilation = 1.0,
                             .tol = w->tol,
                             .force = true,
                             .work = work};
    if (plant_init(&pl, &c) != NULL)
        return (double)NAN;
    plant_set_state(&pl, o->start);
    return plant_run(&pl, (uint64_t)n) ? error_at(o, pl.x[0], pl.x[1]) : (double)NAN;
}

double orbit_draw(enum orbit_kind kind, const struct orbit_way *w, double n, uint64_t *seed, double *h_omega)
{
    struct orbit o;
    orbit_make(&o, kind, exact_uniform(seed));
    int steps = (int)(n * (0.9 + 0.2 * exact_uniform(seed)));
    *h_omega = o.omega * o.period / steps;
    return orbit_error(&o, w, steps);
}
