/* duffing.h - a model outside the tree, for tests/new_model/new_model.c: Duffing's mass on a hardening
 * spring.
 *
 *   m z'' + c z' + k z + k3 z^3 = F
 *
 * In units of length sqrt(k/k3), force k sqrt(k/k3) and time sqrt(m/k), with 2 zeta = c/sqrt(m k):
 *
 *   x'' = u - 2 zeta x' - x (1 + x^2) */
#ifndef TESTS_DUFFING_H
#define TESTS_DUFFING_H

#include "models/model.h"

extern const struct model duffing;

enum { DUFFING_FORCE, DUFFING_INPUTS };
enum { DUFFING_MASS, DUFFING_STIFFNESS, DUFFING_CUBIC, DUFFING_DAMPING, DUFFING_PARAMETERS };
enum { DUFFING_P_TWO_ZETA };

static inline void duffing_rhs(const double *p, const struct input *u, const double *x, double *x_dot)
{
    x_dot[0] = x[1];
    x_dot[1] = (u[DUFFING_FORCE].value - p[DUFFING_P_TWO_ZETA] * x[1]) - x[0] * (1.0 + x[0] * x[0]);
}

static inline void duffing_flow(const double *p, const struct input *u, const double *x, struct flow *f)
{
    double spring = x[0] * (1.0 + x[0] * x[0]);
    f->x_dot[0] = x[1];
    f->x_dot[1] = (u[DUFFING_FORCE].value - p[DUFFING_P_TWO_ZETA] * x[1]) - spring;
    f->work[DUFFING_FORCE] = u[DUFFING_FORCE].value * x[1];
    f->damping = p[DUFFING_P_TWO_ZETA] * x[1] * x[1];
    f->force = spring;
}

/* Its row in firmware/method/instances.h. */
#define INSTANCES_MORE(X)                                                                                    \
    X(duffing, m == &duffing, STAY, 2, 0, DUFFING_INPUTS, duffing_rhs, model_no_gap, duffing_flow)

#endif
