/* batch_rk4_steps.c - steps of 32 trajectories by the operations of firmware/method/rk4.c and of the models,
 * in their order.
 *
 * A step needs four square roots, which a processor takes one after the other. All else is arranged so that
 * the next root never waits. Eight quads run a stage each in turn, and operations that do not depend on the
 * state lie between the stages. */
#include "host_sim/batch/batch_rk4.h"

#include "host_sim/batch/batch_lanes.h"
#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"

enum { QUADS = BATCH_BLOCK / QUAD };

/* The load that depends on time alone. */
struct load {
    quad drive, stiffness;
    quad shift; /* between x and eta */
};

/* Four trajectories: what a step needs, in the words of firmware/method/rk4.c. */
struct four {
    quad x, v, largest;
    quad p[BATCH_NUMBERS], scale[BATCH_ROWS];
    quad h, half, quarter, square, sixth, sixth_square;
    struct load now; /* at the beginning of the step */
};

ALWAYS_INLINE quad get(const double *x)
{
    quad y;
    memcpy(&y, x, sizeof y);
    return y;
}

ALWAYS_INLINE void put(double *x, quad y)
{
    memcpy(x, &y, sizeof y);
}

/* ---- the models' equations ---- */

STATIC_ASSERT(RIG_FORCE == 0 && (int)ROLLING_FORCE == 0 && (int)TIP_FORCE == 0, the_force_is_the_first_input);
STATIC_ASSERT(RIG_P_TWO_XI == 0 && (int)ROLLING_P_TWO_ZETA == 0 && (int)TIP_P_DAMPING == 0,
              the_damping_is_the_first_number);

ALWAYS_INLINE quad input(const struct four *q, const struct batch_rk4_table *t, int row, int at)
{
    return q->scale[row] * t->at[row][at];
}

/* The load at half step `at` of the table. */
ALWAYS_INLINE void load(const struct four *q, enum batch_rk4_pattern pattern, const struct batch_rk4_table *t,
                        int at, struct load *l)
{
    quad force = input(q, t, 0, at);
    if (pattern == PATTERN_TIP) {
        l->drive = (1.0 + q->p[TIP_P_HERTZ]) + force;
        l->stiffness = q->p[TIP_P_HERTZ] * (1.0 + input(q, t, TIP_STIFFNESS, at));
        return;
    }
    if (pattern == PATTERN_FORCES || pattern == PATTERN_RIG)
        force += input(q, t, RIG_FAST_FORCE, at);
    l->drive = (2.0 / 3.0) * (1.0 + force);
    if (pattern == PATTERN_BASE || pattern == PATTERN_RIG) {
        l->drive += q->p[RIG_P_TWO_XI] * input(q, t, BATCH_BASE_RATE, at);
        l->shift = input(q, t, RIG_BASE, at);
    }
    if (pattern == PATTERN_RIG)
        l->stiffness = (2.0 / 3.0) * (1.0 + input(q, t, RIG_STIFFNESS, at));
    if (pattern == PATTERN_ROLLING)
        l->shift = input(q, t, ROLLING_WAVINESS, at);
}

ALWAYS_INLINE quad acceleration(const struct four *q, enum batch_rk4_pattern pattern, const struct load *l,
                                quad x, quad v)
{
    quad damper = q->p[RIG_P_TWO_XI] * v;
    switch (pattern) {
    case PATTERN_BASE:
        return (l->drive - damper) - (2.0 / 3.0) * contact_force(x - l->shift);
    case PATTERN_RIG:
        return (l->drive - damper) - l->stiffness * contact_force(x - l->shift);
    case PATTERN_ROLLING:
        return (l->drive - damper) - (2.0 / 3.0) * contact_force(x + l->shift);
    case PATTERN_TIP:
        return ((l->drive - x) - damper) - l->stiffness * contact_force(x);
    default:
        return (l->drive - damper) - (2.0 / 3.0) * contact_force(x);
    }
}

/* ---- the method ---- */

