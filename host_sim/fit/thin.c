/* thin.c - see thin.h. */
#include "host_sim/fit/thin.h"

#include <stdlib.h>
#include "host_sim/fit/solve/problem.h"

enum { STEP = 3 }; /* one of so many points */

/* The largest of up to STEP points from *i on, which goes on behind them: gaps close there. */
static struct curve_point largest_of(const struct curve *c, int *i)
{
    struct curve_point most = c->point[*i];
    for (int end = *i + STEP; *i < end && *i < c->n; ++*i) {
        const struct curve_point *p = &c->point[*i];
        if (p->re * p->re + p->im * p->im > most.re * most.re + most.im * most.im)
            most = *p;
    }
    return most;
}

bool thin(const struct fit_setup *s, struct fit_setup *t)
{
    bool good = true;
    *t = *s;
    t->task.hasty = true;
    for (int c = 0; c < s->data.n; c++) {
        const struct curve *all = &s->data.curve[c];
        struct curve *some = &t->data.curve[c];
        some->n = 0;
        some->point = calloc((size_t)all->n, sizeof *some->point);
        t->point[c] = calloc((size_t)all->n, sizeof *t->point[c]);
        t->smooth[c] = false;
        good = good && some->point && t->point[c];
        for (int i = 0; good && i < all->n;)
            some->point[some->n++] = largest_of(all, &i);
    }
    t->n_residuals = problem_size(t, PROBLEM_ROBUST);
    return good;
}

void thin_free(struct fit_setup *t)
{
    for (int c = 0; c < t->data.n; c++)
        free(t->point[c]);
    curves_free(&t->data);
}
