/* rk4_step.h - one step of the classical Runge-Kutta method with the model inlined, for rk4.c and plant/block.c. */
#ifndef FIRMWARE_RK4_STEP_H
#define FIRMWARE_RK4_STEP_H

#include "models/check.h"
#include "models/model.h"

typedef void rhs_function(const double *p, const struct input *u, const double *x, double *x_dot);
typedef void gap_function(const double *p, const struct input *u, const double *x, struct input *gap);

/* From x to x1 in h, with the inputs at its begin (u0), in its middle (u1) and at its end (u2). Classical RK4 of
 * x'' = f(t, x, x'), positions first in the state, then velocities. The stage velocities are put into the stage
 * positions. So the chain from one force to the next is two operations shorter, and the positions need the sum
 * of three accelerations only. */
ALWAYS_INLINE void rk4_advance(rhs_function *rhs, int n_states, const double *p, double h,
                               const struct input *u0, const struct input *u1, const struct input *u2,
                               const double *x, double *x1)
{
    double k1[MODEL_STATES], k2[MODEL_STATES], k3[MODEL_STATES], k4[MODEL_STATES], y[MODEL_STATES];
    double half = 0.5 * h, quarter = half * half, square = half * h;
    int n = n_states / 2;
    rhs(p, u0, x, k1);
    for (int i = 0; i < n; i++) {
        y[i] = x[i] + half * x[n + i];
        y[n + i] = x[n + i] + half * k1[n + i];
    }
    rhs(p, u1, y, k2);
    for (int i = 0; i < n; i++) {
        y[i] = (x[i] + half * x[n + i]) + quarter * k1[n + i];
        y[n + i] = x[n + i] + half * k2[n + i];
    }
    rhs(p, u1, y, k3);
    for (int i = 0; i < n; i++) {
        y[i] = (x[i] + h * x[n + i]) + square * k2[n + i];
        y[n + i] = x[n + i] + h * k3[n + i];
    }
    rhs(p, u2, y, k4);
    double sixth = h * (1.0 / 6.0), sixth_square = h * sixth;
    for (int i = 0; i < n; i++) {
        double middle = k2[n + i] + k3[n + i];
        x1[i] = (x[i] + h * x[n + i]) + sixth_square * (k1[n + i] + middle);
        x1[n + i] = x[n + i] + sixth * ((k1[n + i] + k4[n + i]) + 2.0 * middle);
    }
}

#endif
