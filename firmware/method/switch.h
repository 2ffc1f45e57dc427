/* switch.h - is there a contact switch between two instants, and where about?
 *
 * Between them the gap is taken as the cubic Hermite polynomial of its values and rates at both ends, error O(h^4).
 * A sign change is certain; a gap that only dips across zero and back (grazing) is found from the rates: the two end
 * tangents bound it, and where they cross zero the polynomial's extremum decides. The guess is then
 * sharpened with shortened steps of the method itself. */
#ifndef FIRMWARE_SWITCH_H
#define FIRMWARE_SWITCH_H

#include <stdbool.h>
#include "firmware/method/method.h"

enum {
    SWITCH_ITERATIONS = 12 /* Newton steps; 2 or 3 are usual, a grazing root takes most */
};

/* True when the end tangents allow the gap to leave its regime (closed: gap < 0) between the two ends, or it has
 * left it at the end. Costs a few comparisons: this is what every step pays. */
static inline bool switch_suspected(const struct input *g0, const struct input *g1, double length,
                                    bool closed)
{
    double sign = closed ? 1.0 : -1.0; /* sign * gap > 0 is a switch */
    double v0 = sign * g0->rate, v1 = sign * g1->rate;
    double end = sign * g1->value;
    if (end >= 0.0)
        return !(end == 0.0 && v1 <= 0.0);
    if (!(v0 > 0.0 && v1 < 0.0))
        return false;
    /* The tangents meet at s = (end - begin - v1 length)/(v0 - v1) from the start. */
    double begin = sign * g0->value;
    double s = (end - begin - v1 * length) / (v0 - v1);
    return begin + v0 * s > 0.0;
}

/* The first zero of the Hermite cubic in (0, length], where the regime is left; `length` if the end has the other
 * sign but no earlier zero shows. A negative number when a suspected dip does not reach zero. */
double switch_guess(const struct input *g0, const struct input *g1, double length, bool closed);

/* A method's plain step, for whom a switch is to be located: x1 = the state at the end of e, whatever switches on the
 * way. Its forces must be valid in every regime. */
struct switch_stepper {
    void (*advance)(const struct model *m, const double *p, const double *scratch, const struct segment *e,
                    const double *x, double *x1);
    const struct model *m;
    const double *p, *scratch;
    double resolution; /* model time to which an instant can be located: rounding of a step over its tick */
};

/* One step in which a switch is suspected: to the first switch (STEP_SWITCH), located by Newton on the gap to the
 * stepper's resolution, or to the end (STEP_END) if there is none. Cost: one step, and up to SWITCH_ITERATIONS per switch. */
enum step_status switch_locate(const struct switch_stepper *by, const struct segment *e, unsigned regime,
                               double *x, struct crossing *c);

#endif
