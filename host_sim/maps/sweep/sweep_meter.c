/* sweep_meter.c - harmonics, mean and extremes of an output, corrected beside contact switches. */
#include "host_sim/maps/sweep/sweep_meter.h"

#include <math.h>
#include <string.h>
#include "models/math/elementary.h"

#define TURN_RAD (2.0 * ELEMENTARY_PI)

#define NEAR 2e-5 /* ticks: switches nearer than this count as one */

enum { FORCE = 3 }; /* index in every model's outputs, see models/model.h */

static void begin_window(struct sweep_meter *m)
{
    lockin_begin(&m->window, (uint32_t)m->n);
    memset(m->sum, 0, sizeof m->sum);
}

void sweep_meter_start(struct sweep_meter *m, int output, const uint32_t *harmonic, int n_harmonics,
                       int64_t n, uint64_t phase, uint64_t step)
{
    *m = (struct sweep_meter){
        .output = output, .n_harmonics = n_harmonics, .n = n, .phase = phase, .step = step};
    for (int i = 0; i < n_harmonics; i++)
        m->harmonic[i] = harmonic[i];
    begin_window(m);
    cos_sin_turns(step, &m->rotation_cosine, &m->rotation_sine);
}

/* ---- harmonics ---- */

/* Adds a sample to all harmonics. Returns its weight in their common window. */
static double add_sample(struct sweep_meter *m, double y)
{
    double weight = lockin_weight(&m->window);
    if (m->beats)
        weight *= weight * (4.0 / 3.0); /* the sum of the weights stays */
    drive_rotate(&m->cosine, &m->sine, m->rotation_cosine, m->rotation_sine);
    for (int i = 0; i < m->n_harmonics; i++)
        lockin_add(&m->sum[i], m->harmonic[i], weight * y, m->cosine, m->sine);
    return weight;
}

static void finish_harmonics(struct sweep_meter *m, struct sweep_measured *r)
{
    for (int i = 0; i < m->n_harmonics; i++)
        lockin_polar(&m->sum[i], 2.0 / m->window.weight, &r->amplitude[i], &r->phase[i]);
    begin_window(m);
}

/* ---- switches ---- */

/* A switch: state and rates there, and the time since the start of the inputs' waves. */
struct place {
    double x[MODEL_STATES], x_dot[MODEL_STATES], since;
};

static void inputs_at(const struct plant *pl, double s, struct input *u)
{
    for (int i = 0; i < pl->model->n_inputs; i++)
        wave_at(&pl->segment.wave[i], s, &u[i]);
}

static void place_of(const struct plant *pl, const struct event *e, struct place *at)
{
    struct input u[MODEL_INPUTS];
    at->since =
        pl->segment.length - (1.0 - e->fraction) * pl->h; /* the rest of the tick begins at its last switch */
    memcpy(at->x, e->x, sizeof at->x);
    inputs_at(pl, at->since, u);
    pl->model->rhs(pl->p, u, at->x, at->x_dot);
}

/* The output at time s after the switch. */
static double beside(const struct plant *pl, const struct place *at, double s, int output)
{
    double x[MODEL_STATES], y[MODEL_OUTPUTS];
    struct input u[MODEL_INPUTS];
    const struct model *m = pl->model;
    int rates = m->n_states / 2;
    for (int i = 0; i < m->n_states; i++)
        x[i] = at->x[i] + s * at->x_dot[i];
    for (int i = 0; i < rates; i++)
        x[i] += 0.5 * s * s * at->x_dot[i + rates];
    inputs_at(pl, at->since + s, u);
    m->output(pl->p, u, x, y);
    return y[output] * scale_of(&pl->scale, m->output_signal[output].quantity);
}

/* An output on one side of a switch, s ticks from it: y + rate s + root s^(3/2) + bend s^2. */
struct side {
    double y, rate, root, bend;
};

/* Fits a side through four points, at squares of 1 to 4, so that their square roots are whole. way: 1
 * after the switch, -1 before it. room: ticks on this side without another switch; the points stay within
 * it. */