ALWAYS_INLINE void advance(struct four *four, enum batch_rk4_pattern pattern, const struct batch_rk4_table *t)
{
    quad y[QUADS], w[QUADS], half_way[QUADS], whole_way[QUADS], k1[QUADS], k2[QUADS], k3[QUADS];
    struct load middle[QUADS];
    for (int n = 0; n < t->steps; n++) {
        BATCH_UNROLL
        for (int i = 0; i < QUADS; i++) {
            struct four *q = &four[i];
            k1[i] = acceleration(q, pattern, &q->now, q->x, q->v);
            load(q, pattern, t, 2 * n + 1, &middle[i]);
            half_way[i] = q->x + q->half * q->v;
            w[i] = q->v + q->half * k1[i];
        }
        BATCH_UNROLL
        for (int i = 0; i < QUADS; i++) {
            struct four *q = &four[i];
            k2[i] = acceleration(q, pattern, &middle[i], half_way[i], w[i]);
            y[i] = half_way[i] + q->quarter * k1[i];
            w[i] = q->v + q->half * k2[i];
        }
        BATCH_UNROLL
        for (int i = 0; i < QUADS; i++) {
            struct four *q = &four[i];
            k3[i] = acceleration(q, pattern, &middle[i], y[i], w[i]);
            load(q, pattern, t, 2 * n + 2, &q->now);
            whole_way[i] = q->x + q->h * q->v;
            y[i] = whole_way[i] + q->square * k2[i];
            w[i] = q->v + q->h * k3[i];
        }
        BATCH_UNROLL
        for (int i = 0; i < QUADS; i++) {
            struct four *q = &four[i];
            quad k4 = acceleration(q, pattern, &q->now, y[i], w[i]), inner = k2[i] + k3[i];
            q->x = whole_way[i] + q->sixth_square * (k1[i] + inner);
            q->v = q->v + q->sixth * ((k1[i] + k4) + 2.0 * inner);
            q->largest = greater(q->largest, magnitude(q->x) + magnitude(q->v));
        }
    }
}

/* ---- blocks ---- */

static void read_block(struct four *four, const struct batch_rk4_block *k)
{
    for (int i = 0; i < QUADS; i++) {
        struct four *q = &four[i];
        int at = i * QUAD;
        for (int j = 0; j < BATCH_NUMBERS; j++)
            q->p[j] = get(&k->p[j][at]);
        for (int j = 0; j < BATCH_ROWS; j++)
            q->scale[j] = get(&k->scale[j][at]);
        q->x = get(&k->x[0][at]);
        q->v = get(&k->x[1][at]);
        q->largest = get(&k->largest[at]);
        q->h = get(&k->step[at]);
        q->half = 0.5 * q->h;
        q->quarter = q->half * q->half;
        q->square = q->half * q->h;
        q->sixth = q->h * (1.0 / 6.0);
        q->sixth_square = q->h * q->sixth;
    }
}

static void write_block(const struct four *four, struct batch_rk4_block *k)
{
    for (int i = 0; i < QUADS; i++) {
        put(&k->x[0][i * QUAD], four[i].x);
        put(&k->x[1][i * QUAD], four[i].v);
        put(&k->largest[i * QUAD], four[i].largest);
    }
}

ALWAYS_INLINE void run(struct four *four, enum batch_rk4_pattern pattern, const struct batch_rk4_table *t)
{
    for (int i = 0; i < QUADS; i++)
        load(&four[i], pattern, t, 0, &four[i].now);
    advance(four, pattern, t);
}

static void steps(struct batch_rk4_block *k, enum batch_rk4_pattern pattern, const struct batch_rk4_table *t)
{
    struct four four[QUADS];
    read_block(four, k);
    switch (pattern) {
    case PATTERN_FORCE:
        run(four, PATTERN_FORCE, t);
        break;
    case PATTERN_FORCES:
        run(four, PATTERN_FORCES, t);
        break;
    case PATTERN_BASE:
        run(four, PATTERN_BASE, t);
        break;
    case PATTERN_RIG:
        run(four, PATTERN_RIG, t);
        break;
    case PATTERN_ROLLING:
        run(four, PATTERN_ROLLING, t);
        break;
    case PATTERN_TIP:
        run(four, PATTERN_TIP, t);
        break;
    }
    write_block(four, k);
}

static void end(struct batch_rk4_block *k, int n, double *samples, int stride)
{
    for (int at = 0; at < BATCH_BLOCK; at += QUAD) {
        mask good, intervals;
        memcpy(&good, &k->good[at], sizeof good);
        memcpy(&intervals, &k->intervals[at], sizeof intervals);
        good &= get(&k->largest[at]) <= BATCH_RK4_LIMIT;
        intervals -= good;
        memcpy(&k->good[at], &good, sizeof good);
        memcpy(&k->intervals[at], &intervals, sizeof intervals);
        put(&k->largest[at], all_lanes(0.0));
        for (int j = 0; j < 2; j++) {
            quad x = get(&k->x[j][at]), stay = where(good, x, get(&k->end[j][at]));
            put(&k->x[j][at], stay);
            put(&k->end[j][at], stay);
            x = where(good, x, all_lanes((double)NAN));
            if (samples && n > at)
                memcpy(samples + j * stride + at, &x,
                       (size_t)(n - at < QUAD ? n - at : QUAD) * sizeof *samples);
        }
    }
}

const struct batch_rk4_kernel batch_rk4_plain = {steps, end};
