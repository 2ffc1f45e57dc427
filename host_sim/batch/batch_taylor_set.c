/* batch_taylor_set.c - set-up of a batch from its models, and which kernels run it; see batch_taylor.h. */
#include "host_sim/batch/batch_taylor_set.h"

#include <math.h>
#include <string.h>
#include "host_sim/batch/batch_taylor_avx2.h"
#include "models/check.h"
#include "models/math/elementary.h"

#define TURN_RAD (2.0 * ELEMENTARY_PI)

enum { ARRAYS = 11 + 3 * BATCH_TONES + 4 };

/* The arrays of a batch, one after the other from `memory` on. */
static void place(struct batch_taylor *b, size_t n, double *memory)
{
    double **real[] = {&b->constant, &b->damping, &b->stiffness, &b->hertz, &b->rest,     &b->pace,
                       &b->interval, &b->eta,     &b->rate,      &b->most,  &b->most_rate};
    int64_t **whole[] = {&b->intervals, &b->liftoffs, &b->residuals, &b->status};
    double *end = memory;
    for (size_t i = 0; i < sizeof real / sizeof *real; i++, end += n)
        *real[i] = end;
    for (int i = 0; i < BATCH_TONES; i++, end += 3 * n)
        b->tone[i] = (struct batch_tone){end, end + n, (uint64_t *)(void *)(end + 2 * n)};
    for (size_t i = 0; i < sizeof whole / sizeof *whole; i++, end += n)
        *whole[i] = (int64_t *)(void *)end;
    ASSERT(end == memory + ARRAYS * n);
}

size_t batch_taylor_bytes(int n)
{
    return ARRAYS * (size_t)n * sizeof(double);
}

void batch_taylor_init(struct batch_taylor *b, int n, void *memory)
{
    memset(memory, 0, batch_taylor_bytes(n));
    b->n = n;
    place(b, (size_t)n, memory);
    for (int i = 0; i < n; i++) {
        b->eta[i] = -1.0;
        b->interval[i] = b->pace[i] = 1.0;
    }
}

/* A tone as p cos(omega t) + q sin(omega t). */
struct pair {
    double omega, p, q;
};

/* a cos(omega t + phase) + b sin(omega t + phase) into the pair of that frequency; false when all are
 * taken. */
static bool add(struct pair *pair, int *n, int limit, const struct harmonic *h, double a, double b)
{
    double c, s;
    int i = 0;
    if (a == 0.0 && b == 0.0)
        return true;
    while (i < *n && pair[i].omega != h->omega)
        i++;
    if (i == limit)
        return false;
    if (i == *n)
        pair[(*n)++] = (struct pair){h->omega, 0.0, 0.0};
    cos_sin_turns(turns_of(h->phase / TURN_RAD), &c, &s);
    pair[i].p += a * c + b * s;
    pair[i].q += b * c - a * s;
    return true;
}

static void set_tone(const struct batch_tone *tone, int i, const struct pair *pair)
{
    tone->amplitude[i] = sqrt(pair->p * pair->p + pair->q * pair->q);
    tone->omega[i] = pair->omega;
    tone->phase[i] = turns_of(arc_tangent(-pair->q, pair->p) / TURN_RAD);
}

/* The drives of a trajectory as tones; NULL or a reason. */
static const char *tones_of(const struct batch_trajectory *t, const struct hertz_form *f, struct pair *pair)
{
    int n_force = 0, n_stiffness = 0;
    for (int i = 0; i < t->model->n_inputs; i++) {
        const struct harmonic *h = &t->drive[i];
        double a = h->amplitude, w = h->omega;
        if (!(fabs(a) <= BATCH_LIMIT && w >= 0.0 && w <= BATCH_LIMIT && fabs(h->phase) <= BATCH_LIMIT))
            return "a drive's amplitude, frequency or phase is beyond 1e6, or a frequency negative";
        if (!add(pair, &n_force, BATCH_STIFFNESS_TONE, h, (f->force[i] - f->shift[i] * (w * w)) * a,
                 -f->drag[i] * a * w))
            return "the force has more than two frequencies";
        if (!add(&pair[BATCH_STIFFNESS_TONE], &n_stiffness, 1, h, f->hertz * f->modulation[i] * a, 0.0))
            return "the stiffness has more than one frequency";
    }
    return NULL;
}

/* The part of eta besides side x[0]. */
static struct input shift_at(const struct batch_trajectory *t, const struct hertz_form *f, double time)
{
    struct input shift = {f->origin, 0.0};
    for (int i = 0; i < t->model->n_inputs; i++) {
        const struct harmonic *h = &t->drive[i];
        double c, s;
        if (f->shift[i] == 0.0 || h->amplitude == 0.0)
            continue;
        cos_sin_turns(turns_of((h->omega * time + h->phase) / TURN_RAD), &c, &s);
        shift.value += f->shift[i] * h->amplitude * c;
        shift.rate -= f->shift[i] * h->amplitude * h->omega * s;
    }
    return shift;
}

/* The equation of a trajectory; NULL or a reason. */
static const char *equation_of(const struct batch_trajectory *t, struct hertz_form *f, struct pair *pair)
{
    if (!t->model->hertz_form)
        return "a batch takes models with one Hertzian contact only: rig, rolling contact, tip";
    if (!(t->interval > 0.0 && t->interval <= BATCH_LIMIT))
        return "the interval of a trajectory must be above 0 and at most 1e6";
    t->model->hertz_form(t->p, f);
    return tones_of(t, f, pair);
}

const char *batch_taylor_refuse(const struct batch_trajectory *t)
{
    struct hertz_form f;
    struct pair pair[BATCH_TONES] = {{0}};
    return equation_of(t, &f, pair);
}

const char *batch_taylor_set(struct batch_taylor *b, int i, const struct batch_trajectory *t)
{
    struct hertz_form f;
    struct pair pair[BATCH_TONES] = {{0}};
    const char *why = equation_of(t, &f, pair);
    if (why)
        return why;
    struct input shift = shift_at(t, &f, 0.0);
    double rest[MODEL_STATES];
    t->model->rest(t->p, rest);
    b->constant[i] = f.constant;
    b->damping[i] = f.damping;
    b->stiffness[i] = f.stiffness;
    b->hertz[i] = f.hertz;
    b->rest[i] = f.side * rest[0] + f.origin;
    b->pace[i] = t->model->eigenfrequency(t->p);
    for (int k = 0; k < BATCH_TONES; k++)
        set_tone(&b->tone[k], i, &pair[k]);
    b->interval[i] = t->interval;
    b->eta[i] = f.side * t->x[0] + shift.value;
    b->rate[i] = f.side * t->x[1] + shift.rate;
    b->most[i] = b->most_rate[i] = 0.0;
    b->intervals[i] = b->liftoffs[i] = b->residuals[i] = 0;
    b->status[i] = BATCH_GOOD;
    return NULL;
}

void batch_taylor_state(const struct batch_trajectory *t, double time, double eta, double rate, double *x)
{
    struct hertz_form f;
    t->model->hertz_form(t->p, &f);
    struct input shift = shift_at(t, &f, time);
    x[0] = f.side * (eta - shift.value);
    x[1] = f.side * (rate - shift.rate);
}

const char *batch_taylor(struct batch_taylor *b, double tol, int intervals, double *samples)
{
#ifdef BATCH_AVX2
    if (__builtin_cpu_supports("avx2"))
        return batch_taylor_avx2(b, tol, intervals, samples);
#endif
    return batch_taylor_plain(b, tol, intervals, samples);
}
