/* lever_judge.c - see lever_judge.h. */
#include "tests/choose/lever_judge.h"

#include <math.h>
#include <string.h>

#include "models/afm_lever.h"

enum { MODES = 4, STATES = 2 * MODES, STAGES = 7 };
#define TWO_PI 6.283185307179586

/* Roots, slopes at the tip and shares in the base's motion of the clamped-free beam,
 * docs/reference/afm_lever.md. */
static const double beta[MODES] = {1.87510406871196, 4.69409113297417, 7.85475743823761, 10.9955407348755};
static const double slope[MODES] = {0.9176703231150232, 3.187185606807756, 5.232444030993002,
                                    7.330606447347646};
static const double share[MODES] = {1.565983512079251, -0.8678717902214385, 0.5088505937322114,
                                    -0.3637960432740972};

struct lever_motion {
    const double *si;
    struct harmonic drive[MODEL_INPUTS];
    int modes;
    double k[MODES], w[MODES], sensor[MODES], mass, rest, sensor_rest; /* rest: 1/k_res */
    bool out;                                                          /* the branch */
};

/* The drive and its first two derivatives. */
static void wave(const struct harmonic *d, double t, double u[3])
{
    double at = d->omega * t + d->phase;
    u[0] = d->amplitude * cos(at);
    u[1] = -d->amplitude * d->omega * sin(at);
    u[2] = -d->amplitude * d->omega * d->omega * cos(at);
}

/* The sample's force without its drag at a gap. */
static double law(const struct lever_motion *o, double stiffness, double d)
{
    const double *si = o->si;
    double H = o->out ? si[LEVER_HAMAKER_OUT] : si[LEVER_HAMAKER], a0 = si[LEVER_A0], R = si[LEVER_RADIUS];
    if (d > a0)
        return -H * R / (6.0 * d * d);
    return (4.0 / 3.0) * si[LEVER_MODULUS] * (1.0 + stiffness) * sqrt(R) * pow(a0 - d, 1.5) -
           H * R / (6.0 * a0 * a0);
}

/* The gap with the spring of the modes left out: a root between bounds, by regula falsi (Illinois). */
static double gap_of(const struct lever_motion *o, double stiffness, double rigid)
{
    double low = rigid, high = rigid, step = 1e-13, f_low, f_high;
    if (!(o->rest > 0.0))
        return rigid;
    double f = rigid + o->rest * law(o, stiffness, rigid) - rigid;
    double sign = f > 0.0 ? 1.0 : -1.0;
    do { /* away from the rigid gap, to where the spring balances */
        low = high;
        f_low = rigid + o->rest * law(o, stiffness, low) - low;
        high = rigid + sign * step;
        f_high = rigid + o->rest * law(o, stiffness, high) - high;
        step *= 2.0;
    } while (sign * f_high > 0.0 && step < 1.0);
    for (int i = 0; i < 100 && fabs(high - low) > 1e-20; i++) {
        double middle = (low * f_high - high * f_low) / (f_high - f_low);
        double f_middle = rigid + o->rest * law(o, stiffness, middle) - middle;
        if (f_middle == 0.0)
            return middle;
        if ((f_middle > 0.0) == (f_high > 0.0)) {
            f_low *= 0.5;
        } else {
            low = high;
            f_low = f_high;
        }
        high = middle;
        f_high = f_middle;
    }
    return high;
}

/* Gap, its rate for a rigid tip, and force at a state. */
static void touch(const struct lever_motion *o, double t, const double *x, double *gap, double *rate,
                  double *force)
{
    double z[3], u[3], rigid = o->si[LEVER_HEIGHT];
    wave(&o->drive[LEVER_Z], t, z);
    wave(&o->drive[LEVER_STIFFNESS], t, u);
    rigid += z[0];
    *rate = z[1];
    for (int i = 0; i < o->modes; i++) {
        rigid += x[i];
        *rate += x[MODES + i];
    }
    *gap = gap_of(o, u[0], rigid);
    double depth = fmax(o->si[LEVER_A0] - *gap, 0.0);
    *force = law(o, u[0], *gap) - o->si[LEVER_VISCOSITY] * sqrt(o->si[LEVER_RADIUS] * depth) * *rate;
}

static void rhs(const struct lever_motion *o, double t, const double *x, double *dx)
{
    double gap, rate, force, u[3], z[3], all;
    touch(o, t, x, &gap, &rate, &force);
    all = force;
    for (int k = LEVER_FORCE; k <= LEVER_FORCE_2; k++) {
        wave(&o->drive[k], t, u);
        all += u[0];
    }
    wave(&o->drive[LEVER_Z], t, z);
    memset(dx, 0, STATES * sizeof *dx);
    for (int i = 0; i < o->modes; i++) {
        dx[i] = x[MODES + i];
        dx[MODES + i] = all / o->mass - o->w[i] / o->si[LEVER_Q] * x[MODES + i] - o->w[i] * o->w[i] * x[i] -
                        share[i] * z[2];
    }
}

