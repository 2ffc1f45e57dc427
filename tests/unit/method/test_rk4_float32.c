/* test_rk4_float32.c - one step against rk4's for every model, what is refused, what is located.
 *
 * rk4 in double is checked by itself against references; its step at the same length has the same truncation
 * error, so that the difference is float rounding alone. */
#include "tests/unit/test.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/method/float32/rk4_float32.h"
#include "firmware/method/float32/rk4_float32_forms.h"
#include "models/hertz_rig.h"
#include "models/models.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"

static double scratch[METHOD_SCRATCH];

static void default_numbers(const struct model *m, double *p)
{
    double si[MODEL_PARAMETERS];
    struct scale scale;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = m->parameter[i].initial;
    m->prepare(si, p, &scale);
}

/* A state within `size` of rest, all inputs at work. */
static void draw(const struct model *m, const double *p, double size, uint64_t *seed, struct segment *e,
                 double *x)
{
    memset(e, 0, sizeof *e);
    m->rest(p, x);
    for (int i = 0; i < m->n_states; i++)
        x[i] += size * (2.0 * exact_uniform(seed) - 1.0);
    e->active = (1u << m->n_inputs) - 1u;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < m->n_inputs; i++)
            e->at[k][i] = (struct input){0.4 * size * (2.0 * exact_uniform(seed) - 1.0),
                                         0.4 * size * (2.0 * exact_uniform(seed) - 1.0)};
}

/* The largest acceleration at the two ends, and the largest velocity. */
static double pace(const struct model *m, const double *p, const struct segment *e, const double *x,
                   const double *x1)
{
    double d[2][MODEL_STATES], largest = 0.0;
    m->rhs(p, e->at[0], x, d[0]);
    m->rhs(p, e->at[2], x1, d[1]);
    for (int i = 0; i < m->n_states; i++)
        largest = fmax(largest, fmax(fabs(d[0][i]), fabs(d[1][i])));
    return largest;
}

/* Increments that differ from rk4's by more than rounding
 * of the largest rate: the worst, in units of FLT_EPSILON. */
static double worst_step(const struct model *m, const double *p, double size)
{
    step_function *single = rk4_float32.bind(m), *twice = rk4.bind(m);
    double worst = 0.0, omega = m->eigenfrequency(p);
    uint64_t seed = 7;
    for (int i = 0; i < 5000; i++) {
        struct segment e;
        struct crossing c;
        double x[MODEL_STATES], y[MODEL_STATES], start[MODEL_STATES];
        double h = (0.001 + 0.199 * exact_uniform(&seed)) / omega;
        rk4_float32.prepare(m, p, i % 2 ? h : 1.0, 0.0, scratch); /* a whole tick, or part of one */
        draw(m, p, size, &seed, &e, x);
        e.length = h;
        memcpy(y, x, sizeof y);
        memcpy(start, x, sizeof start);
        if (single(m, p, scratch, &e, REGIME_ANY, x, &c) != STEP_END ||
            twice(m, p, NULL, &e, REGIME_ANY, y, &c) != STEP_END)
            return (double)NAN;
        double rate = pace(m, p, &e, start, y) + size * omega * omega;
        for (int k = 0; k < m->n_states; k++)
            worst = fmax(worst, fabs(x[k] - y[k]) / (h * rate * (double)FLT_EPSILON));
    }
    return worst;
}

/* A small deviation counts as much as a large one: what float rounds is the motion, not the position. */
TEST(rk4_float32_step)
{
    double p[MODEL_DERIVED];
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        default_numbers(m, p);
        if (rk4_float32_refuse_model(m, p))
            continue;
        for (double size = 1e-4; size < 10.0; size *= 100.0) {
            check_below(
                check_name("%s: increments against rk4, deviation %g, in float roundings", m->name, size),
                worst_step(m, p, size), 4.0);
        }
    }
}

/* ---- a contact on the other side ---- */

/* The rig seen from the other side: x = 0.3 - y. */
static void mirror_rhs(const double *p, const struct input *u, const double *x, double *x_dot)
{
    hertz_rig_rhs(p, u, (double[]){0.3 - x[0], -x[1]}, x_dot);
    x_dot[0] = x[1];
    x_dot[1] = -x_dot[1];
}

static void mirror_gap(const double *p, const struct input *u, const double *x, struct input *gap)
{
    hertz_rig_gap(p, u, (double[]){0.3 - x[0], -x[1]}, gap);
}

static void mirror_rest(const double *p, double *x)
{
    (void)p;
    x[0] = -0.7;
    x[1] = 0.0;
}

static void mirror_form(const double *p, struct hertz_form *f)
{
    hertz_rig.hertz_form(p, f);
    f->side = -1.0;
    f->origin = 0.3;
}

