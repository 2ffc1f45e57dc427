/* taylor_piece.c - the kinds of expansion, their reach and their ends; see taylor_piece.h. */
#include "firmware/method/taylor/taylor_piece.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_regular.h"
#include "firmware/method/taylor/taylor_root.h"

/* Contact that ends later than this takes a series in time: it reaches as far as one in s, and costs half.
 * The limits are in model time and in radians of the fastest tone. */
#define PLAIN_FAR  0.8
#define PLAIN_TURN 0.5
/* A coordinate beyond this, in units of the contact, where nothing pulls it back: the motion has escaped. */
#define ESCAPE 1e6

/* The largest reach, log2: a series whose last terms vanish by chance is not trusted further. */
enum { REACH_TIME = 3, REACH_REGULAR = 1, SOLVE = 20 };

/* log2 and 2^x by exponent bits, within 6 %: only for step lengths. */
static double rough_log2(double x)
{
    int64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (double)(bits - INT64_C(0x3FF0000000000000)) * 0x1p-52;
}

static double rough_exp2(double e)
{
    int64_t bits = (int64_t)((e + 1023.0) * 0x1p52);
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Weight of the two terms before the last two of a series: they are that much larger where it ends. */
#define EARLIER 0.02

/* Pieces shorter than this, log2, share what one is allowed: under a fast drive their errors add up. */
#define REACH_MANY (-3.0)

/* log2 of the x where x^order is below 2^excess. */
static double reach_of(double excess, int order)
{
    double x = excess * (1.0 / order);
    return x > REACH_MANY ? x : (excess - REACH_MANY) * (1.0 / (order - 1));
}

/* The x where both last x^order and before x^(order - 1) are below what is allowed, which is relative where
 * eta is large. */
static double reach(const struct taylor *t, double last, double before, int order, int cap)
{
    double size = rough_log2(fabs(t->eta) + 1e-300),
           tol = size > 0.0 ? t->log2_allowed + size : t->log2_allowed;
    double x = reach_of(tol - rough_log2(fabs(last) + 1e-300), order);
    double y = reach_of(tol - rough_log2(fabs(before) + 1e-300), order - 1);
    x = y < x ? y : x;
    return rough_exp2(x < cap ? x : cap);
}

/* The reach of a series in time, by the series of the rate: its tail is the larger one wherever a piece is
 * shorter than a time unit. Two tones can make the last two terms vanish together, so the two before them
 * must be small, too. */
static double reach_time(const struct taylor *t)
{
    const double *a = t->a;
    double x = reach(t, a[TAYLOR_ORDER] * TAYLOR_ORDER, a[TAYLOR_ORDER - 1] * (TAYLOR_ORDER - 1),
                     TAYLOR_ORDER - 1, REACH_TIME);
    double y = reach(t, a[TAYLOR_ORDER - 2] * ((TAYLOR_ORDER - 2) * EARLIER),
                     a[TAYLOR_ORDER - 3] * ((TAYLOR_ORDER - 3) * EARLIER), TAYLOR_ORDER - 3, REACH_TIME);
    return y < x ? y : x;
}

static double least(double a, double b)
{
    return a < b ? a : b;
}

/* The piece in time up to x, or up to where sign * eta turns positive. */
static void end_at(struct taylor *t, double sign, double x)
{
    struct taylor_root root;
    t->kind = TAYLOR_TIME;
    t->end = x;
    if (!taylor_first_root(t->a, sign, x, &root))
        return;
    t->end = root.at;
    t->event = true;
    t->residual = root.residual;
}

/* Contact so shallow and slow that its force is below the error allowed. There s would stall, because y = w =
 * 0 is a saddle. The coordinate follows the load alone until it is twice as deep or the contact opens. */
static void begin_shallow(struct taylor *t, const struct taylor_load *load)
{
    struct taylor_root root;
    double depth = 2.0 * t->shallow;
    taylor_flight(load, t->eta, t->rate, t->a);
    end_at(t, -1.0, least(reach_time(t), 8.0 * sqrt(t->shallow)));
    t->a[0] -= depth;
    if (taylor_first_root(t->a, 1.0, t->end, &root)) {
        t->end = root.at;
        t->event = false;
    }
    t->a[0] += depth;
}

/* Is a series in time worth it? It reaches about half as far as the nearest complex zero of the parabola
 * through eta, rate and acceleration. */
static bool far_from_zero(const struct taylor *t, const struct taylor_load *load, double horizon)
{
    double eta = t->eta, v = t->rate, k = load->constant[1], a = load->constant[0], fastest = 0.0;
    for (int i = 0; i < load->n_tones; i++) {
        const struct taylor_tone *tone = &load->tone[i];
        a += tone->lane == 0 ? tone->p : 0.0;
        k += tone->lane == 1 ? tone->p : 0.0;
        fastest = tone->omega > fastest ? tone->omega : fastest;
    }
    a -= k * (eta * sqrt(eta)) + load->damping * v + load->stiffness * eta;
    double far = least(fastest * PLAIN_FAR > PLAIN_TURN ? PLAIN_TURN / fastest : PLAIN_FAR, 2.0 * horizon);
    /* distance of the nearer root, squared: the complex pair's 2 eta/a, or (2 eta/(|v| + root of v^2 - 2 a
     * eta))^2 */
    double discriminant = v * v - 2.0 * a * eta;
    if (discriminant <= 0.0)
        return 2.0 * eta > far * far * a;
    return 2.0 * eta > far * (fabs(v) + sqrt(discriminant));
}

/* Contact as a series in time. Near grazing it can converge to the negative branch of the root, so its force
 * is compared with that of its own end; false when they differ. */
static bool begin_plain(struct taylor *t, const struct taylor_load *load, double horizon)
{
    double force[TAYLOR_TERMS];
    taylor_contact(load, t->eta, t->rate, t->a, force);
    double x = least(reach_time(t), horizon);
    force[TAYLOR_ORDER - 1] = force[TAYLOR_ORDER] = 0.0;
    double eta = taylor_value(t->a, x), f = taylor_value(force, x);
    if (!(eta > 0.0))
        return false;
    double expected = eta * sqrt(eta);
    if (!(fabs(f - expected) <= 0.05 * expected + 10.0 * t->allowed))
        return false;
    t->kind = TAYLOR_TIME;
    t->end = x;
    return true;
}

static void begin_regular(struct taylor *t, const struct taylor_load *load, double horizon)
{
    struct taylor_root root;
    double y = t->root >= 0.0 ? t->root : sqrt(t->eta), w = t->rate;
    taylor_regular(load, y, w, t->a, t->b, t->c);
    double x =
        reach(t, fabs(t->a[TAYLOR_ORDER]) + fabs(t->b[TAYLOR_ORDER]),
              fabs(t->a[TAYLOR_ORDER - 1]) + fabs(t->b[TAYLOR_ORDER - 1]), TAYLOR_ORDER, REACH_REGULAR);
    double square = y * y + w * horizon;
    if (horizon < DBL_MAX && square > 0.0)
        x = least(x, 1.1 * horizon / (y + sqrt(square)));
    t->count.regular++;
    t->kind = TAYLOR_REGULAR;
    t->s = t->s_time = 0.0;
    t->y = y;
    t->w = w;
    t->w_slope = t->b[1];
    t->s_end = x;
    if (taylor_first_root(t->a, -1.0, x, &root)) {
        t->s_end = root.at;
        t->event = true;
        t->residual = root.residual;
    }
    t->end = taylor_value(t->c, t->s_end);
}

/* The switch stands at the very start: regime and coordinate disagree, because inputs or parameters
 * jumped. */
static void begin_switch(struct taylor *t)
{
    memset(t->a, 0, sizeof t->a);
    t->a[0] = t->eta;
    t->a[1] = t->rate;
    t->kind = TAYLOR_TIME;
    t->end = 0.0;
    t->event = true;
}

static void begin_contact(struct taylor *t, const struct taylor_load *load, double horizon)
{
    double side = t->closed ? 1.0 : -1.0;
    if (side * t->eta < 0.0 || (t->eta == 0.0 && side * t->rate < 0.0)) {
        begin_switch(t);
    } else if (!t->closed) {
        taylor_flight(load, t->eta, t->rate, t->a);
        end_at(t, 1.0, least(reach_time(t), horizon));
    } else if (t->eta < t->shallow && t->rate * t->rate < 4.0 * t->shallow) {
        begin_shallow(t, load);
    } else if (!(far_from_zero(t, load, horizon) && begin_plain(t, load, horizon))) {
        begin_regular(t, load, horizon);
    }
}

bool taylor_begin(struct taylor *t, const struct taylor_load *load, double left, bool short_lived)
{
    double horizon = short_lived ? left : DBL_MAX;
    t->now = 0.0;
    t->event = t->residual = false;
    if (t->contact) {
        begin_contact(t, load, horizon);
    } else {
        taylor_polynomial(load, t->eta, t->rate, t->a);
        t->kind = TAYLOR_TIME;
        t->end = least(reach_time(t), horizon);
    }
    t->count.time += t->kind == TAYLOR_TIME;
    bool escaped = t->escapes && t->closed && !(fabs(t->eta) <= ESCAPE);
    return !escaped && fabs(t->a[TAYLOR_ORDER]) + fabs(t->a[TAYLOR_ORDER - 1]) + fabs(t->end) <= DBL_MAX;
}

/* Finds s with t(s) = now: first the cubic at the last reading, then Newton with t' = 2 y, kept inside the
 * piece. The last correction is so small that y and w follow by their slopes. */
static void solve(struct taylor *t)
{
    double lo = t->s, hi = t->s_end, more = t->now - t->s_time;
    double square = t->y * t->y + t->w * more, d = square > 0.0 ? more / (t->y + sqrt(square)) : hi - lo;
    double slope = 2.0 * (t->y + t->w * d);
    if (slope > 0.0)
        d -= d * d * d * t->w_slope * (1.0 / 3.0) / slope;
    double s = lo + d, y = t->y, w = t->w, move = 0.0;
    for (int i = 0; i < SOLVE; i++) {
        if (!(s >= lo && s <= hi))
            s = 0.5 * (lo + hi);
        double time = taylor_value(t->c, s);
        y = taylor_value(t->a, s);
        w = taylor_value(t->b, s);
        move = (t->now - time) / (2.0 * y);
        if (move * move * (fabs(w) + 1.0) <= 1e-15 * y)
            break;
        if (time < t->now)
            lo = s;
        else
            hi = s;
        s += move;
        move = 0.0;
    }
    t->w_slope = taylor_jet_at(t->b, s).slope;
    t->s = s + move;
    t->s_time = t->now;
    t->y = y + move * (w + 0.5 * move * t->w_slope);
    t->w = w + move * t->w_slope;
}

void taylor_read(struct taylor *t)
{
    if (t->kind == TAYLOR_TIME) {
        struct taylor_jet here = taylor_jet_at(t->a, t->now);
        t->eta = here.value;
        t->rate = here.slope;
        t->root = -1.0;
        return;
    }
    solve(t);
    t->eta = t->y * t->y;
    t->rate = t->w;
    t->root = t->y;
}

void taylor_finish(struct taylor *t)
{
    double jump = t->end; /* 0: a switch at the start leaves the coordinate where it is */
    t->now = t->end;
    if (t->kind == TAYLOR_TIME) {
        taylor_read(t);
    } else {
        t->root = taylor_value(t->a, t->s_end);
        t->rate = taylor_value(t->b, t->s_end);
        t->eta = t->root * t->root;
    }
    t->kind = TAYLOR_NONE;
    if (!t->event)
        return;
    t->closed = !t->closed;
    if (jump > 0.0)
        t->eta = t->root = 0.0;
}
