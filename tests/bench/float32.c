/* float32.c - the loss of rk4_float32 against rk4: error over steps per period, and over the number of
 * periods.
 *
 * usage: float32 > OUT.csv. The error is the worst over the ends of drive periods, each state over its
 * largest deviation from rest; the reference is `taylor` at 1e-13, for the shaft `exact`. In the second
 * chart it is the worst over the last tenth of the periods so far. The naive loops show what breaks first
 * when all is float. Some 10 seconds. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/plant/plant.h"
#include "firmware/plant/plant_change.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"

#define TWO_PI 6.283185307179586477

enum {
    SETTINGS = 5,
    PERIODS = 300,
    STEPS_MAX = 16384,
    REFERENCE_STEPS = 48,
    LONG_STEPS = 128,
    LONG_PERIODS = 100000
};

/* One motion: a model with these of its paper's parameters, the others at their defaults. */
struct motion {
    const char *name;
    const struct model *model;
    const struct method *reference;
    int input, periods;
    struct {
        const char *name;
        double value;
    } set[SETTINGS];            /* up to the first without a name */
    double start[MODEL_STATES]; /* the paper's symbols */
};

static const struct motion motions[] = {
    {"rig kept", &hertz_rig, &taylor, RIG_FORCE, 160, {{"xi", 0.01}, {"sigma", 0.04}, {"omega", 8.0}}, {0.5}},
    {"rig lost", &hertz_rig, &taylor, RIG_FORCE, 20, {{"xi", 0.01}, {"sigma", 0.3}, {"omega", 0.9}}, {0.75}},
    {"tip kept",
     &afm_tip,
     &taylor,
     TIP_FORCE,
     100,
     {{"beta", 0.8}, {"sign", -1.0}, {"f", 0.05}, {"omega", 1.3}},
     {0.1}},
    {"shaft kept", &shaft_bearing, &exact, 1, 100, {{"p2", 2.0}, {"freq_hz", 25.0}}, {0.1 * 2.54e-4}},
    {"rig steady",
     &hertz_rig,
     &taylor,
     RIG_FORCE,
     300,
     {{"xi", 0.01}, {"sigma", 0.04}, {"omega", 0.9}},
     {0.0}},
};
enum { STEADY = sizeof motions / sizeof *motions - 1 };

/* A plant and its scratch memory. */
struct run {
    struct plant plant;
    double scratch[METHOD_SCRATCH];
};

/* False when the method refuses the step. */
static bool start(struct run *r, const struct motion *c, const struct method *method, int steps)
{
    double paper[MODEL_PARAMETERS], si[MODEL_PARAMETERS], x[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS];
    struct plant *pl = &r->plant;
    for (int i = 0; i < c->model->n_paper; i++) {
        paper[i] = c->model->paper[i].initial;
        for (int k = 0; k < SETTINGS && c->set[k].name; k++) {
            if (strcmp(c->set[k].name, c->model->paper[i].name) == 0)
                paper[i] = c->set[k].value;
        }
    }
    c->model->from_paper(paper, si, drive);
    const struct harmonic *d = &drive[c->input];
    struct plant_config config = {.model = c->model, .si = si, .method = method, .scratch = r->scratch};
    config.tick_s = TWO_PI / d->omega / steps;
    config.dilation = 1.0;
    config.tol = method == &taylor ? 1e-13 : 0.0;
    if (plant_init(pl, &config))
        return false;
    plant_drive_start(pl, c->input, d->amplitude, d->omega / TWO_PI, d->phase);
    c->model->state_from_paper(pl->p, pl->segment.at[2], c->start, x);
    plant_set_state(pl, x);
    return true;
}

static void one_period(struct run *r, int steps)
{
    if (!plant_run(&r->plant, (uint64_t)steps)) {
        fprintf(stderr, "float32: a state left the finite numbers\n");
        exit(1);
    }
}

/* ---- error against steps per period ---- */

static double states[PERIODS][MODEL_STATES], largest[MODEL_STATES]; /* from rest */

static void run_reference(const struct motion *c)
{
    static struct run r;
    int steps = REFERENCE_STEPS;
    while (!start(&r, c, c->reference, steps))
        steps *= 2;
    double rest[MODEL_STATES];
    c->model->rest(r.plant.p, rest);
    memset(largest, 0, sizeof largest);
    for (int k = 0; k < c->periods; k++) {
        one_period(&r, steps);
        memcpy(states[k], r.plant.x, sizeof states[k]);
        for (int i = 0; i < c->model->n_states; i++)
            largest[i] = fmax(largest[i], fabs(states[k][i] - rest[i]));
    }
}

static double error_of(const struct motion *c, const double *x, const double *reference)
{
    double worst = 0.0;
    for (int i = 0; i < c->model->n_states; i++)
        worst = fmax(worst, fabs(x[i] - reference[i]) / largest[i]);
    return worst;
}

/* 2^k and 3 * 2^k in turn. */
static int next_steps(int steps)
{
    return steps & (steps - 1) ? steps / 3 * 4 : steps / 2 * 3;
}

