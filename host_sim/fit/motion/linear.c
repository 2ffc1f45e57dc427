/* linear.c - see linear.h. x' = A x + b u + d u' about rest, and y = c x + e u: A, b, c, d, e by central
 * differences. Then y = (c (i omega - A)^-1 (b + i omega d) + e) u. */
#include "host_sim/fit/motion/linear.h"

#include <math.h>
#include "host_sim/fit/solve/matrix.h"
#include "models/math/elementary.h"

static const double nudge = 1e-5;

struct linearised {
    int n;
    double a[ORBIT_STATES][ORBIT_STATES], b[ORBIT_STATES], d[ORBIT_STATES], c[ORBIT_STATES], e;
};

/* Half the difference of rates and output by +nudge and -nudge of *place. */
static void differ(const struct orbit_task *t, const double *p, const struct input *u, const double *x,
                   double *place, double *rate, double *output)
{
    double there[2][MODEL_STATES], seen[2][MODEL_OUTPUTS], at = *place;
    for (int side = 0; side < 2; side++) {
        *place = at + (side ? nudge : -nudge);
        t->model->rhs(p, u, x, there[side]);
        t->model->output(p, u, x, seen[side]);
    }
    *place = at;
    for (int i = 0; i < t->model->n_states; i++)
        rate[i] = (there[1][i] - there[0][i]) / (2.0 * nudge);
    *output = (seen[1][t->output] - seen[0][t->output]) / (2.0 * nudge);
}

static void linearise(const struct orbit_task *t, const double *p, struct linearised *l)
{
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    double x[MODEL_STATES], rate[MODEL_STATES], unused;
    t->model->rest(p, x);
    l->n = t->model->n_states;
    for (int k = 0; k < l->n; k++) {
        differ(t, p, u, x, &x[k], rate, &l->c[k]);
        for (int i = 0; i < l->n; i++)
            l->a[i][k] = rate[i];
    }
    differ(t, p, u, x, &u[t->input].value, l->b, &l->e);
    differ(t, p, u, x, &u[t->input].rate, l->d, &unused);
}

/* The response in model units, for an input of 1: unknowns are the real parts of x, then the imaginary ones.
 */
static bool respond(const struct linearised *l, double omega, double *re, double *im)
{
    double m[MATRIX_MAX][MATRIX_MAX], x[MATRIX_MAX];
    for (int i = 0; i < l->n; i++) {
        for (int k = 0; k < l->n; k++) {
            m[i][k] = m[l->n + i][l->n + k] = -l->a[i][k];
            m[i][l->n + k] = i == k ? -omega : 0.0;
            m[l->n + i][k] = i == k ? omega : 0.0;
        }
        x[i] = l->b[i];
        x[l->n + i] = omega * l->d[i];
    }
    if (!matrix_solve(2 * l->n, m, x))
        return false;
    *re = l->e;
    *im = 0.0;
    for (int i = 0; i < l->n; i++) {
        *re += l->c[i] * x[i];
        *im += l->c[i] * x[l->n + i];
    }
    return true;
}

bool linear_response(const struct orbit_task *t, double frequency_Hz, double *re, double *im)
{
    double p[MODEL_DERIVED], omega = 2.0 * ELEMENTARY_PI * frequency_Hz;
    struct scale scale;
    struct linearised l;
    t->model->prepare(t->si, p, &scale);
    linearise(t, p, &l);
    if (!respond(&l, omega * scale.time_s, re, im))
        return false;
    /* plant_output gives SI; the model's own outputs are in its units */
    double unit = scale_of(&scale, t->model->output_signal[t->output].quantity) * t->amplitude /
                  scale_of(&scale, t->model->input_signal[t->input].quantity);
    *re *= unit;
    *im *= unit;
    orbit_differentiate(t->derivatives, omega, re, im);
    return isfinite(*re) && isfinite(*im);
}

bool linear_ring(const struct orbit_task *t, double *frequency_Hz, double *decay_per_s)
{
    double p[MODEL_DERIVED];
    struct scale scale;
    struct linearised l;
    t->model->prepare(t->si, p, &scale);
    if (t->model->n_states != 2)
        return false;
    linearise(t, p, &l);
    double decay = -0.5 * (l.a[0][0] + l.a[1][1]), square = l.a[0][0] * l.a[1][1] - l.a[0][1] * l.a[1][0];
    if (!(square > decay * decay) || !(decay > 0.0))
        return false;
    *frequency_Hz = sqrt(square - decay * decay) / (2.0 * ELEMENTARY_PI * scale.time_s);
    *decay_per_s = decay / scale.time_s;
    return true;
}
