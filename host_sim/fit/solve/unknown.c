/* unknown.c - see unknown.h. */
#include "host_sim/fit/solve/unknown.h"

#include "firmware/plant/plant_change.h"
#include "models/math/elementary.h"

double unknown_value(const struct fit_unknown *k, double u)
{
    return k->kind >= FIT_DELAY ? u * k->unit_of_u : exponential(u);
}

double unknown_u(const struct fit_unknown *k, double value)
{
    return k->kind >= FIT_DELAY ? value / k->unit_of_u : logarithm(value);
}

bool unknown_task(const struct fit_setup *s, int c, const double *u, struct orbit_task *t)
{
    const struct curve *curve = &s->data.curve[c];
    int which;
    *t = s->task;
    t->input = curve->input;
    t->output = curve->output;
    t->derivatives = curve->derivatives;
    t->amplitude = curve->amplitude;
    for (int k = 0; k < s->n; k++) {
        if (s->unknown[k].kind == FIT_PARAMETER)
            t->si[s->unknown[k].index] = unknown_value(&s->unknown[k], u[k]);
        if (s->unknown[k].kind == FIT_GAIN_FORCE)
            t->amplitude *= unknown_value(&s->unknown[k], u[k]);
    }
    return !plant_check(t->model, t->si, &which);
}

void unknown_measure(const struct fit_setup *s, const double *u, double frequency_Hz, double *re, double *im)
{
    double gain = 1.0, delay = 0.0, cosine, sine;
    for (int k = 0; k < s->n; k++) {
        if (s->unknown[k].kind == FIT_GAIN_SENSOR)
            gain = unknown_value(&s->unknown[k], u[k]);
        if (s->unknown[k].kind == FIT_DELAY)
            delay = unknown_value(&s->unknown[k], u[k]);
    }
    cos_sin(-2.0 * ELEMENTARY_PI * frequency_Hz * delay, &cosine, &sine);
    double was = *re;
    *re = gain * (was * cosine - *im * sine);
    *im = gain * (was * sine + *im * cosine);
}
