/* exact_books.c - the powers of a model, and contact forces; see exact_books.h. */
#include "firmware/method/exact/exact_books.h"

#include <math.h>
#include "firmware/method/switch.h"

/* The least compression at which a contact is measured, in units of the model. */
#define LEAST_DEPTH (1.0 / 64.0)

static bool close_to(double a, double b)
{
    return fabs(a - b) <= 1e-12 * (fabs(a) + fabs(b));
}

/* Where velocity k stands in a row of powers. */
static int place(int half, int k)
{
    return k + half % 2;
}

/* The model's flow at x is what the powers say. */
static bool agrees(const struct model *m, const double *p, const struct exact *w, const double *x)
{
    struct input u[MODEL_INPUTS];
    struct flow f;
    const struct exact_powers *q = &w->powers;
    int half = m->n_states / 2;
    exact_pair pairs[MODEL_LINEAR_STATES / 2];
    unsigned closed = 0;
    double loss = 0.0;
    bool good = true;
    for (int i = 0; i < MODEL_INPUTS; i++)
        u[i] = (struct input){1.0 + i, 3.0 - i};
    for (int i = 0; i < m->n_contacts; i++)
        closed |= (w->gap[i].constant + w->gap[i].slope * x[w->gap[i].position] < 0.0 ? 1u : 0u) << i;
    for (int k = 0; k < half; k++)
        pairs[k] = exact_load(&x[2 * k]);
    m->flow(p, u, x, &f);
    for (int i = 0; i < m->n_inputs; i++) {
        double work = 0.0;
        for (int k = 0; k < half; k++)
            work += q->work[i][place(half, k)] * x[half + k];
        good = good && close_to(f.work[i], u[i].value * work);
    }
    for (int k = 0; k < half; k++)
        loss += q->damping[place(half, k)] * (x[half + k] * x[half + k]);
    return good && close_to(f.damping, loss) &&
           close_to(f.force, exact_force(w, half, closed, 0.0, pairs, pairs));
}

/* A moving state with the contact of gap g compressed by depth. */
static void compress(const struct model *m, const struct exact_gap *g, double depth, double *x)
{
    for (int k = 0; k < m->n_states; k++)
        x[k] = k < m->n_states / 2 ? 0.0 : 1.0 - 0.375 * k;
    x[g->position] = (-depth - g->constant) / g->slope;
}

static int count_closed(const struct model *m, const struct exact *w, const double *x)
{
    int n = 0;
    for (int i = 0; i < m->n_contacts; i++)
        n += w->gap[i].constant + w->gap[i].slope * x[w->gap[i].position] < 0.0 ? 1 : 0;
    return n;
}

/* A state with contact i compressed: by 1, or by the most of 1/2, 1/4 .. at which it is closed alone, if
 * there is one. Returns the depth. */
static double compress_alone(const struct model *m, const struct exact *w, int i, double *x)
{
    double depth = 1.0;
    compress(m, &w->gap[i], depth, x);
    while (count_closed(m, w, x) > 1 && depth > LEAST_DEPTH) {
        depth *= 0.5;
        compress(m, &w->gap[i], depth, x);
    }
    if (count_closed(m, w, x) > 1) {
        depth = 1.0;
        compress(m, &w->gap[i], depth, x);
    }
    return depth;
}

/* From the flow at unit velocities, and at each contact compressed. */
static void measure(const struct model *m, const double *p, struct exact *w)
{
    struct exact_powers *q = &w->powers;
    struct input u[MODEL_INPUTS];
    struct flow f;
    double x[MODEL_LINEAR_STATES] = {0.0};
    int half = m->n_states / 2;
    for (int i = 0; i < MODEL_INPUTS; i++)
        u[i] = (struct input){1.0, 0.0};
    for (int k = 0; k < half; k++) {
        x[half + k] = 1.0;
        m->flow(p, u, x, &f);
        x[half + k] = 0.0;
        q->damping[place(half, k)] = f.damping;
        for (int i = 0; i < m->n_inputs; i++)
            q->work[i][place(half, k)] = f.work[i];
    }
    for (int i = 0; i < m->n_contacts; i++) {
        double depth = compress_alone(m, w, i, x);
        m->flow(p, u, x, &f);
        q->stiffness[i] = f.force / depth;
    }
}

static bool has_tables(const struct model *m, const struct exact *w)
{
    bool good = true;
    for (unsigned regime = 0; regime < 1u << m->n_contacts; regime++) {
        const struct exact_regime *r = &w->regime[regime];
        good = good && (r->reach == 0.0 || r->tick == r->unit);
    }
    return good;
}

void exact_find_powers(const struct model *m, const double *p, struct exact *w)
{
    static const double depth[3] = {LEAST_DEPTH, 1.0, 16.0};
    double x[MODEL_LINEAR_STATES];
    bool good = has_tables(m, w);
    if (!good)
        return;
    measure(m, p, w);
    for (int k = 0; k < m->n_states; k++)
        x[k] = 0.25 - 0.375 * k;
    good = agrees(m, p, w, x);
    for (int i = 0; i < 3 * m->n_contacts; i++) {
        compress(m, &w->gap[i / 3], depth[i % 3], x);
        good = good && agrees(m, p, w, x);
    }
    w->powers.known = good;
}

/* Compression of contact g, and its rate. */
static struct input compression(const struct exact_gap *g, int half, const exact_pair *x)
{
    int k = g->position, v = half + k;
    return (struct input){-(g->constant + g->slope * x[k / 2][k % 2]), -(g->slope * x[v / 2][v % 2])};
}

double exact_force(const struct exact *w, int half, unsigned regime, double length, const exact_pair *x0,
                   const exact_pair *x1)
{
    double most = 0.0;
    for (int i = 0; regime >> i; i++) {
        if (!((regime >> i) & 1u))
            continue;
        struct input a = compression(&w->gap[i], half, x0), b = compression(&w->gap[i], half, x1);
        double depth = a.value > b.value ? a.value : b.value;
        if (a.rate > 0.0 && b.rate < 0.0) {
            double top = switch_highest(&a, &b, length);
            depth = top > depth ? top : depth;
        }
        double force = w->powers.stiffness[i] * depth;
        most = force > most ? force : most;
    }
    return most;
}
