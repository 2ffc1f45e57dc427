/* random_law.c - stationary density, crossings and contact loss under white noise, in closed form. */
#include "host_sim/maps/random/random_law.h"

#include <math.h>
#include <stddef.h>
#include "host_sim/scene/scene_check.h"
#include "models/math/elementary.h"

/* The density is cut off at e^-exponent of its maximum. The search for this place has steps of `march`
 * standard deviations. */
static const double exponent = 80.0, march = 0.01;
enum { MARCH = 1000000 };

/* ---- the potential, as a function of the model's own position ---- */

static double hertz_potential(const struct random_law *l, double x)
{
    struct hertz_form f;
    l->model->hertz_form(l->p, &f);
    double eta = f.side * x + f.origin, touch = fmax(0.0, eta);
    return -f.constant * eta + 0.5 * f.stiffness * eta * eta + 0.4 * f.hertz * touch * touch * sqrt(touch);
}

static double polynomial_potential(const struct random_law *l, double x)
{
    struct polynomial_form f;
    double sum = 0.0;
    l->model->polynomial_form(l->p, &f);
    for (int k = 3; k >= 0; k--)
        sum = (sum + f.constant[k] / (k + 1)) * x;
    return -sum;
}

static double potential(const struct random_law *l, double x)
{
    return (l->model->hertz_form ? hertz_potential : polynomial_potential)(l, x) - l->bottom;
}

static double density(const struct random_law *l, double x)
{
    return x < l->from || x > l->to ? 0.0 : l->norm * exp(-l->cold * potential(l, x));
}

/* ---- the noise ---- */

/* The acceleration for a unit of input i; NaN where the input does anything else. */
static double hertz_gain(const struct random_law *l, int i)
{
    struct hertz_form f;
    l->model->hertz_form(l->p, &f);
    bool more = fabs(f.shift[i]) + fabs(f.drag[i]) + fabs(f.modulation[i]) > 0.0;
    return more ? (double)NAN : f.force[i];
}

static double polynomial_gain(const struct random_law *l, int i)
{
    struct polynomial_form f;
    l->model->polynomial_form(l->p, &f);
    double more = fabs(f.rate[0][i]);
    for (int k = 1; k < 4; k++)
        more += fabs(f.modulation[k][i]) + fabs(f.rate[k][i]);
    return more > 0.0 ? (double)NAN : f.modulation[0][i];
}

/* Finds the density Phi of all noise at the eigenfrequency, and its mean hold time, in model units. NULL,
 * or why it is not white. */
static const char *noise_of(const struct random_law *l, const struct scene *s, const struct scale *scale,
                            double step, double *Phi, double *hold)
{
    double omega = l->model->eigenfrequency(l->p);
    *Phi = *hold = 0.0;
    for (int i = 0; i < s->model->n_inputs; i++) {
        const struct scene_drive *d = &s->drive[i];
        if (!(d->noise > 0.0))
            continue;
        double gain = (l->model->hertz_form ? hertz_gain : polynomial_gain)(l, i);
        if (!isfinite(gain))
            return "the noise is not on a force alone";
        double T = scenes_noise_steps(d, step) * step / scale->time_s, half = 0.5 * omega * T;
        double sigma = gain * d->noise / scale_of(scale, s->model->input_signal[i].quantity);
        double level = sigma * sigma * T / (2.0 * ELEMENTARY_PI) * pow(sin(half) / half, 2.0);
        *Phi += level;
        *hold += level * T;
    }
    *hold /= *Phi;
    return *Phi > 0.0 ? NULL : "there is no noise";
}

/* ---- the observable: a position, or one that stops at first touch ---- */

static const char *observe(struct random_law *l, const struct scene *s, const struct scale *scale)
{
    static const double at[4][2] = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {-1.0, 0.0}};
    const struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    int which = (int)s->observable;
    double y[4], output[MODEL_OUTPUTS], unit = scale_of(scale, s->model->output_signal[which].quantity);
    for (int i = 0; i < 4; i++) {
        s->model->output(l->p, u, at[i], output);
        y[i] = output[which] * unit;
    }
    l->offset = y[0];
    l->gain = y[1] - y[0];
    l->clipped = fabs(y[3] - y[0]) < 0.5 * fabs(l->gain);
    double expected = l->clipped ? l->offset : l->offset - l->gain;
    bool position = s->model->output_signal[which].quantity == QUANTITY_LENGTH && fabs(l->gain) > 0.0;
    return position && fabs(y[3] - expected) + fabs(y[2] - y[1]) <= 1e-12 * fabs(l->gain)
               ? NULL
               : "the observable is not a position";
}

/* ---- the law ---- */

/* Where the density ends in this direction; NaN where the potential falls again. */
static double find_end(const struct random_law *l, double step)
{
    double x = l->rest, last = 0.0;
    for (int i = 0; i < MARCH && l->cold * last < exponent; i++) {
        double now = potential(l, x += step);
        if (now < last)
            return (double)NAN;
        last = now;
    }
    return x;
}