/* One step of order 5; returns its error over what is allowed. */
static double step(const struct lever_motion *o, double t, double h, const double *x, const double *scale,
                   double *y)
{
    static const double at[STAGES] = {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1, 1};
    static const double a[STAGES][STAGES - 1] = {
        {0},
        {1. / 5},
        {3. / 40, 9. / 40},
        {44. / 45, -56. / 15, 32. / 9},
        {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
        {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
        {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}};
    static const double off[STAGES] = {71. / 57600,      0,         -71. / 16695, 71. / 1920,
                                       -17253. / 339200, 22. / 525, -1. / 40};
    double k[STAGES][STATES], worst = 0.0;
    for (int j = 0; j < STAGES; j++) {
        for (int i = 0; i < STATES; i++) {
            y[i] = x[i];
            for (int m = 0; m < j; m++)
                y[i] += h * a[j][m] * k[m][i];
        }
        rhs(o, t + at[j] * h, y, k[j]);
    }
    for (int i = 0; i < STATES; i++) {
        double e = 0.0;
        for (int j = 0; j < STAGES; j++)
            e += h * off[j] * k[j][i];
        worst = fmax(worst, fabs(e) / scale[i]);
    }
    return worst;
}

static double observe(const struct lever_motion *o, double t, const double *x, int which)
{
    double gap, rate, force, z[3], sensor = 0.0, q_rate = 0.0;
    touch(o, t, x, &gap, &rate, &force);
    wave(&o->drive[LEVER_Z], t, z);
    double base = o->si[LEVER_HEIGHT] + z[0];
    for (int i = 0; i < o->modes; i++) {
        sensor += o->sensor[i] * x[i];
        q_rate += x[MODES + i];
    }
    const double value[LEVER_OUTPUTS] = {gap - base,
                                         q_rate,
                                         fmax(o->si[LEVER_A0] - gap, 0.0),
                                         force,
                                         gap < o->si[LEVER_A0] ? 1.0 : 0.0,
                                         gap,
                                         sensor + o->sensor_rest * force,
                                         gap,
                                         base};
    return value[which];
}

static void set_up(const struct scene *s, struct lever_motion *o, double *si, double *x)
{
    struct scale scale;
    double p[MODEL_DERIVED], start[MODEL_STATES], z[3], flexibility = 1.0, slopes = 1.0;
    scenes_resolve(s, si, o->drive);
    s->model->prepare(si, p, &scale);
    scenes_begin(s, si, o->drive, start);
    o->si = si;
    o->modes = (int)si[LEVER_MODES];
    for (int i = 0; i < o->modes; i++) {
        double ratio = beta[i] / beta[0], stiff = pow(beta[i], 4.0) / 12.0;
        o->w[i] = TWO_PI * si[LEVER_F0] * ratio * ratio;
        o->k[i] = o->modes > 1 ? si[LEVER_K] * stiff : si[LEVER_K];
        o->sensor[i] = o->modes > 1 ? slope[i] : 1.0;
        flexibility -= 1.0 / stiff;
        slopes -= slope[i] / stiff;
    }
    o->mass = o->k[0] / (o->w[0] * o->w[0]);
    o->rest = o->modes > 1 ? flexibility / si[LEVER_K] : 0.0;
    o->sensor_rest = o->modes > 1 ? slopes / si[LEVER_K] : 0.0;
    o->out = start[LEVER_BRANCH] != 0.0;
    wave(&o->drive[LEVER_Z], 0.0, z);
    memset(x, 0, STATES * sizeof *x);
    for (int i = 0; i < o->modes; i++) {
        x[i] = start[i] * scale.length_m - share[i] * z[0];
        x[MODES + i] = start[LEVER_RATE + i] * scale.length_m / scale.time_s - share[i] * z[1];
    }
}

/* The tip turns back in contact within this step: it is shortened to almost there. */
static bool turns(const struct lever_motion *o, double t, const double *x, double h, const double *y,
                  double least)
{
    double gap, rate, force, before;
    if (o->out || o->si[LEVER_HAMAKER_OUT] <= o->si[LEVER_HAMAKER] || h < least)
        return false;
    touch(o, t, x, &gap, &before, &force);
    touch(o, t + h, y, &gap, &rate, &force);
    return gap <= o->si[LEVER_A0] && before <= 0.0 && rate > 0.0;
}

bool lever_judge(const struct scene *s, double error, const double *at, int n, struct lever_judged *j)
{
    struct lever_motion o = {.modes = 0};
    double si[MODEL_PARAMETERS], x[STATES], y[STATES], scale[STATES], t = 0.0, open = 0.0;
    double unit = (int)s->observable == 1 ? 1.0 / s->dilation : 1.0; /* a velocity is one in bus time */
    double low = HUGE_VAL, high = -HUGE_VAL;
    set_up(s, &o, si, x);
    double w = o.w[0], h = 1e-3 / w, least = 1e-6 / w, gap, rate, force;
    for (int i = 0; i < STATES; i++)
        scale[i] = error * 1e-9 * (i < MODES ? 1.0 : w);
    for (int i = 0; i < n;) {
        double end = at[i], go = fmin(h, end - t);
        double off = step(&o, t, go, x, scale, y);
        if (!(off <= 1.0) || turns(&o, t, x, go, y, least)) {
            h = go * (off > 1.0 ? fmax(0.9 * pow(off, -0.2), 0.1) : 0.5);
            if (!(h > 1e-12 / w))
                return false;
            continue;
        }
        bool there = go == end - t;
        memcpy(x, y, sizeof x);
        t = there ? end : t + go;
        touch(&o, t, x, &gap, &rate, &force);
        open += gap > si[LEVER_A0] ? go : 0.0;
        if (si[LEVER_HAMAKER_OUT] > si[LEVER_HAMAKER])
            o.out = o.out ? gap <= si[LEVER_RELEASE] : gap <= si[LEVER_A0] && rate > 0.0;
        double now = unit * observe(&o, t, x, (int)s->observable);
        low = fmin(low, now);
        high = fmax(high, now);
        if (there)
            j->value[i++] = now;
        else
            h = go * fmin(0.9 * pow(fmax(off, 1e-10), -0.2), 3.0);
    }
    j->loss = t > 0.0 ? open / t : 0.0;
    j->span = high - low;
    return true;
}
