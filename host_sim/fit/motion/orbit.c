/* orbit.c - see orbit.h. */
#include "host_sim/fit/motion/orbit.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/cli/clock.h"
#include "host_sim/fit/solve/matrix.h"
#include "models/math/elementary.h"

enum {
    NEWTON_STEPS = 10,
    CONTACT_TICKS = 2, /* in a period of the contact, for the output: its tone stays apart from the drive's */
    FINE = 4,          /* so many times that for a method whose error depends on its step */
    TICKS_MOST = 4096
};
static const double nudge = 1e-4; /* share of a unit, for slopes over the state */
static const double nudge_rough = 1e-6;
static const double closed = 1e-9;   /* an orbit that misses its begin by this share of its size is closed */
static const double near = 1e-3;     /* so near to an orbit its map is known well enough */
static const double diverges = 10.0; /* a miss that grows by this over the smallest: there is no orbit near */
static const double floor_of = 1e-13;

/* A plant at one frequency. */
struct period {
    struct plant pl;
    int ticks;
    double cosine[TICKS_MOST + 1], sine[TICKS_MOST + 1]; /* phasor of the drive at tick 1 to ticks */
};

bool orbit_stopped(const struct orbit_task *t)
{
    return !t->to_the_end && clock_interrupted();
}

const char *orbit_contact(const struct orbit_task *t, double *contact_Hz)
{
    double p[MODEL_DERIVED];
    struct scale scale;
    int which;
    const char *why = plant_check(t->model, t->si, &which);
    if (why)
        return why;
    t->model->prepare(t->si, p, &scale);
    *contact_Hz = t->model->eigenfrequency(p) / (2.0 * ELEMENTARY_PI * scale.time_s);
    return NULL;
}

const char *orbit_plant(const struct orbit_task *t, double tick_s, struct plant *pl)
{
    const struct plant_config c = {.model = t->model,
                                   .si = t->si,
                                   .method = t->method,
                                   .tick_s = tick_s,
                                   .dilation = 1.0,
                                   .tol = t->tol,
                                   .no_ledger = true,
                                   .scratch = t->scratch};
    return plant_init(pl, &c);
}

/* The ticks of a period, and their phases. NULL, or why there is no such plant. */
static const char *set_up_ticks(const struct orbit_task *t, double frequency_Hz, double ticks,
                                struct period *q)
{
    if (!(ticks <= TICKS_MOST))
        return "the drive is too slow beside the contact";
    q->ticks = (int)ceil(ticks);
    const char *why = orbit_plant(t, 1.0 / (frequency_Hz * q->ticks), &q->pl);
    for (int i = 1; !why && i <= q->ticks; i++)
        cos_sin_turns(turns_of((double)i / q->ticks), &q->cosine[i], &q->sine[i]);
    return why;
}

static const char *set_up(const struct orbit_task *t, double frequency_Hz, struct period *q)
{
    double contact_Hz;
    const char *why = orbit_contact(t, &contact_Hz);
    if (why)
        return why;
    double contact = contact_Hz / frequency_Hz;
    bool coarse = t->method->order == 0;
    why = coarse ? set_up_ticks(t, frequency_Hz, fmax(ORBIT_TICKS, CONTACT_TICKS * contact), q) : "fine";
    return why ? set_up_ticks(t, frequency_Hz, FINE * fmax(ORBIT_TICKS, CONTACT_TICKS * contact), q) : NULL;
}

const char *orbit_refused(const struct orbit_task *t, double frequency_Hz)
{
    struct period q;
    return set_up(t, frequency_Hz, &q);
}

void orbit_rest(const struct orbit_task *t, double *x, double *unit)
{
    double p[MODEL_DERIVED], rest[MODEL_STATES];
    struct scale scale;
    t->model->prepare(t->si, p, &scale);
    t->model->rest(p, rest);
    for (int i = 0; i < t->model->n_states; i++) {
        unit[i] = scale_of(&scale, t->model->state_signal[i].quantity);
        x[i] = rest[i] * unit[i];
    }
}

