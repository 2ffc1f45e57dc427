/* problem_curves.c - residuals of response curves and their slopes, see problem.h. */
#include "host_sim/fit/solve/problem_curves.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/fit/motion/linear.h"
#include "models/math/elementary.h"

static const double nudge = 1e-4; /* step of u, for slopes */
/* The difference of a point from its data, over the larger of both, that weighs half. */
static const double far_off = 0.3;
static const double one_drive = 1.01; /* amplitudes of drives that are one level */
static const double distinct = 5.0;   /* motions that differ by more standard deviations are two */

static double size_of(double re, double im)
{
    return sqrt(re * re + im * im);
}

/* ---- residuals ---- */

/* Model less data, over the standard deviation; amplitudes where the data have no phase. */
static void compare(const struct curve *c, int i, double re, double im, double *r)
{
    const struct curve_point *p = &c->point[i];
    r[0] = ((c->has_phase ? re : size_of(re, im)) - p->re) / p->sigma;
    r[1] = c->has_phase ? (im - p->im) / p->sigma : 0.0;
}

/* The weight of a point whose model is re + i im, and its part of a robust cost (Cauchy's). */
static double weigh(const struct curve *c, int i, const double *r, double re, double im, double *cost)
{
    const struct curve_point *p = &c->point[i];
    double scale = far_off * fmax(size_of(p->re, p->im), size_of(re, im)) / p->sigma;
    double off = (r[0] * r[0] + r[1] * r[1]) / (scale * scale);
    *cost += scale * scale * logarithm(1.0 + off);
    return 1.0 / sqrt(1.0 + off);
}

/* The response of a point's motion as it is measured; 0 where there is none. */
static void response_of(const struct fit_setup *s, const double *u, const struct follow_point *at, double *re,
                        double *im)
{
    *re = at->found ? at->orbit.re : 0.0;
    *im = at->found ? at->orbit.im : 0.0;
    unknown_measure(s, u, at->orbit.frequency_Hz, re, im);
}

double problem_curves_miss(const struct fit_setup *s, const double *u, const struct curve *c, int i,
                           const struct follow_point *at)
{
    double re, im, r[2];
    response_of(s, u, at, &re, &im);
    compare(c, i, re, im, r);
    return size_of(r[0], r[1]);
}

/* Takes the other branch's motion where it is nearer to the data. */
static void choose_motion(const struct fit_setup *s, const double *u, const struct curve *c, int i,
                          const struct follow_point *other, struct fit_point *p)
{
    double re, im, other_re, other_im;
    response_of(s, u, &p->at, &re, &im);
    response_of(s, u, other, &other_re, &other_im);
    bool differ = size_of(re - other_re, im - other_im) > distinct * c->point[i].sigma;
    if (!other->found || !differ ||
        problem_curves_miss(s, u, c, i, other) >= problem_curves_miss(s, u, c, i, &p->at))
        return;
    p->other = p->at.found;
    double jump_Hz = p->at.jump_Hz;
    p->at = *other;
    p->at.jump_Hz = jump_Hz;
}

/* Takes the motions of a curve without jumps from those of the plant before. False: they lead elsewhere. */
static bool go_on(const struct fit_setup *s, int c, struct orbit_task *t)
{
    for (int i = 0; i < s->data.curve[c].n; i++) {
        const struct orbit from = s->point[c][i].at.orbit;
        if (!follow_on(t, &from, &s->point[c][i].at.orbit))
            return false;
    }
    return true;
}

/* All points that count lie near their motions. */
static bool fits(const struct fit_setup *s, const double *u, int c)
{
    for (int i = 0; i < s->data.curve[c].n; i++)
        if (!s->point[c][i].flank &&
            problem_curves_miss(s, u, &s->data.curve[c], i, &s->point[c][i].at) > distinct)
            return false;
    return true;
}

/* Follows curve c in its direction, and the other way where that may fit better. */
static void follow_both(struct fit_setup *s, int c, const double *u, struct orbit_task *t, double *frequency,
                        struct follow_point *at)
{
    const struct curve *curve = &s->data.curve[c];
    int by = curve->down ? -1 : 1;
    for (int i = 0; i < curve->n; i++)
        frequency[i] = curve->point[i].frequency_Hz;
    s->smooth[c] = follow_curve(t, frequency, curve->n, by, at) == 0;
    for (int i = 0; i < curve->n; i++) {
        s->point[c][i] = (struct fit_point){.at = at[i]};
        s->smooth[c] = s->smooth[c] && at[i].found;
    }
    for (int i = 0; i < curve->n; i++)
        if (at[i].jump_Hz > 0.0)
            s->point[c][i].flank = s->point[c][i - by].flank = true;
    if (s->smooth[c] || fits(s, u, c))
        return;
    follow_curve(t, frequency, curve->n, -by, at);
    for (int i = 0; i < curve->n; i++)
        choose_motion(s, u, curve, i, &at[i], &s->point[c][i]);
}

/* The motions of curve c into s->point[c]. False: no plant, or no memory. */
static bool follow(struct fit_setup *s, int c, const double *u)
{
    size_t n = (size_t)s->data.curve[c].n;
    struct orbit_task t;
    if (!unknown_task(s, c, u, &t))
        return false;
    if (s->smooth[c] && go_on(s, c, &t))
        return true;
    double *frequency = calloc(n, sizeof *frequency);
    struct follow_point *at = calloc(n, sizeof *at);
    bool good = frequency && at;
    if (good)
        follow_both(s, c, u, &t, frequency, at);
    free(frequency);
    free(at);
    return good;
}

