/* batch_rk4.c - the classical Runge-Kutta method of order 4, eight quads of trajectories at a time; see batch.h.
 *
 * x'' = f(t, x, x') as in firmware/rk4.c, in u = (h/2) x' and accelerations a = (h^2/4) x'': the stages
 *   a1 at (x, u), a2 at (x + u, u + a1), a3 at (x + u + a1, u + a2), a4 at (x + 2 u + 2 a2, u + 2 a3)
 * are sums, and nothing but the equation's own products is multiplied:
 *   x <- x + 2 u + (2/3) (a1 + a2 + a3),   u <- u + (1/3) (a1 + 2 (a2 + a3) + a4).
 * What a step cannot do without is four square roots, which a processor takes one after the other. All else is
 * arranged so that the next root never waits: eight quads run a stage each in turn, and the drives' share of the work lies
 * between the stages. */
#include "host_sim/batch_kernels.h"

#include <float.h>
#include "firmware/drive.h"
#include "firmware/method.h"
#include "host_sim/batch_lanes.h"
#include "models/elementary.h"

enum { QUADS = 8, LANES = QUADS * QUAD };

#define TURN_RAD (2.0 * ELEMENTARY_PI)

/* A tone at half steps of phase theta: d += -4 sin^2(theta/2) p, p += d, with d the last change of p. */
struct swing {
    quad p, d, pull;
};

/* What depends on time: the force without the contact's, and the contact's stiffness. */
struct load {
    quad force, hertz;
};

struct rk4_quad {
    quad x, u;
    quad damping, stiffness; /* u's by h/2, x's by h^2/4 */
    struct load mean, now;   /* without tones, and at the beginning of the step; h^2/4 */
    struct swing tone[BATCH_TONES];
    quad lowest, highest;
    mask liftoffs;
};

/* What a quad needs from one interval to the next. */
struct keep {
    quad half; /* h/2 */
    quad eta, rate;
    mask good; /* has not failed */
    quad intervals;
    struct {
        quad amplitude, cosine, sine; /* times h^2/4; of theta/2 */
        bits phase, step, interval;   /* at its begin; advance per step and per interval */
    } tone[BATCH_TONES];
};

/* The trajectories at[0..n-1]; lanes from n on repeat the last one. */
struct block {
    struct rk4_quad q[QUADS];
    struct keep keep[QUADS];
    int at[LANES], n;
};

ALWAYS_INLINE quad swing(struct swing *s)
{
    s->d -= s->pull * s->p;
    return s->p += s->d;
}

/* The load half a step on; its hertz only where there is a tone of the stiffness. */
ALWAYS_INLINE void drive(struct rk4_quad *q, int n_force, bool full, struct load *load)
{
    quad force = q->mean.force;
    BATCH_UNROLL
    for (int i = 0; i < n_force; i++)
        force += swing(&q->tone[i]);
    load->force = force;
    if (full)
        load->hertz = q->mean.hertz + swing(&q->tone[BATCH_STIFFNESS_TONE]);
}

ALWAYS_INLINE quad acceleration(const struct rk4_quad *q, bool full, const struct load *load, quad x, quad u)
{
    quad a = load->force - q->damping * u;
    if (full)
        a -= q->stiffness * x;
    return a - (full ? load->hertz : q->mean.hertz) * contact_force(x);
}

/* Steps of all quads; n_force tones of the force, and with `full` a stiffness and its tone. */
ALWAYS_INLINE void advance(struct rk4_quad *quads, int n_force, bool full, int steps)
{
    quad x2[QUADS], x3[QUADS], x4[QUADS], u2[QUADS], u3[QUADS], u4[QUADS], a1[QUADS], a2[QUADS], a3[QUADS];
    struct load middle[QUADS];
    for (int n = 0; n < steps; n++) {
        BATCH_UNROLL
        for (int i = 0; i < QUADS; i++) {
            struct rk4_quad *q = &quads[i];
            a1[i] = acceleration(q, full, &q->now, q->x, q->u);
            drive(q, n_force, full, &middle[i]);
            x2[i] = q->x + q->u;
            u2[i] = q->u + a1[i];
        }
        BATCH_UNROLL
        for (int i = 0; i < QUADS; i++) {
            a2[i] = acceleration(&quads[i], full, &middle[i], x2[i], u2[i]);
            x3[i] = x2[i] + a1[i];
            u3[i] = quads[i].u + a2[i];
        }
        BATCH_UNROLL
        for (int i = 0; i < QUADS; i++) {
            struct rk4_quad *q = &quads[i];
            a3[i] = acceleration(q, full, &middle[i], x3[i], u3[i]);
            drive(q, n_force, full, &q->now);
            x4[i] = (q->x + u3[i]) + u3[i];
            u4[i] = (q->u + a3[i]) + a3[i];
        }
        BATCH_UNROLL
        for (int i = 0; i < QUADS; i++) {
            struct rk4_quad *q = &quads[i];
            quad a4 = acceleration(q, full, &q->now, x4[i], u4[i]), inner = a2[i] + a3[i];
            quad x = (x2[i] + q->u) + (2.0 / 3.0) * (a1[i] + inner);
            q->u += (1.0 / 3.0) * ((a1[i] + a4) + (inner + inner));
            q->liftoffs -= (q->x > 0.0) & (x <= 0.0);
            q->lowest = lesser(x, q->lowest);
            q->highest = greater(x, q->highest);
            q->x = x;
        }
    }
}

