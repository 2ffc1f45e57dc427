/* tolerance_draw.c - random scenes; see tolerance_force.h. */
#include "tests/tolerance/tolerance_force.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/reduced/shaft_mode.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/draw.h"

enum { TICKS_MAX = 8000, FAST_PERIODS_MAX = 300 };

/* Damping from light to a fifth of critical; tips of either sign. */
static void draw_parameters(struct tolerance_scene *s)
{
    const struct model *m = s->model;
    double paper[MODEL_PARAMETERS];
    struct harmonic none[MODEL_INPUTS];
    for (int i = 0; i < m->n_paper; i++)
        paper[i] = m->paper[i].initial;
    m->from_paper(paper, s->si, none);
    if (m->n_inputs == 3 || m == &shaft_bearing_mode) {
        double factor = spread(0.1, 10.0);
        for (int i = SHAFT_C1; i <= SHAFT_C3; i++)
            s->si[i] *= factor;
        if (m == &shaft_bearing_mode)
            s->si[SHAFT_MODE] = 1.0 + floor(uniform(0.0, 3.0));
    } else if (strncmp(m->name, "afm_tip", 7) == 0) {
        bool attracts = chance(0.4);
        double beta = attracts ? uniform(0.1, 0.8) : spread(0.1, 20.0);
        s->si[TIP_CONTACT_STIFFNESS] = beta / 1.5;
        s->si[TIP_SIGN] = attracts ? 1.0 : -1.0;
        s->si[TIP_DAMPING] = spread(0.005, 0.4);
    } else {
        s->si[RIG_DAMPING] = 3.0 * spread(0.0025, 0.2);
    }
    m->prepare(s->si, s->p, &s->scale);
    s->eigenfrequency = m->eigenfrequency(s->p);
}

/* Cubics and attracting contacts let go of larger motions. */
static double size_max(const struct tolerance_scene *s)
{
    const char *name = s->model->name;
    if (strstr(name, "cubic") || strstr(name, "averaged"))
        return strstr(name, "afm_tip") && s->si[TIP_SIGN] > 0.0 ? 0.03 : 0.2;
    return s->model == &afm_tip && s->si[TIP_SIGN] > 0.0 ? 0.03 : 100.0;
}

/* Half of them near the longest steps with which auto takes rk4. */
static void draw_tick(struct tolerance_scene *s)
{
    double angle = s->forces     ? spread(0.004, 0.04)
                   : chance(0.5) ? pow(s->tol, 0.4) * spread(0.2, 1.2)
                                 : spread(0.002, 1.0);
    s->tick = fmax(angle, 0.001) / s->eigenfrequency;
}

/* Input i, or the first, a force in every model, where nothing else may sound. */
static int allowed(const struct tolerance_scene *s, int i)
{
    return s->forces && s->model->input_signal[i].quantity != QUANTITY_FORCE ? 0 : i;
}

/* A drive whose response by linear theory is this large. */
static void draw_drive(struct tolerance_scene *s, int i, double size)
{
    struct tolerance_drive *d = &s->drive[i];
    double ticks = spread(4.0, 1000.0), w = s->eigenfrequency;
    enum quantity q = s->model->input_signal[i].quantity;
    d->omega = 2.0 * 3.14159265358979 / (ticks * s->tick);
    double ratio = d->omega / w;
    d->amplitude = size * fmax(fabs(1.0 - ratio * ratio), 0.1) * (q == QUANTITY_LENGTH ? 1.0 : w * w);
    if (q == QUANTITY_RATIO)
        d->amplitude = fmin(d->amplitude, 0.9);
    d->phase = uniform(-3.0, 3.0);
    if (chance(0.3))
        d->ramp = s->tick * floor(spread(1.0, 400.0));
}

static void draw_drives(struct tolerance_scene *s)
{
    int n = s->model->n_inputs, first = (int)uniform(0.0, n), more = (int)uniform(0.0, n);
    for (int k = 0; k <= more; k++)
        draw_drive(s, allowed(s, (first + k) % n), k == 0 ? s->size : s->size * spread(0.003, 1.0));
}

/* How long: natural periods, as many as ticks and periods of the drives allow. */
static void draw_length(struct tolerance_scene *s)
{
    double time = uniform(4.0, 20.0) * 2.0 * 3.14159265358979 / s->eigenfrequency;
    for (int i = 0; i < s->model->n_inputs; i++)
        if (s->drive[i].amplitude != 0.0)
            time = fmin(time, FAST_PERIODS_MAX * 2.0 * 3.14159265358979 / s->drive[i].omega);
    long each = (long)(fmin(time / s->tick, TICKS_MAX) / TOLERANCE_SAMPLES);
    s->ticks = (each > 0 ? each : 1) * TOLERANCE_SAMPLES;
}

/* Levers have a method of their own, and its errors are judged in tests/physics/afm. */
int tolerance_model(int number)
{
    int candidate[MODELS], n = 0;
    for (int i = 0; i < MODELS; i++)
        if (!model_table[i]->modal_form)
            candidate[n++] = i;
    return candidate[number % n];
}

void tolerance_draw(struct tolerance_scene *s, int number, unsigned seed, bool loose)
{
    *s = (struct tolerance_scene){.model = model_table[tolerance_model(number)]};
    state = ((uint64_t)seed << 32 | (uint64_t)number) * 0x9E3779B97F4A7C15u;
    state ^= state >> 29;
    draw_parameters(s);
    s->size = spread(1e-6, size_max(s));
    s->tol = loose ? spread(1e-4, 1e-2) : spread(1e-8, 1e-3);
    s->tol = fmax(s->tol, 1e-13 / s->size); /* below, the rounding of the state decides */
    s->forces = loose && chance(0.5);
    draw_tick(s);
    draw_drives(s);
    draw_length(s);
    if (chance(0.3)) {
        int i = allowed(s, (int)uniform(0.0, s->model->n_inputs));
        s->change = s->ticks / TOLERANCE_SAMPLES * (long)uniform(1.0, TOLERANCE_SAMPLES);
        if (s->drive[i].amplitude == 0.0)
            draw_drive(s, i, s->size * spread(0.003, 1.0));
        s->drive[i].start = (double)s->change * s->tick;
        s->drive[i].ramp =
            fmax(s->drive[i].ramp, s->tick); /* a drive that is told later takes a tick at least */
    }
    s->model->rest(s->p, s->x);
    if (chance(0.5)) {
        int half = s->model->n_states / 2;
        for (int k = 0; k < half; k++) {
            s->x[k] += s->size * uniform(-1.0, 1.0);
            s->x[half + k] += s->size * s->eigenfrequency * uniform(-1.0, 1.0);
        }
    }
}
