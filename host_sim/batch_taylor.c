/* batch_taylor.c - power series, eight trajectories of one kind of motion at a time; see batch_taylor.h.
 *
 * Each trajectory has its own time and takes its own pieces, as in firmware/taylor_piece.c: a series in time in flight and
 * in deep contact; in s with eta = y^2 where contact is about to end or has just begun; and as if in flight, looking for
 * both ends, where contact is so shallow and slow that its force is below the tolerance. What differs from trajectory to
 * trajectory is no branch inside a vector: those that wait for the same kind of series stand in a queue, and eight are
 * taken from the longest. */
#include <math.h>
#include <string.h>
#include "host_sim/batch_series.h"
#include "models/elementary.h"

enum {
    POOL = 128, /* trajectories in the queues together: their state stays in the fastest cache */
    LANES = BATCH_WIDE * QUAD,
    SOLVE = 20 /* Newton steps from a time to s; 2 or 3 are usual */
};

/* The largest reach, log2: a series whose last terms vanish by chance is not trusted further. */
#define REACH_TIME    3.0
#define REACH_REGULAR 1.0
#define TOL_MIN       1e-13
#define TOL_MAX       1e-2
/* Contact deeper than this, and not about to end (eta'^2 below DEEP_RATE eta^2), is worth a series in time: it costs half
 * of one in s and reaches as far. */
#define DEEP_ETA  0.3
#define DEEP_RATE 8.0
/* A series may be off zero at its root by this, relative to 1 + |eta| + |rate| at its beginning. */
#define RESIDUAL 1e-11
#define TURN_RAD (2.0 * ELEMENTARY_PI)

enum kind { FLIGHT, SHALLOW, DEEP, REGULAR, KINDS };

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
    double root[POOL];    /* sqrt(eta) where a piece in s ended, -1 elsewhere */
    double time[POOL];    /* since the last sample */
    double shallow[POOL]; /* below this eta, and slow, the contact's force is below the tolerance */
    double phase[BATCH_TONES][POOL], turning[BATCH_TONES][POOL]; /* turns at the last sample; turns a time */
    bool closed[POOL];
    bool astray[POOL];            /* a series in time was no good: the next one is in s */
    int left[POOL], pieces[POOL]; /* intervals to go; series since the last sample */
    struct queue queue[KINDS];
};