/* The response of point i of curve c by the form of the problem. */
static bool respond(const struct problem *p, const struct orbit_task *t, const double *u, int c, int i,
                    double *re, double *im)
{
    double frequency = p->s->data.curve[c].point[i].frequency_Hz;
    if (p->form == PROBLEM_LINEAR) {
        if (!linear_response(t, frequency, re, im))
            return false;
        unknown_measure(p->s, u, frequency, re, im);
        return true;
    }
    response_of(p->s, u, &p->s->point[c][i].at, re, im);
    return true;
}

/* Data over model less 1, in units of the noise. */
static void compare_linear(const struct curve *c, int i, double re, double im, double *r)
{
    const struct curve_point *p = &c->point[i];
    double square = re * re + im * im, relative = size_of(p->re, p->im) / p->sigma;
    if (!c->has_phase) {
        r[0] = relative * (p->re / sqrt(square) - 1.0);
        r[1] = 0.0;
        return;
    }
    r[0] = relative * ((p->re * re + p->im * im) / square - 1.0);
    r[1] = relative * (p->im * re - p->re * im) / square;
}

/* The first curve, whose drive is the smallest, and those of other outputs at this drive. */
static int smallest_curves(const struct curves *d)
{
    int n = d->n > 0;
    while (n && n < d->n && d->curve[n].input == d->curve[0].input &&
           d->curve[n].output != d->curve[0].output &&
           d->curve[n].amplitude <= one_drive * d->curve[0].amplitude)
        n++;
    return n;
}

int problem_curves(const struct problem *p)
{
    if (p->form == PROBLEM_LINEAR)
        return smallest_curves(&p->s->data);
    return p->form == PROBLEM_RECORDS ? 0 : p->s->n_active;
}

double problem_curves_residuals(const struct problem *p, const double *u, double *r)
{
    double cost = 0.0;
    for (int c = 0; c < problem_curves(p); c++) {
        const struct curve *curve = &p->s->data.curve[c];
        struct orbit_task t;
        if (!unknown_task(p->s, c, u, &t) || (p->form != PROBLEM_LINEAR && !follow(p->s, c, u)))
            return HUGE_VAL;
        for (int i = 0; i < curve->n; i++, r += 2) {
            double re, im, weight = 1.0;
            if (!respond(p, &t, u, c, i, &re, &im))
                return HUGE_VAL;
            if (p->form == PROBLEM_LINEAR)
                compare_linear(curve, i, re, im, r);
            else
                compare(curve, i, re, im, r);
            if (p->form != PROBLEM_LINEAR && p->s->point[c][i].flank)
                weight = 0.0;
            else if (p->form == PROBLEM_ROBUST)
                weight = weigh(curve, i, r, re, im, &cost);
            else
                cost += r[0] * r[0] + r[1] * r[1];
            r[0] *= weight;
            r[1] *= weight;
        }
    }
    return cost;
}

/* The slope of a measured response over unknown k, at a motion. False: there is none. */
static bool slope(const struct fit_setup *s, const double *u, int c, int k, const struct orbit *o, double *re,
                  double *im)
{
    struct orbit_task task[2];
    double v[2][FIT_UNKNOWNS], chain[2][2];
    *re = *im = 0.0;
    for (int side = 0; side < 2; side++) {
        memcpy(v[side], u, (size_t)s->n * sizeof *u);
        v[side][k] += side ? nudge : -nudge;
        if (!unknown_task(s, c, v[side], &task[side]))
            return false;
        chain[side][0] = o->re;
        chain[side][1] = o->im;
        unknown_measure(s, v[side], o->frequency_Hz, &chain[side][0], &chain[side][1]);
    }
    bool of_plant = s->unknown[k].kind == FIT_PARAMETER || s->unknown[k].kind == FIT_GAIN_FORCE;
    if (of_plant && !orbit_slope(&task[0], &task[1], o, 2.0 * nudge, re, im))
        return false;
    unknown_measure(s, u, o->frequency_Hz, re, im);
    *re += (chain[1][0] - chain[0][0]) / (2.0 * nudge);
    *im += (chain[1][1] - chain[0][1]) / (2.0 * nudge);
    return true;
}

/* The slopes of a point's two residuals. */
static void slopes_of(const struct problem *p, const double *u, int c, int i, double *a)
{
    const struct fit_setup *s = p->s;
    const struct curve *curve = &s->data.curve[c];
    struct follow_point *at = &s->point[c][i].at;
    struct orbit_task t;
    double re, im, r[2], unused, weight = 1.0, sigma = curve->point[i].sigma;
    response_of(s, u, at, &re, &im);
    compare(curve, i, re, im, r);
    if (p->form == PROBLEM_ROBUST)
        weight = weigh(curve, i, r, re, im, &unused);
    if (s->point[c][i].flank)
        weight = 0.0;
    if (p->form == PROBLEM_PLAIN && unknown_task(s, c, u, &t))
        at->found = at->found && orbit_sharpen(&t, &at->orbit);
    for (int k = 0; k < s->n; k++) {
        double re_u, im_u, size = size_of(re, im);
        if (!at->found || !slope(s, u, c, k, &at->orbit, &re_u, &im_u))
            re_u = im_u = 0.0;
        if (!curve->has_phase) {
            re_u = size > 0.0 ? (re * re_u + im * im_u) / size : 0.0;
            im_u = 0.0;
        }
        a[k] = weight * re_u / sigma;
        a[s->n + k] = weight * im_u / sigma;
    }
}

void problem_curves_slopes(const struct problem *p, const double *u, double *a)
{
    for (int c = 0; c < problem_curves(p); c++)
        for (int i = 0; i < p->s->data.curve[c].n; i++, a += 2 * p->s->n)
            slopes_of(p, u, c, i, a);
}
