/* test_batch.c - batch_taylor against the stored reference trajectories; what it refuses. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/batch/batch_taylor_set.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/batch.h"
#include "tests/fixture/rig.h"
#include "tests/fixture/trajectory.h"

#define TWO_PI 6.283185307179586477

/* ---- stored trajectories ---- */

static double column_max(const struct trajectory *r, int k)
{
    double m = fabs(r->start[k]);
    for (int i = 0; i < r->n_samples; i++)
        m = fmax(m, fabs(r->state[i][k]));
    return m;
}

static int liftoffs_of(const struct trajectory *r)
{
    int n = 0;
    for (int i = 0; i < r->n_events[0]; i++)
        n += !r->event_touch[0][i];
    return n;
}

static void check_case(const struct trajectory *r)
{
    struct batch_taylor b;
    struct batch_one o;
    double samples[2 * TRAJECTORY_SAMPLES], worst = 0.0, growth = fmax(r->growth, 1.0);
    if (!r->model->hertz_form)
        return;
    void *memory = batch_make(&b, 1);
    batch_of_paper(&o, r->model, r->paper, r->start, r->t[r->n_samples - 1] / r->n_samples);
    batch_put(&b, 0, &o);
    batch_ran(batch_taylor(&b, 1e-12, r->n_samples, samples));
    for (int i = 0; i < r->n_samples; i++) {
        struct input u[MODEL_INPUTS];
        double x[2], x_dot[2], state[2], time = o.t.interval * (i + 1);
        batch_taylor_state(&o.t, time, samples[2 * i], samples[2 * i + 1], x);
        /* The file's instants are rounded: along the tangent. */
        batch_inputs(&o.t, time, u);
        r->model->rhs(o.p, u, x, x_dot);
        batch_inputs(&o.t, r->t[i], u);
        for (int k = 0; k < 2; k++)
            x[k] += (r->t[i] - time) * x_dot[k];
        r->model->paper_state(o.p, u, x, state);
        for (int k = 0; k < 2; k++)
            worst = fmax(worst, fabs(state[k] - r->state[i][k]) / column_max(r, k));
    }
    check_below(check_name("%s: worst state error over its column's maximum", r->name), worst,
                growth * 1e-11);
    if (r->n_events_total >= 0 &&
        !strstr(r->name, "graze")) /* a touch without speed is there or not by rounding */
        check_int("lift-offs", b.liftoffs[0], liftoffs_of(r));
    check_int("residuals, status", b.residuals[0] + b.status[0], 0);
    free(memory);
}

/* Multi-precision results made without this code, trusted to 1e-15. */
TEST(batch_reference)
{
    trajectory_all(check_case);
}

/* ---- small motions ---- */

/* z'' = -w^2 z - d z' + a cos(omega t) from z(0), z'(0): the closed form. */
static void linear(double w, double d, double a, double omega, const double *z0, double t, double *z)
{
    double real = w * w - omega * omega, imaginary = d * omega, n = real * real + imaginary * imaginary;
    double p = a * real / n, q = a * imaginary / n; /* p cos + q sin */
    double own = sqrt(w * w - 0.25 * d * d), c = z0[0] - p, s = (z0[1] - q * omega + 0.5 * d * c) / own;
    double fade = exp(-0.5 * d * t), C = cos(own * t), S = sin(own * t);
    z[0] = fade * (c * C + s * S) + p * cos(omega * t) + q * sin(omega * t);
    z[1] = fade * ((s * own - 0.5 * d * c) * C - (c * own + 0.5 * d * s) * S) +
           omega * (q * cos(omega * t) - p * sin(omega * t));
}

/* So small that the contact is linear. The worst errors
 * of position and rate over their largest, at 40 samples. */
static double small_error(const struct model *m, double size, double omega, double tol)
{
    enum { SAMPLES = 40 };
    struct batch_taylor b;
    struct batch_one o;
    double paper[MODEL_PARAMETERS], start[2] = {0.3 * size, -0.2 * size}, samples[2 * SAMPLES], x[2];
    double most[2] = {0.0, 0.0}, off[2] = {0.0, 0.0};
    for (int i = 0; i < m->n_paper; i++)
        paper[i] = m->paper[i].initial;
    void *memory = batch_make(&b, 1);
    batch_of_paper(&o, m, paper, start, 1.7);
    struct hertz_form f;
    m->hertz_form(o.p, &f);
    m->rest(o.p, x);
    o.t.drive[0] = (struct harmonic){size, omega, 0.0};
    o.t.x[0] = x[0] + start[0];
    o.t.x[1] = start[1];
    batch_put(&b, 0, &o);
    batch_ran(batch_taylor(&b, tol, SAMPLES, samples));
    double w = sqrt(f.stiffness + 1.5 * f.hertz);
    for (int i = 0; i < SAMPLES; i++) {
        double z[2];
        linear(w, f.damping, f.force[0] * size, omega, start, 1.7 * (i + 1), z);
        batch_taylor_state(&o.t, 1.7 * (i + 1), samples[2 * i], samples[2 * i + 1], x);
        const double got[2] = {x[0] - 1.0, x[1]};
        for (int k = 0; k < 2; k++) {
            most[k] = fmax(most[k], fabs(z[k]));
            off[k] = fmax(off[k], fabs(got[k] - z[k]));
        }
    }
    free(memory);
    return fmax(off[0] / most[0], off[1] / most[1]);
}

/* The tolerance is about the error of each series, and some hundred add up until the damping forgets them. */
TEST(batch_small)
{
    static const double omega[] = {0.05, 0.7, 6.0, 40.0}, tol[] = {1e-3, 1e-5};
    const struct model *const model[] = {&hertz_rig, &rolling_contact, &afm_tip};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++)
            for (int j = 0; j < 2; j++)
                check_below(model[i]->name, small_error(model[i], 1e-8, omega[k], tol[j]) / tol[j], 4.0);
}

/* ---- refusals ---- */

static void refused(const char *what, const char *why)
{
    check_error(check_name("%s: %s", what, why ? why : "not refused"), why);
}

TEST(batch_refusals)
{
    struct batch_taylor b;
    struct batch_one o;
    double paper[PAPER], state[2] = {0.0, 0.0};
    void *memory = batch_make(&b, 1), *before = malloc(batch_taylor_bytes(1));
    if (!before)
        abort();
    rig_paper(paper);
    paper[SIGMA] = 0.1;
    batch_of_paper(&o, &hertz_rig, paper, state, TWO_PI);
    batch_put(&b, 0, &o);
    memcpy(before, memory, batch_taylor_bytes(1));
    refused("negative intervals", batch_taylor(&b, 1e-6, -1, NULL));
    refused("tolerance 0", batch_taylor(&b, 0.0, 1, NULL));
    o.t.interval = 0.0;
    refused("interval 0", batch_taylor_set(&b, 0, &o.t));
    o.t.interval = 1.0;
    o.t.drive[RIG_FAST_FORCE] = (struct harmonic){1.0, 8.0, 0.0};
    o.t.drive[RIG_BASE] = (struct harmonic){1.0, 9.0, 0.0};
    refused("three frequencies", batch_taylor_set(&b, 0, &o.t));
    o.t.drive[RIG_BASE].omega = (double)NAN;
    refused("a frequency that is no number", batch_taylor_set(&b, 0, &o.t));
    o.t.model = &shaft_bearing;
    refused("a shaft", batch_taylor_set(&b, 0, &o.t));
    check_int("and nothing has changed", memcmp(before, memory, batch_taylor_bytes(1)), 0);
    free(before);
    free(memory);
}
