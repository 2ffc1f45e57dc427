/* classical.c - see classical.h. */
#include "tests/bench/classical.h"

#include <math.h>

static void euler(const struct classical *c, double t, double h, struct classical_state *s)
{
    s->v += h * (s->f - c->damping * s->v);
    s->x += h * s->v;
    s->f = c->force(c->context, t + h, s->x);
}

/* Newton on the new acceleration a; with a kink between two
 * iterates it may end at ITERATIONS, as it does for everyone. */
static void newmark(const struct classical *c, double t, double h, struct classical_state *s)
{
    enum { ITERATIONS = 20 };
    double d = c->damping, a0 = s->f - d * s->v, a = a0, move = 1.0, x = s->x;
    for (int i = 0; i < ITERATIONS && fabs(move) > 1e-14 * (1.0 + fabs(a)); i++) {
        x = s->x + h * s->v + 0.25 * h * h * (a0 + a);
        double residual = c->force(c->context, t + h, x) - d * (s->v + 0.5 * h * (a0 + a)) - a;
        move = residual / (1.0 + 0.5 * h * d - 0.25 * h * h * c->slope(c->context, t + h, x));
        a += move;
    }
    s->x += h * s->v + 0.25 * h * h * (a0 + a);
    s->v += 0.5 * h * (a0 + a);
    s->f = c->force(c->context, t + h, s->x);
}

static void verlet(const struct classical *c, double t, double h, struct classical_state *s)
{
    classical_verlet(c, t, h, s);
}

static void rk4(const struct classical *c, double t, double h, struct classical_state *s)
{
    classical_rk4(c, t, h, s);
}

const struct classical_method classical_table[CLASSICAL_METHODS] = {
    {"semi-implicit Euler", euler}, {"Verlet", verlet}, {"Newmark", newmark}, {"plain RK4", rk4}};