static struct side side_of(const struct plant *pl, const struct place *at, int way, double room, int output)
{
    double part = fmin(1e-3, fmax(room, NEAR) / 16.0), y[4]; /* part: ticks */
    for (int i = 0; i < 4; i++)
        y[i] = beside(pl, at, way * part * pl->h * ((i + 1) * (i + 1)), output);
    double d1 = y[1] - y[0], d2 = y[2] - y[1], d3 = y[3] - y[2];
    double e1 = 3.0 * d2 - 5.0 * d1, e2 = 5.0 * d3 - 7.0 * d2;
    double root = (7.0 * e1 - 2.0 * e2) / 50.0, bend = (11.0 * e2 - 26.0 * e1) / 1500.0,
           rate = (d1 - 7.0 * root - 15.0 * bend) / 3.0;
    return (struct side){y[0] - rate - root - bend, rate / part, root / (part * sqrt(part)),
                         bend / (part * part)};
}

/* The sum of (k + a)^(3/2), k = 0, 1, .., less its integral: Hurwitz's zeta(-3/2, a), to 4e-7. */
static double zeta(double a)
{
    double sum = 0.0;
    for (; a < 4.0; a += 1.0)
        sum += a * sqrt(a);
    return sum + sqrt(a) * (a * (0.5 - 0.4 * a) - 0.125) - 1.0 / (1920.0 * a * sqrt(a));
}

/* Corrects the harmonics for a switch in the tick whose sample, with this weight, was just added. Returns
 * the correction of the mean. */
static double add_switch(struct sweep_meter *m, double theta, const struct side *before,
                         const struct side *after, double weight)
{
    double y = after->y - before->y, rate = after->rate + before->rate,
           bend = 2.0 * (after->bend - before->bend);
    double b1 = theta - 0.5, b2 = 0.5 * ((theta - 1.0) * theta) + 1.0 / 12.0,
           b3 = ((theta - 1.5) * theta + 0.5) * theta * (1.0 / 6.0);
    double mean =
               rate * b2 - y * b1 - bend * b3 - after->root * zeta(1.0 - theta) - before->root * zeta(theta),
           c, d;
    uint64_t phase = m->phase + (uint64_t)m->i_tick * m->step - (uint64_t)((1.0 - theta) * (double)m->step);
    for (int i = 0; i < m->n_harmonics; i++) {
        double turn = turns_to_double(m->step) * TURN_RAD * m->harmonic[i];
        double even = mean + y * b3 * (turn * turn), odd = (y * b2 - 2.0 * rate * b3) * turn;
        cos_sin_turns(phase * m->harmonic[i], &c, &d);
        m->sum[i].re += weight * (even * c - odd * d);
        m->sum[i].im -= weight * (even * d + odd * c);
    }
    return mean;
}

/* ---- extremes ---- */

static void trace_add(struct sweep_trace *t, double y)
{
    memmove(t->y, t->y + 1, (SWEEP_METER_SAMPLES - 1) * sizeof *t->y);
    t->y[SWEEP_METER_SAMPLES - 1] = y;
    t->smooth++;
}

/* The extreme beside sample i of the polynomial through all samples, by Newton's method. */
static double top(const struct sweep_trace *t, int i)
{
    const double *y = t->y;
    double odd1 = 0.5 * (y[3] - y[1]), odd2 = 0.5 * (y[4] - y[0]), even1 = 0.5 * (y[3] + y[1]) - y[2],
           even2 = 0.5 * (y[4] + y[0]) - y[2];
    double c1 = (8.0 * odd1 - odd2) / 6.0, c3 = (odd2 - 2.0 * odd1) / 6.0;
    double c2 = (16.0 * even1 - even2) / 12.0, c4 = (even2 - 4.0 * even1) / 12.0, s = i - 2;
    for (int k = 0; k < 4; k++) {
        double slope = c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * 4.0 * c4));
        double bend = 2.0 * c2 + s * (6.0 * c3 + s * 12.0 * c4);
        s -= bend < 0.0 || bend > 0.0 ? slope / bend : 0.0;
    }
    return fabs(s - (i - 2)) <= 1.0 ? y[2] + s * (c1 + s * (c2 + s * (c3 + s * c4))) : y[i];
}

/* The extreme beside sample i, if there is one; else the last sample. */
static double extreme(const struct sweep_trace *t, int i)
{
    const double *y = t->y;
    double before = y[i] - y[i - 1], after = y[i + 1] - y[i];
    bool turns = (before > 0.0 && after <= 0.0) || (before < 0.0 && after >= 0.0);
    return turns && t->smooth >= SWEEP_METER_SAMPLES ? top(t, i) : y[SWEEP_METER_SAMPLES - 1];
}