static void begin(const struct orbit_task *t, struct plant *pl, double frequency_Hz, const double *x)
{
    double own[MODEL_STATES];
    for (int i = 0; i < t->model->n_states; i++)
        own[i] = x[i] / scale_of(&pl->scale, t->model->state_signal[i].quantity);
    plant_drive_start(pl, t->input, t->amplitude, frequency_Hz, 0.0);
    plant_set_state(pl, own);
}

static void end(const struct orbit_task *t, const struct plant *pl, double *x)
{
    for (int i = 0; i < t->model->n_states; i++)
        x[i] = pl->x[i] * scale_of(&pl->scale, t->model->state_signal[i].quantity);
}

void orbit_differentiate(int n, double omega, double *re, double *im)
{
    for (int i = 0; i < n; i++) {
        double was = *re;
        *re = -omega * *im;
        *im = omega * was;
    }
}

/* One period of a plant that is set up, and the response in it. */
static bool run(struct orbit_task *t, struct period *q, struct orbit *o, const double *x, double *to)
{
    double output[MODEL_OUTPUTS];
    if (orbit_stopped(t))
        return false;
    begin(t, &q->pl, o->frequency_Hz, x);
    o->re = o->im = 0.0;
    t->periods++;
    for (int k = 1; k <= q->ticks; k++) {
        if (!plant_run(&q->pl, 1))
            return false;
        plant_output(&q->pl, output);
        o->re += 2.0 / q->ticks * output[t->output] * q->cosine[k];
        o->im -= 2.0 / q->ticks * output[t->output] * q->sine[k];
    }
    orbit_differentiate(t->derivatives, 2.0 * ELEMENTARY_PI * o->frequency_Hz, &o->re, &o->im);
    end(t, &q->pl, to);
    return true;
}

bool orbit_settle(struct orbit_task *t, struct orbit *o, int periods)
{
    struct period q;
    if (orbit_stopped(t) || set_up(t, o->frequency_Hz, &q))
        return false;
    begin(t, &q.pl, o->frequency_Hz, o->x);
    t->periods += (uint64_t)periods;
    if (!plant_run(&q.pl, (uint64_t)q.ticks * (uint64_t)periods))
        return false;
    end(t, &q.pl, o->x);
    return true;
}

/* Column k of the map and of the slopes of the response: from the run to `to` and one begun beside it, `step`
 * away. */
static bool find_column(struct orbit_task *t, struct period *q, struct orbit *o, const struct orbit *from,
                        const double *to, int k, double step)
{
    struct orbit other = *from;
    double there[MODEL_STATES];
    other.x[k] += step;
    if (!run(t, q, &other, other.x, there))
        return false;
    for (int i = 0; i < t->model->n_states; i++)
        o->map[i][k] = (there[i] - to[i]) / step;
    o->re_x[k] = (other.re - from->re) / step;
    o->im_x[k] = (other.im - from->im) / step;
    return true;
}

/* All columns by one run each, beside the run from o->x to `to`. */
static bool find_map(struct orbit_task *t, struct period *q, struct orbit *o, const double *to,
                     const double *unit)
{
    for (int k = 0; k < t->model->n_states; k++)
        if (!find_column(t, q, o, o, to, k, nudge_rough * unit[k]))
            return false;
    return true;
}

/* x = (1 - map)^-1 b, with rows and columns in units of the states. False: singular. */
static bool solve_closing(const struct orbit_task *t, const struct orbit *o, const double *unit,
                          const double *b, double *x)
{
    int n = t->model->n_states;
    double a[MATRIX_MAX][MATRIX_MAX], right[MATRIX_MAX];
    for (int i = 0; i < n; i++) {
        right[i] = b[i] / unit[i];
        for (int k = 0; k < n; k++)
            a[i][k] = (i == k) - o->map[i][k] * unit[k] / unit[i];
    }
    if (!matrix_solve(n, a, right))
        return false;
    for (int i = 0; i < n; i++)
        x[i] = right[i] * unit[i];
    return true;
}

