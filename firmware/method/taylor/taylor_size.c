/* taylor_size.c - the size of a motion, and the error that its series may leave.
 *
 * The tolerance is relative to the largest deviation from rest or to the largest rate so far, whichever is
 * smaller. So position and velocity both keep it. A motion that begins is small, and its first series are
 * short. The size is a power of two, so that it changes rarely. Together the long series of a motion leave
 * less than an eighth of the error that each is allowed, short ones less than a half (make tolerance). So
 * nothing is tightened for motions larger than an eighth or a half of the contact's length. */
#include "firmware/method/taylor/taylor_size.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include "firmware/method/taylor/taylor_piece.h"

/* Smallest error allowed: the rounding of a state that counts from the first touch and not from rest. */
#define ALLOWED_MIN      (0.5 * DBL_EPSILON)
#define LOG2_ALLOWED_MIN (-53.0)
#define SIZE_MIN         0x1p-60
#define LOG2_SIZE_MIN    (-60.0)

/* A long series leaves that much less of what it is allowed, and there are fewer. */
#define LONG      4.0
#define LOG2_LONG 2.0

/* A long series ends near its radius of convergence, where its remainder is larger than its last term. So it
 * gets a sixteenth of the tolerance. */
#define LOG2_BEYOND 4.0

static void allow(struct taylor *t, double log2_size)
{
    double strength = fabs(t->lanes.base[1]), allowed = t->tol * t->size, more = log2_size + LOG2_LONG;
    double log2 = t->log2_tol + (more < 0.0 ? more : 0.0), of_long = LONG * t->size;
    t->allowed_short = allowed > ALLOWED_MIN ? allowed : ALLOWED_MIN;
    allowed = t->tol * (of_long < 1.0 ? of_long : 1.0);
    t->allowed = allowed > ALLOWED_MIN ? allowed : ALLOWED_MIN;
    t->log2_allowed = (log2 > LOG2_ALLOWED_MIN ? log2 : LOG2_ALLOWED_MIN) - LOG2_BEYOND;
    t->shallow = 0.5 * sqrt(t->allowed / (strength > 1.0 ? strength : 1.0));
}

static bool sounds(const struct segment *e)
{
    for (int i = 0; i < MODEL_INPUTS; i++)
        if (((e->active >> i) & 1u) && (e->wave[i].amplitude != 0.0 || e->wave[i].growth != 0.0))
            return true;
    return false;
}

/* A motion begins at x. Without a drive its speed will become deviation, and its imbalance speed; under a
 * drive neither is certain, so it begins as small. */
void taylor_begin_motion(struct taylor *t, const struct model *m, const double *p, const struct segment *e,
                         const double *x)
{
    double x_dot[MODEL_STATES];
    t->most = t->most_rate = 0.0;
    t->size = SIZE_MIN;
    allow(t, LOG2_SIZE_MIN);
    if (sounds(e))
        return;
    m->rhs(p, e->at[0], x, x_dot);
    t->most = fabs(x[1]);
    t->most_rate = fabs(x_dot[1]) / t->rate_scale;
}

void taylor_grow(struct taylor *t, double size)
{
    const uint64_t exponent = UINT64_C(0x7FF0000000000000);
    uint64_t bits;
    size = size < 1.0 ? size : 1.0;
    memcpy(&bits, &size, sizeof bits);
    bits &= exponent;
    memcpy(&t->size, &bits, sizeof bits);
    allow(t, (double)((int)(bits >> 52) - 1023));
}
