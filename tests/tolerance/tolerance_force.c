/* tolerance_force.c - the equations; see tolerance_force.h. They are those of docs/reference/models.md,
 * written for the state of the models; nothing is taken from a model but its prepared parameters. */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wdouble-promotion" /* 80-bit arithmetic with the numbers of a scene */
#endif
#include "tests/tolerance/tolerance_force.h"

#include <math.h>
#include <string.h>
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/reduced/polynomial.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

struct wave_now {
    long double value, rate;
};

/* Returns cos and sin of an angle. It takes quarters of a turn off before libm would do it: in half the time,
 * and with an error as that of the angle's own rounding. */
static void turn(long double angle, long double *c, long double *z)
{
    static const long double quarter = 1.57079632679489661926L, rest = -2.50827880633416601173e-20L;
    long double n = rintl(angle / quarter), small = angle - n * quarter - n * rest;
    long double cosine = cosl(small), sine = sinl(small);
    bool odd = (long long)n & 1, behind = (long long)n & 2;
    *c = (odd ? -sine : cosine) * (behind ? -1 : 1);
    *z = (odd ? cosine : sine) * (behind ? -1 : 1);
}

static struct wave_now drive_at(const struct tolerance_drive *d, long double t)
{
    long double s = t - d->start, part = 1.0L, slope = 0.0L;
    if (d->amplitude == 0.0 || s < 0.0L)
        return (struct wave_now){0.0L, 0.0L};
    if (s < d->ramp) {
        part = s / d->ramp;
        slope = 1.0L / d->ramp;
    }
    long double c, z;
    turn(d->omega * s + d->phase, &c, &z);
    return (struct wave_now){d->amplitude * part * c, d->amplitude * (slope * c - part * d->omega * z)};
}

static void drives_at(const struct tolerance_scene *s, long double t, struct wave_now *u)
{
    for (int i = 0; i < s->model->n_inputs; i++)
        u[i] = drive_at(&s->drive[i], t);
}

/* eta^{3/2} in contact, and on beyond its end. */
static long double hertz(unsigned regime, long double eta)
{
    return (regime & 1u) ? eta * sqrtl(fabsl(eta)) : 0.0L;
}

/* (2/3) (1 + z)^{3/2} to third order. */
static long double cubic(long double z)
{
    return 2.0L / 3 + z * (1 + z * (0.25L - z / 24));
}

static long double rig(const struct tolerance_scene *s, unsigned regime, const struct wave_now *u,
                       const long double *x)
{
    const struct model *m = s->model;
    long double z = x[0] - 1, force = (2.0L / 3) * (u[0].value + (m == &hertz_rig_averaged ? 0 : u[1].value));
    if (m == &hertz_rig_averaged)
        return (force - (cubic(z) - 2.0L / 3)) - s->p[POLYNOMIAL_DAMPING] * x[1];
    long double b = u[RIG_BASE].value, k = u[RIG_STIFFNESS].value;
    long double damping = s->p[m == &hertz_rig ? RIG_P_TWO_XI : POLYNOMIAL_DAMPING];
    long double lost = damping * (x[1] - u[RIG_BASE].rate);
    if (m == &hertz_rig)
        return (2.0L / 3 + force) - (2.0L / 3) * (1 + k) * hertz(regime, x[0] - b) - lost;
    if (m == &hertz_rig_linear)
        return force - (z - b) - (2.0L / 3) * k - lost;
    return force - (cubic(z) - 2.0L / 3) + b * (1 + z / 2 - z * z / 8 + z * z * z / 16) - k * cubic(z) - lost;
}

static long double rolling(const struct tolerance_scene *s, unsigned regime, const struct wave_now *u,
                           const long double *x)
{
    bool full = s->model == &rolling_contact;
    long double eta = x[0] + u[ROLLING_WAVINESS].value, force = (2.0L / 3) * u[ROLLING_FORCE].value;
    long double lost = s->p[full ? ROLLING_P_TWO_ZETA : POLYNOMIAL_DAMPING] * x[1];
    return force - (full ? (2.0L / 3) * (hertz(regime, eta) - 1) : eta - 1) - lost;
}

static long double tip(const struct tolerance_scene *s, unsigned regime, const struct wave_now *u,
                       const long double *x)
{
    bool full = s->model == &afm_tip, averaged = s->model == &afm_tip_averaged;
    long double z = x[0] - 1, k = averaged ? 0 : u[TIP_STIFFNESS].value;
    long double b = full ? (long double)s->p[TIP_P_HERTZ]
                         : -(2.0L / 3) * s->si[TIP_SIGN] * 1.5L * s->si[TIP_CONTACT_STIFFNESS] *
                               sqrtl(s->si[TIP_INDENTATION]) / s->si[TIP_LEVER_STIFFNESS];
    long double lost = s->p[full ? TIP_P_DAMPING : POLYNOMIAL_DAMPING] * x[1];
    long double contact = full ? hertz(regime, x[0]) : 1.5L * cubic(z);
    if (s->model == &afm_tip_linear)
        return u[0].value - z - 1.5L * b * z - b * k - lost;
    return u[0].value - z - b * (contact - 1) - b * k * contact - lost;
}

