/* exact_books.h - the energies that a step of `exact` moved.
 *
 * Powers are integrated by Simpson's rule over each tick and over each piece of a tick between switches. The
 * state in the middle is that of the exact motion. All powers are squares of velocities, and velocities times
 * forces: a model of which that is not true is left to the ledger's own rule. */
#ifndef FIRMWARE_EXACT_BOOKS_H
#define FIRMWARE_EXACT_BOOKS_H

#include "firmware/method/exact/exact.h"

/* Finds the powers of the model with parameters p, after the tables. They stay unknown where the model's flow
 * has others at one of several states, and where a regime has no tables for a tick. */
void exact_find_powers(const struct model *m, const double *p, struct exact *w);

/* The largest contact force of the cubic through the states x0 and x1, in pairs, `length` later; the contacts
 * of `regime` alone are closed. */
double exact_force(const struct exact *w, int half, unsigned regime, double length, const exact_pair *x0,
                   const exact_pair *x1);

/* The books of a piece between states x0 and x1, in pairs, but for the work of inputs. Behind x1 stand the
 * last states in its middle, from the pair of the first velocity on. */
ALWAYS_INLINE void exact_book(int n, const struct exact *w, unsigned regime, double length,
                              const exact_pair *x0, const exact_pair *x1, struct method_books *b)
{
    const int half = n / 2, first = n / 4;
    const exact_pair *middle = &x1[half];
    exact_pair loss = {0.0, 0.0};
    *b = (struct method_books){.damping = 0.0};
    EXACT_UNROLL for (int k = first; k < half; k++)
    {
        exact_pair ends = x0[k] * x0[k] + x1[k] * x1[k];
        loss += exact_load(&w->powers.damping[2 * (k - first)]) *
                (ends + 4.0 * (middle[k - first] * middle[k - first]));
    }
    b->damping = length * (1.0 / 6.0) * (loss[0] + loss[1]);
    if (regime != 0)
        b->force = exact_force(w, half, regime, length, x0, x1);
}

/* Likewise the work of input i, which is u at its begin, middle and end. */
ALWAYS_INLINE double exact_work(int n, const struct exact *w, int i, double length, const exact_pair *x0,
                                const exact_pair *x1, double u_begin, double u_middle, double u_end)
{
    const int half = n / 2, first = n / 4;
    const exact_pair *middle = &x1[half];
    exact_pair work = {0.0, 0.0};
    EXACT_UNROLL for (int k = first; k < half; k++) work +=
        exact_load(&w->powers.work[i][2 * (k - first)]) *
        ((x0[k] * u_begin + x1[k] * u_end) + middle[k - first] * (4.0 * u_middle));
    return length * (1.0 / 6.0) * (work[0] + work[1]);
}

#endif