static void advance_one(struct rk4_quad *quads, int steps)
{
    advance(quads, 1, false, steps);
}

static void advance_two(struct rk4_quad *quads, int steps)
{
    advance(quads, 2, false, steps);
}

static void advance_full(struct rk4_quad *quads, int steps)
{
    advance(quads, BATCH_STIFFNESS_TONE, true, steps);
}

/* The cheapest kernel that holds every trajectory: what it leaves out adds zeros, so that the bits are the same. */
struct kernel {
    void (*advance)(struct rk4_quad *quads, int steps);
    int n_tones;
};

static struct kernel choose(const struct batch *b)
{
    bool two = false, full = false;
    for (int i = 0; i < b->n; i++) {
        two |= b->tone[1].amplitude[i] != 0.0;
        full |= b->stiffness[i] != 0.0 || b->tone[BATCH_STIFFNESS_TONE].amplitude[i] != 0.0;
    }
    if (full)
        return (struct kernel){advance_full, BATCH_TONES};
    return two ? (struct kernel){advance_two, 2} : (struct kernel){advance_one, 1};
}

static void load_tone(struct block *k, const struct batch *b, int t, int steps)
{
    const struct batch_tone *tone = &b->tone[t];
    for (int i = 0; i < LANES; i++) {
        struct keep *keep = &k->keep[i / QUAD];
        double turns = tone->omega[k->at[i]] * b->interval[k->at[i]] / TURN_RAD;
        keep->tone[t].phase[i % QUAD] = tone->phase[k->at[i]];
        keep->tone[t].step[i % QUAD] = turns_of(turns / steps);
        keep->tone[t].interval[i % QUAD] = turns_of(turns);
        keep->tone[t].cosine[i % QUAD] = 0.25 * turns / steps;
    }
    for (int i = 0; i < QUADS; i++) {
        struct keep *keep = &k->keep[i];
        quad cosine, sine;
        cos_sin_of(keep->tone[t].cosine, &cosine, &sine);
        keep->tone[t].cosine = cosine;
        keep->tone[t].sine = sine;
        keep->tone[t].amplitude = gather(tone->amplitude, &k->at[i * QUAD]) * (keep->half * keep->half);
        k->q[i].tone[t].pull = 4.0 * (sine * sine);
    }
}

static void load(struct block *k, const struct batch *b, int first, int steps)
{
    k->n = b->n - first < LANES ? b->n - first : LANES;
    for (int i = 0; i < LANES; i++)
        k->at[i] = first + (i < k->n ? i : k->n - 1);
    for (int i = 0; i < QUADS; i++) {
        struct rk4_quad *q = &k->q[i];
        struct keep *keep = &k->keep[i];
        const int *at = &k->at[i * QUAD];
        quad half = gather(b->interval, at) * (0.5 / steps), square = half * half;
        keep->half = half;
        keep->eta = gather(b->eta, at);
        keep->rate = gather(b->rate, at);
        for (int j = 0; j < QUAD; j++)
            keep->good[j] = b->status[at[j]] == BATCH_GOOD ? -1 : 0;
        q->mean.force = gather(b->constant, at) * square;
        q->mean.hertz = gather(b->hertz, at) * square;
        q->damping = gather(b->damping, at) * half;
        q->stiffness = gather(b->stiffness, at) * square;
        q->lowest = gather(b->lowest, at);
        q->highest = gather(b->highest, at);
    }
    for (int t = 0; t < BATCH_TONES; t++)
        load_tone(k, b, t, steps);
}

/* The tones from their integer phase, `done` steps into the interval: p = a cos(phase), and its change over the half step
 * before, -2 a sin(theta/2) sin(phase - theta/2). */