static void shaft(const struct tolerance_scene *s, unsigned regime, const struct wave_now *u,
                  const long double *x, long double *x_dot)
{
    long double bend = x[0] - 2 * x[1] + x[2];
    static const double share[3] = {1.0, -2.0, 1.0};
    for (int i = 0; i < 3; i++) {
        long double force = u[i].value - s->p[SHAFT_P_DAMPING + i] * x[3 + i] -
                            s->p[SHAFT_P_SUPPORT + i] * x[i] - share[i] * bend;
        if ((regime >> i) & 1u) /* bits 0, 1 and 2, 3: masses 0 and 2 */
            force -= s->p[SHAFT_P_CONTACT + i] * (x[i] - s->p[SHAFT_P_GAP + i]);
        if ((regime >> (i + 1)) & 1u && i != 1)
            force -= s->p[SHAFT_P_CONTACT + i] * (x[i] + s->p[SHAFT_P_GAP + i]);
        x_dot[i] = x[3 + i];
        x_dot[3 + i] = force / s->p[SHAFT_P_MASS + i];
    }
}

/* Along the shape: mass, damping and springs are the quadratic forms of the full shaft's. */
static long double shaft_mode(const struct tolerance_scene *s, unsigned regime, const struct wave_now *u,
                              const long double *x)
{
    const double *p = s->p, *phi = &p[SHAFT_P_SHAPE];
    long double mass = 0, force = 0, bend = phi[0] - 2 * phi[1] + (long double)phi[2];
    for (int i = 0; i < 3; i++) {
        long double f = phi[i];
        mass += p[SHAFT_P_MASS + i] * f * f;
        force += f * (u[i].value - p[SHAFT_P_DAMPING + i] * f * x[1] - p[SHAFT_P_SUPPORT + i] * f * x[0]);
        if (i == 1)
            continue;
        if ((regime >> i) & 1u)
            force -= f * p[SHAFT_P_CONTACT + i] * (f * x[0] - p[SHAFT_P_GAP + i]);
        if ((regime >> (i + 1)) & 1u)
            force -= f * p[SHAFT_P_CONTACT + i] * (f * x[0] + p[SHAFT_P_GAP + i]);
    }
    return (force - bend * bend * x[0]) / mass;
}

static void rhs(const void *context, unsigned regime, long double t, const long double *x, long double *x_dot)
{
    const struct tolerance_scene *s = context;
    struct wave_now u[MODEL_INPUTS];
    drives_at(s, t, u);
    if (s->model->n_states == 6) {
        shaft(s, regime, u, x, x_dot);
        return;
    }
    x_dot[0] = x[1];
    if (s->model == &shaft_bearing_mode)
        x_dot[1] = shaft_mode(s, regime, u, x);
    else if (s->model == &rolling_contact || s->model == &rolling_contact_linear)
        x_dot[1] = rolling(s, regime, u, x);
    else if (strncmp(s->model->name, "afm_tip", 7) == 0)
        x_dot[1] = tip(s, regime, u, x);
    else
        x_dot[1] = rig(s, regime, u, x);
}

/* Both sides of the bearings. */
static void shaft_gaps(const struct tolerance_scene *s, const long double *x, long double *gap,
                       long double *rate)
{
    bool mode = s->model == &shaft_bearing_mode;
    for (int i = 0; i < 4; i++) {
        int mass = i & 2;
        long double sign = i & 1 ? -1 : 1, shape = mode ? s->p[SHAFT_P_SHAPE + mass] : 1;
        gap[i] = s->p[SHAFT_P_GAP + mass] - sign * shape * x[mode ? 0 : mass];
        rate[i] = -sign * shape * x[mode ? 1 : 3 + mass];
    }
}

static void gaps(const void *context, long double t, const long double *x, long double *gap,
                 long double *rate)
{
    const struct tolerance_scene *s = context;
    struct wave_now u[MODEL_INPUTS];
    if (s->model->n_contacts == 4) {
        shaft_gaps(s, x, gap, rate);
        return;
    }
    drives_at(s, t, u);
    struct wave_now moved = s->model == &hertz_rig         ? u[RIG_BASE]
                            : s->model == &rolling_contact ? (struct wave_now){-u[1].value, -u[1].rate}
                                                           : (struct wave_now){0, 0};
    gap[0] = moved.value - x[0];
    rate[0] = moved.rate - x[1];
}

void tolerance_motion(const struct tolerance_scene *s, bool fine, struct extrapolation *e)
{
    double fastest = s->eigenfrequency;
    bool moves = strncmp(s->model->name, "shaft", 5) != 0;
    *e = (struct extrapolation){
        .context = s, .n = s->model->n_states, .n_gaps = s->model->n_contacts, .rhs = rhs, .gap = gaps};
    for (int i = 0; i < s->model->n_inputs; i++)
        fastest = fmax(fastest, s->drive[i].amplitude != 0.0 ? s->drive[i].omega : 0.0);
    e->step_max = (fine ? 0.15L : 0.6L) / fastest;
    e->error = (fine ? 1e-8L : 1e-6L) * s->tol;
    e->least[0] = 1e-2L * s->size;
    e->least[1] = 1e-2L * s->size * s->eigenfrequency;
    e->rest[0] = moves ? 1.0L : 0.0L;
    for (int k = 0; k < e->n; k++)
        e->x[k] = s->x[k];
    extrapolation_start(e);
}
