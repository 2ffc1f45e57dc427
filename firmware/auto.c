/* auto.c - the method for a model, a step and a tolerance: exact where it takes the model, then rk4 where its error is
 * small enough, then taylor.
 *
 *   linear view             exact
 *   Hertzian contact        rk4 where its guard takes the step and (h omega)^(5/2) <= tol, else taylor
 *   polynomial force        taylor: rk4, through pointers there, costs more
 *   nothing but rhs         rk4, whatever the tolerance
 *
 * (h omega)^(5/2) is rk4's error where contact is lost; it comes out at three times that at most, drives of 8 times the
 * resonance included, and taylor's at one to three times the tolerance; a tick costs 0.6 to 0.9 of taylor's. Without a
 * tolerance asked (0) the contact is taylor's, at the one that it has by default.
 *
 * The choice is made in prepare and kept in the work memory, so a change of parameters may turn it: state and regime are
 * the plant's, and the tables are made anew. Cost beyond the method's own: 40 instructions a step. */
#include <math.h>
#include "firmware/method.h"

enum { EXACT, RK4, TAYLOR, CANDIDATES };
static const struct method *const candidate[CANDIDATES] = {&exact, &rk4, &taylor};

/* rk4's error is what was asked for. */
static bool rk4_will_do(const struct model *m, const double *p, double h, double tol)
{
    double angle = h * m->eigenfrequency(p);
    return m->hertz_form && angle * angle * sqrt(angle) <= tol;
}

static bool has_series(const struct model *m)
{
    return m->hertz_form || m->polynomial_form;
}

/* Those that may serve, the best first; returns how many, at least one. */
static int rank(const struct model *m, const double *p, double h, double tol, int *order)
{
    int n = 0;
    if (m->linear)
        order[n++] = EXACT;
    if (!has_series(m) || rk4_will_do(m, p, h, tol))
        order[n++] = RK4;
    if (has_series(m))
        order[n++] = TAYLOR;
    return n;
}

/* The best that takes the step. None does: the best of all, *why is its reason, else NULL. */
static int choose(const struct model *m, const double *p, double h, double tol, const char **why)
{
    int order[CANDIDATES], n = rank(m, p, h, tol, order);
    for (int i = 0; i < n; i++) {
        const char *reason = candidate[order[i]]->refuse(m, p, h, tol);
        if (i == 0 || !reason)
            *why = reason;
        if (!reason)
            return order[i];
    }
    return order[0];
}

const struct method *auto_choice(const struct model *m, const double *p, double h, double tol)
{
    const char *why;
    return candidate[choose(m, p, h, tol, &why)];
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    const char *why;
    (void)choose(m, p, h, tol, &why);
    return why;
}

/* work[0] is the choice, the rest is the method's own. */
static size_t n_work(const struct model *m)
{
    size_t of_exact = m->linear ? exact.n_work(m) : 0, of_taylor = has_series(m) ? taylor.n_work(m) : 0;
    return 1 + (of_exact > of_taylor ? of_exact : of_taylor);
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *work)
{
    const char *why;
    int choice = choose(m, p, h, tol, &why);
    work[0] = choice;
    candidate[choice]->prepare(m, p, h, tol, &work[1]);
}

static enum step_status step(const struct model *m, const double *p, double *work, const struct excitation *e,
                             unsigned regime, double *x, struct crossing *c)
{
    return candidate[(int)work[0]]->bind(m)(m, p, &work[1], e, regime, x, c);
}

static step_function *bind(const struct model *m)
{
    (void)m;
    return step;
}

const struct method auto_method = {
    .name = "auto",
    .title = "exact, rk4 or taylor: the cheapest that keeps the tolerance, by model and step",
    .order = 0,
    .n_work = n_work,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
};
