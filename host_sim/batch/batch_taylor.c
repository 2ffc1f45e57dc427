/* batch_taylor.c - power series, eight trajectories of one kind of motion at a time; see batch_taylor.h.
 *
 * Each trajectory has its own time and takes its own pieces, as in firmware/method/taylor/taylor_piece.c. In
 * flight and in deep contact the series is in time. If contact is about to end or has just begun it is in s
 * with eta = y^2. A contact may be so shallow and slow that its force is below the tolerance. Then the series
 * is that of flight, looking for both ends. Differences between trajectories are no branch inside a vector.
 * Trajectories that wait for one kind of series stand in a queue, and eight are taken from the longest. */
#include <math.h>
#include <string.h>
#include "host_sim/batch/batch_piece.h"
#include "models/math/elementary.h"

enum {
    POOL = 128, /* trajectories in the queues together: their state stays in the fastest cache */
    LANES = BATCH_WIDE * QUAD
};

#define TOL_MIN 1e-13
#define TOL_MAX 1e-2
/* Contact deeper than this, and not about to end (eta'^2 below DEEP_RATE eta^2), is worth a series in
 * time: it costs half of one in s and reaches as far. */
#define DEEP_ETA  0.3
#define DEEP_RATE 8.0
#define TURN_RAD  (2.0 * ELEMENTARY_PI)

/* First in, first out. */
struct queue {
    int at[POOL], head, n;
};

/* The trajectories first..first + n - 1 of a batch, on their way. */
struct pool {
    int first, n, n_tones, intervals;
    double tol, log2_tol;
    double *samples;
    double eta[POOL], rate[POOL];
    double root[POOL];         /* sqrt(eta) where a piece in s ended, -1 elsewhere */
    double time[POOL];         /* since the last sample */
    double size[POOL];         /* a power of two, at most 1: what the tolerance is relative to */
    double log2_allowed[POOL]; /* error that a series may leave */
    double shallow[POOL];      /* below this eta, and slow, the contact's force is below what is allowed */
    double phase[BATCH_TONES][POOL], turning[BATCH_TONES][POOL]; /* turns at the last sample; turns a time */
    bool closed[POOL];
    bool astray[POOL];            /* a series in time was no good: the next one is in s */
    int left[POOL], pieces[POOL]; /* intervals to go; series since the last sample */
    struct queue queue[BATCH_KINDS];
};

static void push(struct queue *q, int i)
{
    q->at[(q->head + q->n++) % POOL] = i;
}

static int pop(struct queue *q)
{
    int i = q->at[q->head];
    q->head = (q->head + 1) % POOL;
    q->n--;
    return i;
}

/* ---- the size of a motion, as in firmware/method/taylor/taylor_size.c ---- */

/* A motion that begins has this size, and allows an error as large as the rounding of a state about 1. */
#define SIZE_MIN         0x1p-60
#define LOG2_ALLOWED_MIN (-53.0)
/* From a motion of half the contact's length on, nothing is tightened. */
#define SPARE 2.0

/* The motion has this size, and what follows from it. */
static void set_size(struct pool *p, const struct batch_taylor *b, int i, double size)
{
    const uint64_t exponent = UINT64_C(0x7FF0000000000000);
    uint64_t word;
    memcpy(&word, &size, sizeof word);
    word &= exponent;
    memcpy(&p->size[i], &word, sizeof word);
    p->log2_allowed[i] = fmax(p->log2_tol + (double)((int)(word >> 52) - 1023), LOG2_ALLOWED_MIN);
    p->shallow[i] = 0.5 * sqrt(p->tol * p->size[i] / fmax(1.0, fabs(b->hertz[p->first + i])));
}

/* A piece begins. */
static void measure(struct pool *p, struct batch_taylor *b, int i)
{
    int k = p->first + i;
    b->most[k] = fmax(b->most[k], fabs(p->eta[i] - b->rest[k]) * b->pace[k]);
    b->most_rate[k] = fmax(b->most_rate[k], fabs(p->rate[i]));
    double size = SPARE * fmin(b->most[k], b->most_rate[k]);
    if (p->size[i] < 1.0 && size >= 2.0 * p->size[i])
        set_size(p, b, i, fmin(size, 1.0));
}

/* Into the queue of its next piece. */
static void enqueue(struct pool *p, int i)
{
    double eta = p->eta[i], rate = p->rate[i], shallow = p->shallow[i];
    bool slow = rate * rate < DEEP_RATE * (eta * eta);
    enum batch_kind kind = BATCH_FLIGHT;
    if (p->closed[i] && eta < shallow && rate * rate < 4.0 * shallow)
        kind = BATCH_SHALLOW;
    else if (p->closed[i])
        kind = eta > DEEP_ETA && slow && !p->astray[i] ? BATCH_DEEP : BATCH_REGULAR;
    push(&p->queue[kind], i);
}