static void integrate(struct random_law *l)
{
    double h = (l->to - l->from) / RANDOM_LAW_POINTS, before;
    l->norm = 1.0;
    l->below[0] = 0.0;
    before = density(l, l->from);
    for (int i = 1; i <= RANDOM_LAW_POINTS; i++) {
        double now = density(l, l->from + h * i);
        l->below[i] = l->below[i - 1] + 0.5 * h * (before + now);
        before = now;
    }
    l->norm = 1.0 / l->below[RANDOM_LAW_POINTS];
    for (int i = 1; i <= RANDOM_LAW_POINTS; i++)
        l->below[i] *= l->norm;
}

static const char *solve(struct random_law *l, double Phi, double hold)
{
    struct hertz_form h;
    struct polynomial_form f;
    double x[MODEL_STATES], omega = l->model->eigenfrequency(l->p);
    if (l->model->hertz_form)
        l->model->hertz_form(l->p, &h);
    else
        l->model->polynomial_form(l->p, &f);
    l->damping = l->model->hertz_form ? h.damping : f.damping;
    if (!(l->damping > 0.0))
        return "without damping nothing is stationary";
    l->cold = l->damping / (ELEMENTARY_PI * Phi);
    l->speed = sqrt((1.0 - l->damping * hold / 3.0) / l->cold);
    l->model->rest(l->p, x);
    l->rest = x[0];
    l->bottom = 0.0;
    l->bottom = potential(l, l->rest);
    double step = march / sqrt(l->cold) / omega;
    l->from = find_end(l, -step);
    l->to = find_end(l, step);
    if (!isfinite(l->from + l->to))
        return "the contact's potential is open on one side: every motion escapes in the end";
    integrate(l);
    return NULL;
}

const char *random_law_of(const struct scene *s, struct random_law *l)
{
    double si[MODEL_PARAMETERS], Phi, hold;
    struct harmonic drive[MODEL_INPUTS];
    struct scale scale;
    l->model = s->model;
    if (!s->model->hertz_form && !s->model->polynomial_form)
        return "the model has more than one degree of freedom";
    scenes_resolve(s, si, drive);
    for (int i = 0; i < s->model->n_inputs; i++)
        if (fabs(drive[i].amplitude) > 0.0)
            return "a harmonic drive sounds besides";
    s->model->prepare(si, l->p, &scale);
    l->time_s = scale.time_s;
    const char *why = observe(l, s, &scale);
    why = why ? why : noise_of(l, s, &scale, scene_check_step(s), &Phi, &hold);
    return why ? why : solve(l, Phi, hold);
}

static double below(const struct random_law *l, double x)
{
    double at = (x - l->from) / (l->to - l->from) * RANDOM_LAW_POINTS;
    if (!(at > 0.0))
        return 0.0;
    if (at >= RANDOM_LAW_POINTS)
        return 1.0;
    int i = (int)at;
    return l->below[i] + (l->below[i + 1] - l->below[i]) * (at - i);
}

void random_law_moments(const struct random_law *l, double *mean, double *variance)
{
    double h = (l->to - l->from) / RANDOM_LAW_POINTS, first = 0.0, second = 0.0;
    for (int i = 0; i <= RANDOM_LAW_POINTS; i++) {
        double x = l->from + h * i, part = h * density(l, x);
        double off = (l->clipped && x < 0.0 ? 0.0 : x) - l->rest;
        first += part * off;
        second += part * off * off;
    }
    *mean = l->offset + l->gain * (l->rest + first);
    *variance = l->gain * l->gain * (second - first * first);
}

static double crossing(const struct random_law *l, double x)
{
    return l->speed / sqrt(2.0 * ELEMENTARY_PI) * density(l, x) / l->time_s;
}

/* The position at which the observable has this value. */
static double position(const struct random_law *l, double level)
{
    double x = (level - l->offset) / l->gain;
    return l->clipped && x < 0.0 ? -(double)INFINITY : x;
}

double random_law_above(const struct random_law *l, double level)
{
    double part = below(l, position(l, level));
    return l->gain > 0.0 ? 1.0 - part : part;
}

double random_law_crossing(const struct random_law *l, double level)
{
    return crossing(l, position(l, level));
}

/* The position of first touch. */
static double touch(const struct random_law *l, double *side)
{
    struct hertz_form f;
    l->model->hertz_form(l->p, &f);
    *side = f.side;
    return -f.origin / f.side;
}

double random_law_open(const struct random_law *l)
{
    double side, x;
    if (!l->model->hertz_form)
        return (double)NAN;
    x = touch(l, &side);
    return side > 0.0 ? below(l, x) : 1.0 - below(l, x);
}

double random_law_touches(const struct random_law *l)
{
    double side;
    return l->model->hertz_form ? crossing(l, touch(l, &side)) : (double)NAN;
}