/* One piece of four trajectories. */
struct piece {
    const int *at;
    int n; /* lanes from here on only repeat the first */
    enum kind kind;
    quad eta, rate; /* at the beginning; then at the end */
    quad y;         /* sqrt(eta) of a piece in s; -1 at the end of another */
    quad begin;     /* since the last sample */
    quad shallow;
    quad x, duration; /* of the whole piece: s or time; time */
    mask event, residual, astray;
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

/* Into the queue of its next piece. */
static void enqueue(struct pool *p, int i)
{
    double eta = p->eta[i], rate = p->rate[i], shallow = p->shallow[i];
    bool slow = rate * rate < DEEP_RATE * (eta * eta);
    enum kind kind = FLIGHT;
    if (p->closed[i] && eta < shallow && rate * rate < 4.0 * shallow)
        kind = SHALLOW;
    else if (p->closed[i])
        kind = eta > DEEP_ETA && slow && !p->astray[i] ? DEEP : REGULAR;
    push(&p->queue[kind], i);
}

/* ---- a piece ---- */

static void load_piece(const struct pool *p, const struct batch_taylor *b, struct piece *c,
                       struct batch_load *load)
{
    int first = p->first;
    c->eta = gather(p->eta, c->at);
    c->rate = gather(p->rate, c->at);
    c->begin = gather(p->time, c->at);
    c->shallow = gather(p->shallow, c->at);
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

/* log2 and 2^x by exponent bits, within 6 %: only for step lengths. Whole numbers pass through the lowest bits of
 * 1.5 * 2^52, because vectors convert no 64-bit integers before AVX-512. */
ALWAYS_INLINE quad rough_log2(quad x)
{
    const double whole = 0x1.8p52;
    bits high = ((bits)x >> 20) + (bits)all_lanes(whole);
    return ((quad)high - whole) * 0x1p-32 - 1023.0;
}

ALWAYS_INLINE quad rough_exp2(quad e)
{
    const double whole = 0x1.8p52;
    quad scaled = (e + 1023.0) * 0x1p32 + whole;
    return (quad)(((bits)scaled - (bits)all_lanes(whole)) << 20);
}

/* The x up to which the last two terms stay below the tolerance, which is relative where eta is large. */
static void reach(const struct batch_series *s, double log2_tol, double cap, struct piece *c)
{
    quad tol = log2_tol + greater(rough_log2(magnitude(c->eta) + 1e-300), all_lanes(0.0));
    quad last = magnitude(s->a[BATCH_ORDER]) + magnitude(s->b[BATCH_ORDER]);
    quad before = magnitude(s->a[BATCH_ORDER - 1]) + magnitude(s->b[BATCH_ORDER - 1]);
    quad x = (tol - rough_log2(last + 1e-300)) * (1.0 / BATCH_ORDER);
    quad z = (tol - rough_log2(before + 1e-300)) * (1.0 / (BATCH_ORDER - 1));
    c->x = rough_exp2(lesser(lesser(x, z), all_lanes(cap)));
}

static void end_at_root(const struct batch_series *s, double sign, struct piece *c)
{
    struct batch_root r;
    batch_series_root(s, sign, &c->x, &r);
    c->x = where(r.found, r.at, c->x);
    c->event = r.found;
    c->residual = r.residual;
}

/* Shallow contact ends where it opens, or where it is no longer shallow. */
static void end_shallow(struct batch_series *s, struct piece *c)
{
    struct batch_root r;
    quad depth = 2.0 * c->shallow;
    c->x = lesser(c->x, 8.0 * root(c->shallow));
    end_at_root(s, -1.0, c);
    s->a[0] -= depth;
    batch_series_root(s, 1.0, &c->x, &r);
    s->a[0] += depth;
    c->x = where(r.found, r.at, c->x);
    c->event &= ~r.found;
    c->residual |= r.residual;
}

/* Contact in time: near grazing it can converge to the negative branch of the root, so its force is compared with that of
 * its own end. */
static void end_deep(const struct batch_series *s, double tol, struct piece *c)
{
    quad eta = series_value(s->a, c->x), force = series_value(s->force, c->x), expected = contact_force(eta);
    mask good = (eta > 0.0) & (magnitude(force - expected) <= 0.05 * expected + 10.0 * tol);
    c->x = where(good, c->x, all_lanes(0.0));
    c->astray = ~good;
}

/* How far a piece goes, and what it ends with. */
static void end_piece(struct batch_series *s, const struct pool *p, struct piece *c)
{
    c->event = c->residual = c->astray = (mask){0};
    reach(s, p->log2_tol, c->kind == REGULAR ? REACH_REGULAR : REACH_TIME, c);
    if (c->kind == SHALLOW)
        end_shallow(s, c);
    else if (c->kind == DEEP)
        end_deep(s, p->tol, c);
    else
        end_at_root(s, c->kind == REGULAR ? -1.0 : 1.0, c);
    quad value = series_value(s->a, c->x);
    quad bound = RESIDUAL * ((1.0 + magnitude(c->eta)) + magnitude(c->rate));
    c->residual |= c->event & ~(mask)(magnitude(value) <= bound);
    c->rate = series_value(s->b, c->x);
    c->duration = c->kind == REGULAR ? series_value(s->time, c->x) : c->x;
    value = where(c->event, all_lanes(0.0), value);
    c->eta = c->kind == REGULAR ? value * value : value;
    c->y = c->kind == REGULAR ? value : all_lanes(-1.0);
}

/* ---- samples ---- */

/* eta and its rate `more` after the piece's beginning, where `lanes`. */
struct reading {
    quad eta, rate;
    mask residual;
};

/* s where time(s) = more: first from a constant and a linear rate, then Newton with t' = 2 y inside the piece. The last
 * correction is small enough to carry y and w along by their slopes. */
static void read_regular(const struct batch_series *s, const struct piece *c, quad more, mask lanes,
                         struct reading *r)
{
    quad y = s->a[0], w = s->b[0], slope = s->b[1], lo = all_lanes(0.0), hi = c->x, move = lo;
    quad square = greater(y * y + w * more, lo), z = more / (y + root(square));
    z -= z * z * z * slope * (1.0 / 6.0) / (y + w * z);
    for (int i = 0; i < SOLVE && any_lane(lanes); i++) {
        z = where((z >= lo) & (z <= hi), z, 0.5 * (lo + hi));
        quad late = more - series_value(s->time, z), new_y = series_value(s->a, z),
             new_w = series_value(s->b, z);
        quad new_move = late / (2.0 * new_y);
        mask close = new_move * new_move * (magnitude(new_w) + 1.0) <= 1e-15 * new_y;
        y = where(lanes, new_y, y);
        w = where(lanes, new_w, w);
        move = where(lanes & close, new_move, move);
        lanes &= ~close;
        lo = where(lanes & (late > 0.0), z, lo);
        hi = where(lanes & (late <= 0.0), z, hi);
        z = where(lanes, z + new_move, z);
    }
    y += move * w;
    r->eta = y * y;
    r->rate = w + move * series_slope(s->b, z);
    r->residual = lanes;
}

static void read_time(const struct batch_series *s, quad more, struct reading *r)
{
    r->eta = series_value(s->a, more);
    r->rate = series_value(s->b, more);
    r->residual = (mask){0};
}

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
                         struct piece *c)
{
    struct reading r;
    quad interval = gather(b->interval + p->first, c->at);
    mask live = (mask){0, 1, 2, 3} < c->n;
    for (;;) {
        quad more = interval - c->begin;
        mask due = live & (more <= c->duration);
        if (!any_lane(due))
            return;
        if (c->kind == REGULAR)
            read_regular(s, c, more, due, &r);
        else
            read_time(s, more, &r);
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
static void finish_lane(struct pool *p, struct batch_taylor *b, const struct piece *c, int j)
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
    else
        enqueue(p, i);
}

/* One piece of up to eight trajectories from this queue. */
static void advance(struct pool *p, struct batch_taylor *b, enum kind kind)
{
    struct batch_series s[BATCH_WIDE];
    struct piece c[BATCH_WIDE];
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
        x[i] = kind == REGULAR ? c[i].y : c[i].eta;
        v[i] = c[i].rate;
    }
    if (kind == REGULAR)
        batch_series_regular(load, p->n_tones, x, v, s);
    else if (kind == DEEP)
        batch_series_contact(load, p->n_tones, x, v, s);
    else
        batch_series_flight(load, p->n_tones, x, v, s);
    for (int i = 0; i < BATCH_WIDE; i++) {
        end_piece(&s[i], p, &c[i]);
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
        p->shallow[i] = 0.5 * sqrt(p->tol / fmax(1.0, fabs(b->hertz[k])));
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
        for (int k = 1; k < KINDS; k++)
            longest = p->queue[k].n > p->queue[longest].n ? k : longest;
        if (p->queue[longest].n == 0)
            return;
        advance(p, b, (enum kind)longest);
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
