/* classical.h - the fixed-step methods of the textbooks, none of which looks for a contact switch: what tests
 * and charts set beside the shipped methods.
 *
 *   x'' = force(t, x) - damping x'
 *
 * verlet is velocity Verlet: order 2, one force a step, symplectic without damping. The semi-implicit Euler
 * method takes the velocity first: order 1. newmark has the average acceleration (beta 1/4, gamma 1/2):
 * order 2, implicit, "unconditionally stable" for linear systems. rk4 is the classical Runge-Kutta method:
 * order 4, four forces. */
#ifndef TESTS_BENCH_CLASSICAL_H
#define TESTS_BENCH_CLASSICAL_H

typedef double classical_function(const void *context, double t, double x);

struct classical {
    classical_function *force;
    classical_function *slope; /* d force/d x, for Newmark's Newton iteration */
    double damping;
    const void *context;
};

struct classical_state {
    double x, v;
    double f; /* force(t, x): carried from step to step by those that need no other */
};

typedef void classical_step(const struct classical *c, double t, double h, struct classical_state *s);

enum { CLASSICAL_EULER, CLASSICAL_VERLET, CLASSICAL_NEWMARK, CLASSICAL_RK4, CLASSICAL_METHODS };
extern const struct classical_method {
    const char *name;
    classical_step *step;
} classical_table[CLASSICAL_METHODS];

/* s->f for a state put in place. */
static inline void classical_begin(const struct classical *c, double t, struct classical_state *s)
{
    s->f = c->force(c->context, t, s->x);
}

/* In the header so that a force known at compile time is inlined: a fair cost. */
static inline void classical_verlet(const struct classical *c, double t, double h, struct classical_state *s)
{
    double half = s->v + 0.5 * h * (s->f - c->damping * s->v);
    s->x += h * half;
    s->f = c->force(c->context, t + h, s->x);
    s->v = (half + 0.5 * h * s->f) / (1.0 + 0.5 * h * c->damping);
}

static inline void classical_rk4(const struct classical *c, double t, double h, struct classical_state *s)
{
    double half = 0.5 * h, x = s->x, v = s->v, d = c->damping;
    double a1 = s->f - d * v, v2 = v + half * a1;
    double a2 = c->force(c->context, t + half, x + half * v) - d * v2, v3 = v + half * a2;
    double a3 = c->force(c->context, t + half, x + half * v2) - d * v3, v4 = v + h * a3;
    double a4 = c->force(c->context, t + h, x + h * v3) - d * v4;
    s->x = x + h / 6.0 * (v + 2.0 * (v2 + v3) + v4);
    s->v = v + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
    s->f = c->force(c->context, t + h, s->x);
}

#endif