/* ---- a piece ---- */

static void load_piece(const struct pool *p, const struct batch_taylor *b, struct batch_piece *c,
                       struct batch_load *load)
{
    int first = p->first;
    c->eta = gather(p->eta, c->at);
    c->rate = gather(p->rate, c->at);
    c->begin = gather(p->time, c->at);
    c->shallow = gather(p->shallow, c->at);
    c->log2_tol = gather(p->log2_allowed, c->at);
    quad known = gather(p->root, c->at);
    c->y = where(known >= 0.0, known, root(greater(c->eta, all_lanes(0.0))));
    load->damping = gather(b->damping + first, c->at);
    load->stiffness = gather(b->stiffness + first, c->at);
    load->constant = gather(b->constant + first, c->at);
    load->hertz = gather(b->hertz + first, c->at);
    for (int t = 0; t < p->n_tones; t++) {
        quad cosine, sine, amplitude = gather(b->tone[t].amplitude + first, c->at);
        load->tone[t].omega = gather(b->tone[t].omega + first, c->at);
        cos_sin_of(gather(p->phase[t], c->at) + c->begin * gather(p->turning[t], c->at), &cosine, &sine);
        load->tone[t].p = amplitude * cosine;
        load->tone[t].q = -amplitude * sine;
    }
}

/* ---- samples ---- */

/* Trajectory i has reached the end of an interval. */
static void sample(struct pool *p, struct batch_taylor *b, int i, double eta, double rate)
{
    int k = p->first + i;
    if (p->samples) {
        double *at = p->samples + 2 * (size_t)(p->intervals - p->left[i]) * (size_t)b->n + k;
        at[0] = eta;
        at[b->n] = rate;
    }
    b->eta[k] = eta;
    b->rate[k] = rate;
    b->intervals[k]++;
    p->left[i]--;
    p->pieces[i] = 0;
    for (int t = 0; t < BATCH_TONES; t++) {
        b->tone[t].phase[k] += turns_of(p->turning[t][i] * b->interval[k]);
        p->phase[t][i] = turns_to_double(b->tone[t].phase[k]);
    }
}

/* All ends of intervals inside the piece: each round uses up one of those that are left. */
static void take_samples(struct pool *p, struct batch_taylor *b, const struct batch_series *s,
                         struct batch_piece *c)
{
    struct batch_reading r;
    quad interval = gather(b->interval + p->first, c->at);
    mask live = (mask){0, 1, 2, 3} < c->n;
    for (;;) {
        quad more = interval - c->begin;
        mask due = live & (more <= c->duration);
        if (!any_lane(due))
            return;
        batch_piece_read(s, c, more, due, &r);
        c->residual |= due & r.residual;
        c->begin -= where(due, interval, all_lanes(0.0));
        for (int j = 0; j < QUAD; j++) {
            if (due[j])
                sample(p, b, c->at[j], r.eta[j], r.rate[j]);
            if (p->left[c->at[j]] == 0)
                live[j] = 0;
        }
    }
}

/* ---- the pool ---- */

static void fail(struct pool *p, struct batch_taylor *b, int i, enum batch_status why)
{
    b->status[p->first + i] = why;
    for (int j = p->intervals - p->left[i]; p->samples && j < p->intervals; j++) {
        double *at = p->samples + 2 * (size_t)j * (size_t)b->n + p->first + i;
        at[0] = at[b->n] = (double)NAN;
    }
    p->left[i] = 0;
}

/* Lane j of a finished piece: the trajectory goes on from its end, is done, or has failed. */
static void finish_lane(struct pool *p, struct batch_taylor *b, const struct batch_piece *c, int j)
{
    int i = c->at[j];
    b->residuals[p->first + i] += c->residual[j] & 1;
    if (p->left[i] == 0)
        return;
    p->eta[i] = c->eta[j];
    p->rate[i] = c->rate[j];
    p->root[i] = c->y[j];
    p->time[i] = c->begin[j] + c->duration[j];
    p->astray[i] = c->astray[j] != 0;
    if (c->event[j]) {
        b->liftoffs[p->first + i] += p->closed[i];
        p->closed[i] = !p->closed[i];
    }
    if (!(fabs(p->eta[i]) <= BATCH_LIMIT && fabs(p->rate[i]) <= BATCH_LIMIT && p->time[i] <= BATCH_LIMIT))
        fail(p, b, i, BATCH_ESCAPED);
    else if (++p->pieces[i] >= BATCH_PIECES)
        fail(p, b, i, BATCH_BUDGET);
    else {
        measure(p, b, i);
        enqueue(p, i);
    }
}

