/* block.c - blocks of quiet ticks by rk4, one function per row of the table of instances; see block.h. */
#include "firmware/plant/block.h"

#include <math.h>
#include "firmware/method/instances.h"
#include "firmware/method/rk4_step.h"
#include "firmware/method/switch.h"
#include "firmware/plant/ledger_piece.h"
#include "firmware/plant/plant.h"

/* The model as compile-time constants of one instantiation. */
struct inlined {
    rhs_function *rhs;
    gap_function *gap;
    flow_function *flow;
    int n, n_contacts, n_inputs;
};

/* A steady drive: input = offset + amplitude cosine, rate = swing sine. */
struct voice {
    double offset, amplitude, swing;
    double half_cosine, half_sine; /* the rotation over half a tick */
    double cosine, sine;           /* at the start of the tick */
};

ALWAYS_INLINE struct voice voice_of(const struct drive *d, double ticks_per_time)
{
    double omega = d->omega_tick * ticks_per_time;
    return (struct voice){d->sample, d->amplitude, -d->amplitude * omega, d->half_cosine, d->half_sine,
                          d->cosine, d->sine};
}

ALWAYS_INLINE struct input voice_input(const struct voice *v, double cosine, double sine)
{
    return (struct input){v->offset + v->amplitude * cosine, v->swing * sine};
}

/* The ledger's sums that a block moves. */
ALWAYS_INLINE void copy_sums(struct inlined m, struct ledger *to, const struct ledger *from)
{
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        to->work[i] = from->work[i];
        to->flow.work[i] = from->flow.work[i];
    }
    UNROLL
    for (int i = 0; i < m.n; i++)
        to->flow.x_dot[i] = from->flow.x_dot[i];
    to->damping = from->damping;
    to->gross = from->gross;
    to->flow.damping = from->flow.damping;
    to->flow.force = from->flow.force;
}

/* A contact may switch between two instants, or the state leaves the numbers in which a model means something. */
ALWAYS_INLINE bool interrupted(struct inlined m, const struct input *g0, const struct input *g1, double h,
                               unsigned regime, const double *x)
{
    bool stop = false;
    double size = 0.0;
    UNROLL
    for (int i = 0; i < m.n; i++)
        size += fabs(x[i]);
    UNROLL
    for (int i = 0; i < m.n_contacts; i++)
        stop |= switch_suspected(&g0[i], &g1[i], h, (regime >> i) & 1u) || g1[i].value == 0.0;
    return stop || !(size <= PLANT_STATE_LIMIT);
}

/* Time goes on by `done` ticks of length h; the sums are those of so many single additions. */
static void count_time(struct plant *pl, uint32_t done, bool lost)
{
    for (uint32_t k = 0; k < done; k++)
        pl->total_time += pl->h;
    for (uint32_t k = 0; lost && k < done; k++)
        pl->loss_time += pl->h;
    pl->now.tick += done;
}

/* Where the drives stand after `done` ticks, and the inputs there. */
ALWAYS_INLINE void move_drives(struct inlined m, struct plant *pl, unsigned active, uint32_t done,
                               const struct voice *v, const struct input *now)
{
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        struct drive *d = &pl->drive[i];
        if (!((active >> i) & 1u))
            continue;
        d->carrier += d->step * done;
        d->resync_left -= done;
        d->cosine = v[i].cosine;
        d->sine = v[i].sine;
        pl->segment.at[2][i] = now[i];
    }
}

/* The end of tick k. */
ALWAYS_INLINE void write_down(struct inlined m, struct path *path, uint32_t k, unsigned active,
                              const double *x, const struct input *now, const struct voice *v)
{
    UNROLL
    for (int i = 0; i < m.n; i++)
        path->x[k][i] = x[i];
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        path->u[k][i] = now[i];
        if (!((active >> i) & 1u))
            continue;
        path->cosine[k][i] = v[i].cosine;
        path->sine[k][i] = v[i].sine;
    }
}