static void against_steps(const struct motion *c, const struct method *method)
{
    static struct run r;
    for (int steps = 16; steps <= STEPS_MAX; steps = next_steps(steps)) {
        double worst = 0.0;
        if (!start(&r, c, method, steps))
            continue;
        for (int k = 0; k < c->periods; k++) {
            one_period(&r, steps);
            worst = fmax(worst, error_of(c, r.plant.x, states[k]));
        }
        printf("steps,%s,%s,%d,%.3e\n", c->name, method->name, steps, worst);
    }
}

/* ---- peers: all in float ---- */

/* The steady rig as a user writes it in ten minutes for an FPU of single precision; x is eta. */
struct naive {
    float h, x, v, t;
    int steps;
    bool time_summed; /* in float; else the phase is right, and only the state is float */
};

static struct naive naive_start(int steps, bool time_summed)
{
    return (struct naive){(float)(TWO_PI / 0.9 / steps), 1.0f, 0.0f, 0.0f, steps, time_summed};
}

static float naive_force(const struct naive *n, int step, float part)
{
    if (n->time_summed)
        return 0.04f * cosf(0.9f * (n->t + part * n->h));
    return 0.04f * cosf((float)TWO_PI * (((float)step + part) / (float)n->steps));
}

static float naive_rate(float force, float x, float v)
{
    return 2.0f / 3.0f * (1.0f + force - powf(fmaxf(x, 0.0f), 1.5f)) - 0.02f * v;
}

static void naive_period(struct naive *n)
{
    float h = n->h;
    for (int i = 0; i < n->steps; i++) {
        float f0 = naive_force(n, i, 0.0f), f1 = naive_force(n, i, 0.5f), f2 = naive_force(n, i, 1.0f);
        float a1 = naive_rate(f0, n->x, n->v), v2 = n->v + 0.5f * h * a1;
        float a2 = naive_rate(f1, n->x + 0.5f * h * n->v, v2), v3 = n->v + 0.5f * h * a2;
        float a3 = naive_rate(f1, n->x + 0.5f * h * v2, v3), v4 = n->v + h * a3;
        float a4 = naive_rate(f2, n->x + h * v3, v4);
        n->x += h / 6.0f * (n->v + 2.0f * (v2 + v3) + v4);
        n->v += h / 6.0f * (a1 + 2.0f * (a2 + a3) + a4);
        n->t += h;
    }
}

static const char *const naive_name[2] = {"float state", "float state and time"};

static void naive_against_steps(const struct motion *c)
{
    for (int steps = 32; steps <= STEPS_MAX; steps = next_steps(steps)) {
        struct naive n = naive_start(steps, false);
        double worst = 0.0;
        for (int k = 0; k < c->periods; k++) {
            naive_period(&n);
            worst = fmax(worst, error_of(c, (double[]){(double)n.x, (double)n.v}, states[k]));
        }
        printf("steps,%s,%s,%d,%.3e\n", c->name, naive_name[0], steps, worst);
    }
}

/* ---- error against the number of periods ---- */

/* 1, 2, 3, ... 10, 15, 20, 30, ... */
static bool is_mark(int k)
{
    int decade = 1;
    while (k >= 10 * decade)
        decade *= 10;
    return k % decade == 0 || (decade > 1 && k == 3 * decade / 2);
}

/* The worst over the last tenth of the periods, at each mark. */
static void print_line(const struct motion *c, const char *name, const double *error)
{
    for (int k = 1; k <= LONG_PERIODS; k++) {
        double worst = 0.0;
        if (!is_mark(k))
            continue;
        for (int i = k - k / 10 - 1; i < k; i++)
            worst = fmax(worst, error[i]);
        printf("periods,%s,%s,%d,%.3e\n", c->name, name, k, worst);
    }
}

/* `largest` is that of the same motion in the first chart. */
static void against_periods(const struct motion *c)
{
    static const struct method *const method[2] = {&rk4, &rk4_float32};
    static struct run reference, ours[2];
    static double error[4][LONG_PERIODS];
    struct naive naive[2] = {naive_start(LONG_STEPS, false), naive_start(LONG_STEPS, true)};
    (void)start(&reference, c, c->reference, REFERENCE_STEPS);
    for (int i = 0; i < 2; i++)
        (void)start(&ours[i], c, method[i], LONG_STEPS);
    for (int k = 0; k < LONG_PERIODS; k++) {
        one_period(&reference, REFERENCE_STEPS);
        for (int i = 0; i < 2; i++) {
            one_period(&ours[i], LONG_STEPS);
            naive_period(&naive[i]);
            error[i][k] = error_of(c, ours[i].plant.x, reference.plant.x);
            error[2 + i][k] =
                error_of(c, (double[]){(double)naive[i].x, (double)naive[i].v}, reference.plant.x);
        }
    }
    for (int i = 0; i < 2; i++) {
        print_line(c, method[i]->name, error[i]);
        print_line(c, naive_name[i], error[2 + i]);
    }
}

int main(void)
{
    printf("chart,case,method,steps_or_periods,error\n");
    for (size_t i = 0; i < sizeof motions / sizeof *motions; i++) {
        run_reference(&motions[i]);
        against_steps(&motions[i], &rk4);
        against_steps(&motions[i], &rk4_float32);
    }
    naive_against_steps(&motions[STEADY]);
    against_periods(&motions[STEADY]);
    return 0;
}