static void synchronise(struct rk4_quad *q, const struct keep *keep, int n_tones, int done)
{
    q->now = q->mean;
    for (int t = 0; t < n_tones; t++) {
        quad c, s, amplitude = keep->tone[t].amplitude;
        quad phase = turns_lanes(keep->tone[t].phase + keep->tone[t].step * (unsigned long long)done);
        cos_sin_of(phase, &c, &s);
        q->tone[t].p = amplitude * c;
        quad behind = s * keep->tone[t].cosine - c * keep->tone[t].sine;
        q->tone[t].d = -2.0 * amplitude * (keep->tone[t].sine * behind);
        *(t < BATCH_STIFFNESS_TONE ? &q->now.force : &q->now.hertz) += q->tone[t].p;
    }
}

/* Where a quad stands after an interval; what fails stays where it was before. */
static void complete(const struct rk4_quad *q, struct keep *keep, int n_tones)
{
    quad rate = q->u / keep->half;
    keep->good &= (magnitude(q->x) <= BATCH_LIMIT) & (magnitude(rate) <= BATCH_LIMIT);
    keep->eta = where(keep->good, q->x, keep->eta);
    keep->rate = where(keep->good, rate, keep->rate);
    keep->intervals += where(keep->good, all_lanes(1.0), all_lanes(0.0));
    for (int t = 0; t < n_tones; t++)
        keep->tone[t].phase += keep->tone[t].interval & (bits)keep->good;
}

static void sample(const struct block *k, int n, double *samples)
{
    for (int i = 0; i < k->n; i += QUAD) {
        const struct keep *keep = &k->keep[i / QUAD];
        size_t size = (size_t)(k->n - i < QUAD ? k->n - i : QUAD) * sizeof *samples;
        quad eta = where(keep->good, keep->eta, all_lanes((double)NAN));
        quad rate = where(keep->good, keep->rate, all_lanes((double)NAN));
        memcpy(samples + k->at[i], &eta, size);
        memcpy(samples + n + k->at[i], &rate, size);
    }
}

static void store(const struct block *k, struct batch *b)
{
    for (int lane = 0; lane < k->n; lane++) {
        const struct rk4_quad *q = &k->q[lane / QUAD];
        const struct keep *keep = &k->keep[lane / QUAD];
        int i = k->at[lane], j = lane % QUAD;
        b->eta[i] = keep->eta[j];
        b->rate[i] = keep->rate[j];
        b->lowest[i] = q->lowest[j];
        b->highest[i] = q->highest[j];
        b->liftoffs[i] += q->liftoffs[j];
        b->intervals[i] += (int64_t)keep->intervals[j];
        if (b->status[i] == BATCH_GOOD && !keep->good[j])
            b->status[i] = BATCH_ESCAPED;
        for (int t = 0; t < BATCH_TONES; t++)
            b->tone[t].phase[i] = keep->tone[t].phase[j];
    }
}

static void run_interval(struct block *k, struct kernel kernel, int steps)
{
    for (int i = 0; i < QUADS; i++) {
        k->q[i].x = k->keep[i].eta;
        k->q[i].u = k->keep[i].rate * k->keep[i].half;
    }
    for (int done = 0; done < steps; done += BATCH_RESYNC) {
        for (int i = 0; i < QUADS; i++)
            synchronise(&k->q[i], &k->keep[i], kernel.n_tones, done);
        kernel.advance(k->q, steps - done < BATCH_RESYNC ? steps - done : BATCH_RESYNC);
    }
    for (int i = 0; i < QUADS; i++)
        complete(&k->q[i], &k->keep[i], kernel.n_tones);
}

static const char *refuse(const struct batch *b, int steps, int intervals)
{
    if (steps < 1 || intervals < 0)
        return "batch_rk4 needs at least one step a interval, and no negative number of intervals";
    for (int i = 0; i < b->n; i++) {
        double h = b->interval[i] / steps;
        if (!(h * b->eigenfrequency[i] <= RK4_ANGLE_MAX))
            return "step too coarse for rk4: eigenfrequency * step is above 0.2 rad (more steps an interval)";
        for (int t = 0; t < BATCH_TONES; t++) {
            if (!(h * b->tone[t].omega[i] <= TURN_RAD / DRIVE_TICKS_MIN))
                return "step too coarse: " DRIVE_TICKS_TOO_FEW "a drive (more steps an interval)";
        }
    }
    return NULL;
}

const char *batch_rk4_plain(struct batch *b, int steps, int intervals, double *samples)
{
    struct block k;
    const char *why = refuse(b, steps, intervals);
    struct kernel kernel = choose(b);
    for (int first = 0; !why && first < b->n; first += LANES) {
        memset(&k, 0, sizeof k);
        load(&k, b, first, steps);
        for (int n = 0; n < intervals; n++) {
            run_interval(&k, kernel, steps);
            if (samples)
                sample(&k, b->n, samples + 2 * (size_t)n * (size_t)b->n);
        }
        store(&k, b);
    }
    return why;
}
