/* batch_piece.c - see batch_piece.h. */
#include "host_sim/batch/batch_piece.h"
#include "host_sim/batch/batch_root.h"

enum { SOLVE = 20 /* Newton steps from a time to s; 2 or 3 are usual */ };

/* The largest reach, log2: a series whose last terms vanish by chance is not trusted further. */
#define REACH_TIME    3.0
#define REACH_REGULAR 1.0
/* A series may be off zero at its root by this, relative to 1 + |eta| + |rate| at its beginning. */
#define RESIDUAL 1e-11

/* ---- the end ---- */

/* log2 and 2^x by exponent bits, within 6 %: only for step lengths. Whole numbers pass through the lowest
 * bits of 1.5 * 2^52, because vectors convert no 64-bit integers before AVX-512. */
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
static void reach(const struct batch_series *s, double cap, struct batch_piece *c)
{
    quad tol = c->log2_tol + greater(rough_log2(magnitude(c->eta) + 1e-300), all_lanes(0.0));
    quad last = magnitude(s->a[BATCH_ORDER]) + magnitude(s->b[BATCH_ORDER]);
    quad before = magnitude(s->a[BATCH_ORDER - 1]) + magnitude(s->b[BATCH_ORDER - 1]);
    quad x = (tol - rough_log2(last + 1e-300)) * (1.0 / BATCH_ORDER);
    quad z = (tol - rough_log2(before + 1e-300)) * (1.0 / (BATCH_ORDER - 1));
    c->x = rough_exp2(lesser(lesser(x, z), all_lanes(cap)));
}

static void end_at_root(const struct batch_series *s, double sign, struct batch_piece *c)
{
    struct batch_root r;
    batch_series_root(s, sign, &c->x, &r);
    c->x = where(r.found, r.at, c->x);
    c->event = r.found;
    c->residual = r.residual;
}

/* Shallow contact ends where it opens, or where it is no longer shallow. */
static void end_shallow(struct batch_series *s, struct batch_piece *c)
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

/* Contact in time: near grazing it can converge to the negative branch of the root, so its force is
 * compared with that of its own end. */
static void end_deep(const struct batch_series *s, double tol, struct batch_piece *c)
{
    quad eta = series_value(s->a, c->x), force = series_value(s->force, c->x), expected = contact_force(eta);
    mask good = (eta > 0.0) & (magnitude(force - expected) <= 0.05 * expected + 10.0 * tol);
    c->x = where(good, c->x, all_lanes(0.0));
    c->astray = ~good;
}

void batch_piece_end(struct batch_series *s, double tol, struct batch_piece *c)
{
    c->event = c->residual = c->astray = (mask){0};
    reach(s, c->kind == BATCH_REGULAR ? REACH_REGULAR : REACH_TIME, c);
    if (c->kind == BATCH_SHALLOW)
        end_shallow(s, c);
    else if (c->kind == BATCH_DEEP)
        end_deep(s, tol, c);
    else
        end_at_root(s, c->kind == BATCH_REGULAR ? -1.0 : 1.0, c);
    quad value = series_value(s->a, c->x);
    quad bound = RESIDUAL * ((1.0 + magnitude(c->eta)) + magnitude(c->rate));
    c->residual |= c->event & ~(mask)(magnitude(value) <= bound);
    c->rate = series_value(s->b, c->x);
    c->duration = c->kind == BATCH_REGULAR ? series_value(s->time, c->x) : c->x;
    value = where(c->event, all_lanes(0.0), value);
    c->eta = c->kind == BATCH_REGULAR ? value * value : value;
    c->y = c->kind == BATCH_REGULAR ? value : all_lanes(-1.0);
}

/* ---- readings ---- */

/* s where time(s) = more: first from a constant and a linear rate, then Newton with t' = 2 y inside the
 * piece. The last correction is small enough to carry y and w along by their slopes. */
static void read_regular(const struct batch_series *s, const struct batch_piece *c, quad more, mask lanes,
                         struct batch_reading *r)
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

static void read_time(const struct batch_series *s, quad more, struct batch_reading *r)
{
    r->eta = series_value(s->a, more);
    r->rate = series_value(s->b, more);
    r->residual = (mask){0};
}

void batch_piece_read(const struct batch_series *s, const struct batch_piece *c, quad more, mask lanes,
                      struct batch_reading *r)
{
    if (c->kind == BATCH_REGULAR)
        read_regular(s, c, more, lanes, r);
    else
        read_time(s, more, r);
}