/* How far o->x is from its end `to`, over its distance from rest. */
static double miss_of(int n, const struct orbit *o, const double *to, const double *rest, const double *unit,
                      double *miss)
{
    double size = 0.0, error = 0.0;
    for (int k = 0; k < n; k++) {
        miss[k] = to[k] - o->x[k];
        size = fmax(size, fabs(o->x[k] - rest[k]) / unit[k]);
        error = fmax(error, fabs(miss[k]) / unit[k]);
    }
    return fmax(error - floor_of, 0.0) / fmax(size, floor_of);
}

bool orbit_find(struct orbit_task *t, struct orbit *o)
{
    struct period q;
    double rest[MODEL_STATES], unit[MODEL_STATES], to[MODEL_STATES], miss[MODEL_STATES], step[MODEL_STATES];
    double least = HUGE_VAL;
    int n = t->model->n_states;
    bool mapped = false;
    if (set_up(t, o->frequency_Hz, &q))
        return false;
    orbit_rest(t, rest, unit);
    for (int i = 0; i < NEWTON_STEPS; i++) {
        if (!run(t, &q, o, o->x, to))
            return false;
        double error = miss_of(n, o, to, rest, unit, miss);
        bool ends = error <= closed;
        if (!(error < diverges * least))
            return false;
        least = fmin(least, error);
        if ((!mapped || error > near) && !find_map(t, &q, o, to, unit))
            return false;
        mapped = true;
        if (ends)
            return true;
        if (!solve_closing(t, o, unit, miss, step))
            return false;
        for (int k = 0; k < n; k++)
            o->x[k] += step[k];
    }
    return false;
}

bool orbit_is_stable(const struct orbit_task *t, const struct orbit *o)
{
    double a[MATRIX_MAX][MATRIX_MAX], rest[MODEL_STATES], unit[MODEL_STATES];
    orbit_rest(t, rest, unit);
    for (int i = 0; i < t->model->n_states; i++)
        for (int k = 0; k < t->model->n_states; k++)
            a[i][k] = o->map[i][k] * unit[k] / unit[i];
    return matrix_contracts(t->model->n_states, a);
}

bool orbit_sharpen(struct orbit_task *t, struct orbit *o)
{
    struct period q;
    double rest[MODEL_STATES], unit[MODEL_STATES], to[MODEL_STATES];
    orbit_rest(t, rest, unit);
    if (set_up(t, o->frequency_Hz, &q))
        return false;
    for (int k = 0; k < t->model->n_states; k++) {
        struct orbit below = *o;
        below.x[k] -= nudge * unit[k];
        if (!run(t, &q, &below, below.x, to) || !find_column(t, &q, o, &below, to, k, 2.0 * nudge * unit[k]))
            return false;
    }
    return true;
}

bool orbit_slope(struct orbit_task *below, struct orbit_task *above, const struct orbit *o, double difference,
                 double *re, double *im)
{
    struct orbit side[2] = {*o, *o};
    struct period q;
    double to[2][MODEL_STATES], rest[MODEL_STATES], unit[MODEL_STATES], x[MODEL_STATES];
    if (set_up(below, o->frequency_Hz, &q) || !run(below, &q, &side[0], o->x, to[0]) ||
        set_up(above, o->frequency_Hz, &q) || !run(above, &q, &side[1], o->x, to[1]))
        return false;
    orbit_rest(below, rest, unit);
    for (int i = 0; i < below->model->n_states; i++)
        to[0][i] = (to[1][i] - to[0][i]) / difference;
    if (!solve_closing(below, o, unit, to[0], x))
        return false;
    *re = (side[1].re - side[0].re) / difference;
    *im = (side[1].im - side[0].im) / difference;
    for (int i = 0; i < below->model->n_states; i++) {
        *re += o->re_x[i] * x[i];
        *im += o->im_x[i] * x[i];
    }
    return true;
}
