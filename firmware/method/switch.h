/* switch.h - is there a contact switch between two instants, and when?
 *
 * Between the instants the gap is taken as the cubic Hermite polynomial of its values and rates at both ends,
 * with an error of O(h^4). A change of sign is certain. A gap that only dips across zero and back (grazing)
 * is found from the rates: where the end tangents meet beyond zero, the extremum of the polynomial decides.
 * The guess is then sharpened with shortened steps of the method itself. */
#ifndef FIRMWARE_SWITCH_H
#define FIRMWARE_SWITCH_H

#include <stdbool.h>
#include "firmware/method/method.h"

enum {
    SWITCH_ITERATIONS = 12 /* Newton steps; 2 or 3 are usual, a grazing root takes most */
};

/* True when the gap has left its regime (closed: gap < 0) at the end, or when the end tangents allow it to do
 * so in between. Every step pays for this: a few comparisons. */
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

/* The first zero of the Hermite cubic in (0, length] at which the regime ends; `length` when only the end has
 * the other sign. Negative when a suspected dip does not reach zero. */
double switch_guess(const struct input *g0, const struct input *g1, double length, bool closed);

/* A switch in the Hermite cubic of a gap: when, in model time from the begin; the gap's rate there, and how
 * fast that changes. */
struct switch_found {
    double done, rate, bend;
};

/* As switch_guess, but to 1e-11 of the length: for a method that takes the cubic for the motion. False when
 * there is none; `found` is then as it was. */
bool switch_find(const struct input *g0, const struct input *g1, double length, bool closed,
                 struct switch_found *found);

/* The largest value of the Hermite cubic of a gap that turns from rising to falling. */
double switch_highest(const struct input *g0, const struct input *g1, double length);

/* The plain step of a method: x1 becomes the state at the end of e, without a stop at switches. Its forces
 * must be valid in every regime. */
struct switch_stepper {
    void (*advance)(const struct model *m, const double *p, const double *scratch, const struct segment *e,
                    const double *x, double *x1);
    const struct model *m;
    const double *p, *scratch;
    double resolution; /* model time to which an instant can be located */
};

/* A step in which a switch is suspected: to the first switch (STEP_SWITCH), or to the end (STEP_END) when
 * there is none. Newton's method on the gap locates it to the stepper's resolution. c->residual: it did not
 * converge. Cost: one step, and up to SWITCH_ITERATIONS more for each switch, 2 or 3 as a rule. */
enum step_status switch_locate(const struct switch_stepper *by, const struct segment *e, unsigned regime,
                               double *x, struct crossing *c);

#endif