/* One piece of up to eight trajectories from this queue. */
static void advance(struct pool *p, struct batch_taylor *b, enum batch_kind kind)
{
    struct batch_series s[BATCH_WIDE];
    struct batch_piece c[BATCH_WIDE];
    struct batch_load load[BATCH_WIDE];
    quad x[BATCH_WIDE], v[BATCH_WIDE];
    int at[LANES], n = 0;
    while (n < LANES && p->queue[kind].n > 0)
        at[n++] = pop(&p->queue[kind]);
    for (int i = n; i < LANES; i++)
        at[i] = at[0];
    for (int i = 0; i < BATCH_WIDE; i++) {
        c[i].at = at + i * QUAD;
        c[i].n = n - i * QUAD;
        c[i].kind = kind;
        load_piece(p, b, &c[i], &load[i]);
        x[i] = kind == BATCH_REGULAR ? c[i].y : c[i].eta;
        v[i] = c[i].rate;
    }
    if (kind == BATCH_REGULAR)
        batch_series_regular(load, p->n_tones, x, v, s);
    else if (kind == BATCH_DEEP)
        batch_series_contact(load, p->n_tones, x, v, s);
    else
        batch_series_flight(load, p->n_tones, x, v, s);
    for (int i = 0; i < BATCH_WIDE; i++) {
        batch_piece_end(&s[i], p->tol, &c[i]);
        take_samples(p, b, &s[i], &c[i]);
    }
    for (int i = 0; i < n; i++)
        finish_lane(p, b, &c[i / QUAD], i % QUAD);
}

static void load_pool(struct pool *p, struct batch_taylor *b)
{
    memset(p->queue, 0, sizeof p->queue);
    for (int i = 0; i < p->n; i++) {
        int k = p->first + i;
        p->eta[i] = b->eta[k];
        p->rate[i] = b->rate[k];
        p->root[i] = -1.0;
        p->time[i] = 0.0;
        set_size(p, b, i, SIZE_MIN);
        measure(p, b, i);
        p->closed[i] = b->eta[k] > 0.0 || (b->eta[k] == 0.0 && b->rate[k] >= 0.0);
        p->left[i] = p->intervals;
        p->pieces[i] = 0;
        p->astray[i] = false;
        for (int t = 0; t < BATCH_TONES; t++) {
            p->turning[t][i] = b->tone[t].omega[k] / TURN_RAD;
            p->phase[t][i] = turns_to_double(b->tone[t].phase[k]);
        }
        if (b->status[k] == BATCH_GOOD)
            enqueue(p, i);
        else
            fail(p, b, i, (enum batch_status)b->status[k]);
    }
}

/* Ends because no trajectory takes more than BATCH_PIECES an interval. */
static void run(struct pool *p, struct batch_taylor *b)
{
    for (;;) {
        int longest = 0;
        for (int k = 1; k < BATCH_KINDS; k++)
            longest = p->queue[k].n > p->queue[longest].n ? k : longest;
        if (p->queue[longest].n == 0)
            return;
        advance(p, b, (enum batch_kind)longest);
    }
}

/* The fewest tones that hold every trajectory: what is left out adds zeros, so that the bits are the same. */
static int count_tones(const struct batch_taylor *b)
{
    bool two = false, full = false;
    for (int i = 0; i < b->n; i++) {
        two |= b->tone[1].amplitude[i] != 0.0;
        full |= b->stiffness[i] != 0.0 || b->tone[BATCH_STIFFNESS_TONE].amplitude[i] != 0.0;
    }
    return full ? BATCH_TONES : two ? 2 : 1;
}

const char *batch_taylor_plain(struct batch_taylor *b, double tol, int intervals, double *samples)
{
    struct pool p = {.samples = samples, .intervals = intervals, .tol = tol};
    if (!(tol >= TOL_MIN && tol <= TOL_MAX))
        return "batch_taylor: tolerance outside 1e-13..1e-2";
    if (intervals < 1)
        return intervals < 0 ? "batch_taylor: negative number of intervals" : NULL;
    /* A longer series ends nearer its radius of convergence, and more is left beyond its last term. */
    p.log2_tol = logarithm(tol) * 1.4426950408889634 - (BATCH_ORDER - 12);
    p.n_tones = count_tones(b);
    for (p.first = 0; p.first < b->n; p.first += POOL) {
        p.n = b->n - p.first < POOL ? b->n - p.first : POOL;
        load_pool(&p, b);
        run(&p, b);
    }
    return NULL;
}