static void check_mirrored_steps(const struct model *mirror, const double *p)
{
    struct crossing c, d;
    double x[2], y[2];
    uint64_t seed = 11;
    int switches = 0, differ = 0;
    double instant = 0.0;
    rk4_float32.prepare(mirror, p, 0.1, 0.0, scratch);
    for (int i = 0; i < 5000; i++) {
        struct segment e;
        struct input gap;
        draw(mirror, p, 2.0, &seed, &e, x);
        e.active = 0; /* no input: nothing that a shortened step would have to follow */
        memset(e.at, 0, sizeof e.at);
        e.length = 0.1;
        memcpy(y, x, sizeof y);
        mirror->gap(p, e.at[0], x, &gap);
        unsigned regime = gap.value < 0.0;
        enum step_status single = rk4_float32.bind(mirror)(mirror, p, scratch, &e, regime, x, &c);
        enum step_status twice = rk4.bind(mirror)(mirror, p, NULL, &e, regime, y, &d);
        differ += single != twice;
        if (single != STEP_SWITCH || twice != STEP_SWITCH)
            continue;
        mirror->gap(p, e.at[0], x, &gap);
        switches++;
        instant = fmax(instant, fabs(c.done - d.done) * fabs(gap.rate));
    }
    check_above("switches located", switches, 100);
    check_int("steps that end otherwise than with rk4", differ, 0);
    check_below("how far the gap is from closed at an instant that is off", instant, 1e-7);
}

TEST(rk4_float32_mirrored)
{
    struct model mirror = hertz_rig;
    double p[MODEL_DERIVED];
    mirror.rhs = mirror_rhs;
    mirror.gap = mirror_gap;
    mirror.rest = mirror_rest;
    mirror.hertz_form = mirror_form;
    default_numbers(&mirror, p);
    check_below("increments against rk4, in float roundings", worst_step(&mirror, p, 1.0), 4.0);
    check_mirrored_steps(&mirror, p);
}

/* ---- edges ---- */

TEST(rk4_float32_zero_step)
{
    double p[MODEL_DERIVED], x[MODEL_STATES], y[MODEL_STATES];
    uint64_t seed = 3;
    struct segment e;
    struct crossing c;
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        default_numbers(m, p);
        if (rk4_float32_refuse_model(m, p))
            continue;
        rk4_float32.prepare(m, p, 0.1, 0.0, scratch);
        draw(m, p, 0.3, &seed, &e, x);
        memcpy(y, x, sizeof y);
        int status = (int)rk4_float32.bind(m)(m, p, scratch, &e, REGIME_ANY, x, &c);
        check_int(m->name, status, STEP_END);
        check_bytes(m->name, x, y, (size_t)m->n_states * sizeof *x);
    }
}

/* A value that no float holds is not finite, and a state that is no number is refused. */
TEST(rk4_float32_not_finite)
{
    double p[MODEL_DERIVED];
    struct segment e;
    struct crossing c;
    memset(&e, 0, sizeof e);
    e.length = 0.1;
    for (int i = 0; i < MODELS; i++) {
        const struct model *m = model_table[i];
        double x[MODEL_STATES] = {0.0};
        default_numbers(m, p);
        if (rk4_float32_refuse_model(m, p))
            continue;
        rk4_float32.prepare(m, p, 0.1, 0.0, scratch);
        x[0] = 1e39;
        check_int(m->name, rk4_float32.bind(m)(m, p, scratch, &e, 0, x, &c), STEP_NOT_FINITE);
        x[0] = (double)NAN;
        check_int(m->name, rk4_float32.bind(m)(m, p, scratch, &e, 0, x, &c), STEP_NOT_FINITE);
    }
}

static void gap_of_two(const double *p, const struct input *u, const double *x, struct input *gap)
{
    shaft_bearing_gap(p, u, x, gap);
    gap[1].value -= x[1];
    gap[1].rate -= x[4];
}

static void gap_of_an_input(const double *p, const struct input *u, const double *x, struct input *gap)
{
    shaft_bearing_gap(p, u, x, gap);
    gap[2].value -= u[0].value;
    gap[2].rate -= u[0].rate;
}

static void check_refusal(const char *what, const struct model *m, double h, double tol, const char *part)
{
    double p[MODEL_DERIVED];
    default_numbers(m, p);
    const char *why = rk4_float32.refuse(m, p, h, tol);
    if (part[0] == '\0')
        check_string(what, why ? why : "", "");
    else
        check_contains(what, why, part);
}

TEST(rk4_float32_refusals)
{
    struct model odd = hertz_rig, two = shaft_bearing, moved = shaft_bearing;
    odd.hertz_form = NULL;
    two.gap = gap_of_two;
    moved.gap = gap_of_an_input;
    check_refusal("a sound step is taken", &hertz_rig, 0.1, 0.0, "");
    check_refusal("a tolerance it can keep on smooth motion", &hertz_rig, 0.1, 1e-5, "");
    check_refusal("a tolerance below float", &hertz_rig, 0.1, 9e-6, "tolerance below 1e-5");
    check_refusal("a tolerance that is no number", &hertz_rig, 0.1, (double)NAN, "tolerance below 1e-5");
    check_refusal("just finer than rk4's guard", &hertz_rig, 0.1999, 0.0, "");
    check_refusal("just coarser than rk4's guard", &hertz_rig, 0.2001, 0.0, "step too coarse");
    check_refusal("just coarser than the float of a step", &hertz_rig, 1.2e-7, 0.0, "");
    check_refusal("just finer", &hertz_rig, 1.19e-7, 0.0, "step too fine");
    check_refusal("a step that is no number", &hertz_rig, (double)NAN, 0.0, "step too");
    check_refusal("a model without a form", &odd, 0.1, 0.0, "no form for this model");
    check_refusal("a gap between two positions", &two, 0.01, 0.0, "follow one position");
    check_refusal("a gap that an input moves", &moved, 0.01, 0.0, "follow one position");
}