/* ---- a half ---- */

/* True when the output bends or jumps at a switch by more than rounding. */
static bool parts(const struct side *before, const struct side *after)
{
    double change = fabs(after->y - before->y) + fabs(after->rate + before->rate) + fabs(after->root) +
                    fabs(before->root);
    return change > 1e-6 * (fabs(before->rate) + fabs(after->rate));
}

static void take_extreme(double y, struct sweep_measured *r)
{
    r->lowest = y < r->lowest ? y : r->lowest;
    r->highest = y > r->highest ? y : r->highest;
}

/* Extremes of output and force beside sample i: 2, the middle one, and 3 after the last tick. */
static void take_extremes(const struct sweep_meter *m, int i, struct sweep_measured *r)
{
    double force = extreme(&m->force, i);
    take_extreme(extreme(&m->trace, i), r);
    r->peak_force = force > r->peak_force ? force : r->peak_force;
}

/* Takes switches e[0] .. e[n - 1] as one, with the sides before the first and after the last. Two contacts
 * of a symmetric motion switch together. */
static void take_switch(struct sweep_meter *m, struct plant *pl, const struct event *e, int n,
                        const double *room, double weight, struct sweep_measured *r)
{
    struct place first, last;
    place_of(pl, &e[0], &first);
    place_of(pl, &e[n - 1], &last);
    struct side before = side_of(pl, &first, -1, room[0], m->output),
                after = side_of(pl, &last, 1, room[1], m->output);
    r->mean += add_switch(m, e[0].fraction, &before, &after, weight);
    take_extreme(beside(pl, &first, 0.0, m->output), r);
    m->force.smooth = 0;
    if (parts(&before, &after) || e[0].fraction >= 1.0) /* 1: the method does not locate switches */
        m->trace.smooth = 0;
}

/* Takes the switches of this tick. The plant forgets its peak force at touchdown; lift-off events have it. */
static void take_switches(struct sweep_meter *m, struct plant *pl, double weight, struct sweep_measured *r)
{
    struct event e[PLANT_EVENTS];
    int n = 0, next;
    while (plant_take_event(pl, &e[n])) {
        r->peak_force = fmax(r->peak_force, e[n].peak_force);
        n++;
    }
    for (int i = 0; i < n; i = next) {
        for (next = i + 1; next < n && e[next].fraction - e[next - 1].fraction < NEAR;)
            next++;
        const double room[2] = {e[i].fraction - (i > 0 ? e[i - 1].fraction : 0.0),
                                (next < n ? e[next].fraction : 1.0) - e[next - 1].fraction};
        take_switch(m, pl, &e[i], next - i, room, weight, r);
    }
}

static bool run_half(struct sweep_meter *m, struct plant *pl, struct sweep_measured *r)
{
    double unit = scale_of(&pl->scale, pl->model->output_signal[m->output].quantity);
    *r = (struct sweep_measured){.lowest = (double)INFINITY, .highest = -(double)INFINITY};
    plant_begin_record(pl);
    pl->peak_force = 0.0;
    cos_sin_turns(m->phase + (uint64_t)m->i_tick * m->step, &m->cosine, &m->sine);
    for (int64_t i = 0; i < m->n; i++) {
        if (!plant_run(pl, 1))
            return false;
        m->i_tick++;
        double output[MODEL_OUTPUTS];
        pl->model->output(pl->p, pl->segment.at[2], pl->x, output);
        double y = output[m->output] * unit, weight = add_sample(m, y);
        r->mean += y;
        if (pl->n_event > 0)
            take_switches(m, pl, weight, r);
        trace_add(&m->trace, y);
        trace_add(&m->force, output[FORCE] * pl->scale.force_N);
        take_extremes(m, 2, r);
        r->peak_force = fmax(r->peak_force, pl->peak_force * pl->scale.force_N);
    }
    take_extremes(m, 3, r);
    finish_harmonics(m, r);
    r->mean /= (double)m->n;
    r->out_of_contact = pl->loss_time / pl->total_time;
    return true;
}

bool sweep_meter_run(struct sweep_meter *m, struct plant *pl, struct sweep_measured *r)
{
    pl->event_x = m->event_x;
    bool finite = run_half(m, pl, r);
    pl->event_x = NULL;
    return finite;
}
