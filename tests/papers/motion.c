/* motion.c - see motion.h. */
#include "tests/papers/motion.h"

#include <math.h>
#include "firmware/plant/plant_change.h"

const char *motion_start(struct motion *m, const struct model *model, const double *paper, double tick,
                         double tol, const double *state)
{
    double si[MODEL_PARAMETERS], x[MODEL_STATES];
    struct harmonic drive[MODEL_INPUTS];
    bool series = model->hertz_form || model->polynomial_form;
    model->from_paper(paper, si, drive);
    struct plant_config c = {.model = model,
                             .si = si,
                             .method = series ? &taylor : &exact,
                             .tick_s = tick,
                             .dilation = 1.0,
                             .tol = series ? tol : 0.0,
                             .scratch = m->scratch};
    const char *why = plant_init(&m->pl, &c);
    if (why)
        return why;
    for (int i = 0; i < model->n_inputs; i++) {
        if (drive[i].amplitude != 0.0)
            plant_drive_start(&m->pl, i, drive[i].amplitude, drive[i].omega / MOTION_TWO_PI, drive[i].phase);
    }
    model->rest(m->pl.p, x);
    if (state)
        model->state_from_paper(m->pl.p, m->pl.segment.at[2], state, x);
    plant_set_state(&m->pl, x);
    return NULL;
}

void motion_tune(struct motion *m, const double *paper)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    m->pl.model->from_paper(paper, si, drive);
    for (int i = 0; i < m->pl.model->n_inputs; i++) {
        if (drive[i].amplitude != 0.0)
            plant_drive(&m->pl, i, drive[i].amplitude, drive[i].omega / MOTION_TWO_PI, drive[i].phase, 0.0);
    }
}

static uint64_t ticks_in(const struct motion *m, double time)
{
    return (uint64_t)ceil(time / m->pl.tick_s);
}

void motion_state(const struct motion *m, double *state)
{
    m->pl.model->paper_state(m->pl.p, m->pl.segment.at[2], m->pl.x, state);
}

/* A finite state this far out is behind the tip's saddle, on its way to infinity. */
static bool escaped(const struct motion *m)
{
    return fabs(m->pl.x[0]) > 1e3;
}

bool motion_settle(struct motion *m, double time)
{
    uint64_t left = ticks_in(m, time), slice = 4096;
    for (; left > 0; left -= slice) {
        slice = left < slice ? left : slice;
        if (!plant_run(&m->pl, slice) || escaped(m))
            return false;
    }
    return true;
}

struct seen motion_watch(struct motion *m, int coordinate, double omega, double time)
{
    const double nan = (double)NAN;
    struct seen s = {-HUGE_VAL, HUGE_VAL, 0.0, 0.0, true};
    double cosine = 0.0, sine = 0.0, weight = 0.0, state[MODEL_STATES];
    uint64_t n = ticks_in(m, time);
    m->pl.loss_time = m->pl.total_time = 0.0;
    for (uint64_t i = 0; i < n; i++) {
        if (!plant_run(&m->pl, 1) || escaped(m))
            return (struct seen){nan, nan, nan, nan, false};
        motion_state(m, state);
        double w = 1.0 - cos(MOTION_TWO_PI * ((double)i + 0.5) / (double)n);
        double x = state[coordinate], phase = omega * m->pl.tick_s * (double)i;
        s.high = fmax(s.high, x);
        s.low = fmin(s.low, x);
        cosine += w * x * cos(phase);
        sine += w * x * sin(phase);
        weight += w;
    }
    s.amplitude = 2.0 * hypot(cosine, sine) / weight;
    s.loss = m->pl.loss_time / m->pl.total_time;
    return s;
}

double sweep_at(const struct sweep *s, int i)
{
    return s->from + (s->to - s->from) * i / s->steps;
}

void sweep_run(const struct sweep *s, struct seen *seen)
{
    static struct motion m;
    double paper[MODEL_PARAMETERS];
    bool going = false;
    for (int k = 0; k < MODEL_PARAMETERS; k++)
        paper[k] = s->paper[k];
    for (int i = 0; i <= s->steps; i++) {
        paper[s->swept] = sweep_at(s, i);
        if (going)
            motion_tune(&m, paper);
        else if (motion_start(&m, s->model, paper, s->tick, s->tol, NULL) != NULL) {
            seen[i] = (struct seen){.good = false};
            continue;
        }
        seen[i] = (struct seen){(double)NAN, (double)NAN, (double)NAN, (double)NAN, false};
        if (motion_settle(&m, s->wait))
            seen[i] = motion_watch(&m, s->coordinate, paper[s->omega], s->look);
        going = seen[i].good;
    }
}

int sweep_jump(const struct sweep *s, const struct seen *seen, int sign, double least)
{
    int where = -1;
    for (int i = 0; i < s->steps; i++) {
        double change = sign * (seen[i + 1].amplitude - seen[i].amplitude);
        if (change >= least) {
            least = change;
            where = i;
        }
    }
    return where;
}
