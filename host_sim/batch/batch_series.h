/* batch_series.h - the power series of batch_taylor: eight trajectories side by side, one kind of motion.
 *
 * The equation is that of batch_taylor.h. Series are in time tau (flight; contact that is kept), or in s
 * with eta = y^2, dt = 2 y ds, w = eta' (contact that is lost or just made:
 * firmware/method/taylor/taylor_regular.c says why). */
#ifndef HOST_SIM_BATCH_SERIES_H
#define HOST_SIM_BATCH_SERIES_H

#include "host_sim/batch/batch_taylor.h"
#include "host_sim/batch/batch_lanes.h"

enum {
    BATCH_ORDER = 14,
    BATCH_TERMS = BATCH_ORDER + 1,
    BATCH_WIDE = 2 /* quads: while one waits for its newest coefficient the other computes */
};

/* The load of four trajectories from one instant on: tones p(t) with p' = omega q, q' = -omega p. */
struct batch_load {
    quad damping, stiffness, constant, hertz;
    struct {
        quad omega, p, q;
    } tone[BATCH_TONES];
};

/* eta, eta' and, in contact, eta^{3/2} in tau; or y, w and the time in s. */
struct batch_series {
    quad a[BATCH_TERMS], b[BATCH_TERMS];
    union {
        quad time[BATCH_TERMS], force[BATCH_TERMS];
    };
};

/* n_tones: 1 or 2 of the force; BATCH_TONES for all and a stiffness. Each pointer to [BATCH_WIDE].
 * batch_series_regular starts from (y, w), the others from (eta, eta'); batch_series_contact from eta > 0. */
void batch_series_regular(const struct batch_load *load, int n_tones, const quad *y, const quad *w,
                          struct batch_series *s);
void batch_series_flight(const struct batch_load *load, int n_tones, const quad *eta, const quad *rate,
                         struct batch_series *s);
void batch_series_contact(const struct batch_load *load, int n_tones, const quad *eta, const quad *rate,
                          struct batch_series *s);

/* A series at x, in two halves of even and odd powers. */
ALWAYS_INLINE quad series_value(const quad *c, quad x)
{
    quad square = x * x, even = c[BATCH_ORDER], odd = c[BATCH_ORDER - 1];
    BATCH_UNROLL
    for (int n = BATCH_ORDER - 2; n >= 2; n -= 2) {
        even = even * square + c[n];
        odd = odd * square + c[n - 1];
    }
    return (even * square + c[0]) + odd * x;
}

ALWAYS_INLINE quad series_slope(const quad *c, quad x)
{
    quad square = x * x, even = BATCH_ORDER * c[BATCH_ORDER], odd = (BATCH_ORDER - 1) * c[BATCH_ORDER - 1];
    BATCH_UNROLL
    for (int n = BATCH_ORDER - 2; n >= 2; n -= 2) {
        even = even * square + n * c[n];
        odd = odd * square + (n - 1) * c[n - 1];
    }
    return odd + even * x;
}

#endif