ALWAYS_INLINE uint32_t run(struct inlined m, struct plant *pl, uint32_t n, struct path *path)
{
    const double *p = pl->p;
    const double h = pl->h;
    const unsigned active = pl->segment.active, regime = pl->regime;
    double x[MODEL_STATES], x1[MODEL_STATES], peak = pl->peak_force;
    struct input now[MODEL_INPUTS], middle[MODEL_INPUTS], end[MODEL_INPUTS], g0[MODEL_CONTACTS],
        g1[MODEL_CONTACTS];
    struct voice v[MODEL_INPUTS], turned[MODEL_INPUTS];
    struct ledger own;
    uint32_t done = 0;
    UNROLL
    for (int i = 0; i < m.n_inputs; i++) {
        now[i] = middle[i] = end[i] = (struct input){0.0, 0.0};
        v[i] = turned[i] = (struct voice){.cosine = 1.0};
        if (!((active >> i) & 1u))
            continue;
        v[i] = voice_of(&pl->drive[i], pl->ticks_per_time);
        now[i] = voice_input(&v[i], v[i].cosine, v[i].sine);
    }
    UNROLL
    for (int i = 0; i < m.n; i++)
        x[i] = pl->x[i];
    copy_sums(m, &own, &pl->ledger);
    m.gap(p, now, x, g0);
    for (; done < n; done++) {
        UNROLL
        for (int i = 0; i < m.n_inputs; i++) {
            if (!((active >> i) & 1u))
                continue;
            double c = v[i].cosine, s = v[i].sine;
            drive_rotate(&c, &s, v[i].half_cosine, v[i].half_sine);
            middle[i] = voice_input(&v[i], c, s);
            drive_rotate(&c, &s, v[i].half_cosine, v[i].half_sine);
            end[i] = voice_input(&v[i], c, s);
            turned[i] = v[i];
            turned[i].cosine = c;
            turned[i].sine = s;
        }
        rk4_advance(m.rhs, m.n, p, h, now, middle, end, x, x1);
        m.gap(p, end, x1, g1);
        if (interrupted(m, g0, g1, h, regime, x1))
            break;
        peak = ledger_larger(peak, ledger_piece_inlined((struct ledger_model){m.flow, m.n, m.n_inputs}, &own,
                                                        p, active, h, middle, end, x, x1));
        UNROLL
        for (int i = 0; i < m.n; i++)
            x[i] = x1[i];
        UNROLL
        for (int i = 0; i < m.n_contacts; i++)
            g0[i] = g1[i];
        UNROLL
        for (int i = 0; i < m.n_inputs; i++) {
            now[i] = end[i];
            v[i] = turned[i];
        }
        if (path)
            write_down(m, path, done, active, x, now, v);
    }
    if (done == 0)
        return 0;
    UNROLL
    for (int i = 0; i < m.n; i++)
        pl->x[i] = x[i];
    copy_sums(m, &pl->ledger, &own);
    pl->peak_force = peak;
    move_drives(m, pl, active, done, v, now);
    count_time(pl, done, m.n_contacts > 0 && regime == 0);
    return done;
}

#define DECLARE(name, ...) static block_function block_##name;
INSTANCES(DECLARE)

#define JUMP(row, when)                                                                                      \
    if (when)                                                                                                \
        return block_##row(pl, n, path);

/* clang-format off */
#define BLOCK(name, for_models, jumps, states, contacts, n_inputs, rhs, gap, flow)                           \
    CALLED_FROM_ANYWHERE uint32_t block_##name(struct plant *pl, uint32_t n, struct path *path)                                 \
    {                                                                                                        \
        unsigned active = pl->segment.active;                                                                \
        (void)active;                                                                                        \
        jumps;                                                                                               \
        return run((struct inlined){rhs, gap, flow, states, contacts, n_inputs}, pl, n, path);                     \
    }
INSTANCES(BLOCK)
/* clang-format on */

block_function *block_bind(const struct model *m)
{
#define BIND(name, for_models, ...)                                                                          \
    if (for_models)                                                                                          \
        return block_##name;
    INSTANCES(BIND)
    return NULL;
}
