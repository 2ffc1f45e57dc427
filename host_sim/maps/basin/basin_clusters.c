/* basin_clusters.c - sorts motions into attractors by their fingerprints, and finds mirror images among
 * them. */
#include "host_sim/maps/basin/basin_clusters.h"

#include <math.h>
#include <string.h>

static const double kind_tolerance[BASIN_KINDS] = {2e-3, 0.02, 0.1};
static const double deviate_95 = 1.959963984540054; /* standard normal quantile for 95 %, two sides */

void basin_clusters_wilson(int k, int n, double *low, double *high)
{
    double share = (double)k / n, z2 = deviate_95 * deviate_95 / n;
    double middle = (share + 0.5 * z2) / (1.0 + z2);
    double half = deviate_95 * sqrt(share * (1.0 - share) / n + 0.25 * z2 / n) / (1.0 + z2);
    *low = k == 0 ? 0.0 : middle - half;
    *high = k == n ? 1.0 : middle + half;
}

void basin_clusters_start(struct basin_clusters *c, const struct model *m)
{
    memset(c, 0, sizeof *c);
    c->model = m;
}

/* The largest rms among states of the same quantity as state i. */
static double size_of(const struct model *m, const struct basin_motion *a, int i)
{
    double size = 0.0;
    for (int k = 0; k < m->n_states; k++)
        if (m->state_signal[k].quantity == m->state_signal[i].quantity)
            size = fmax(size, a->rms[k]);
    return size;
}

enum basin_kind basin_clusters_kind(const struct basin_motion *motion)
{
    if (motion->period > 0)
        return BASIN_PERIODIC;
    return motion->growth < BASIN_CHAOS ? BASIN_APERIODIC : BASIN_CHAOTIC;
}

static bool same(const struct model *m, const struct basin_motion *a, const struct basin_motion *b)
{
    enum basin_kind kind = basin_clusters_kind(a);
    if (a->period != b->period || basin_clusters_kind(b) != kind)
        return false;
    for (int i = 0; i < m->n_states; i++) {
        double near = kind_tolerance[kind] * size_of(m, a, i);
        if (fabs(a->mean[i] - b->mean[i]) > near || fabs(a->rms[i] - b->rms[i]) > near)
            return false;
    }
    return true;
}

static int find_attractor(const struct basin_clusters *c, const struct basin_motion *motion)
{
    for (int i = 0; i < c->n; i++)
        if (same(c->model, &c->attractor[i].motion, motion))
            return i;
    return -1;
}

int basin_clusters_add(struct basin_clusters *c, const struct basin_motion *motion)
{
    c->total++;
    c->escaped += motion->outcome == BASIN_GONE;
    c->trouble += motion->outcome == BASIN_TROUBLE;
    if (motion->outcome == BASIN_GONE || motion->outcome == BASIN_TROUBLE)
        return -1;
    int i = find_attractor(c, motion);
    if (i < 0 && c->n == BASIN_ATTRACTORS)
        return -2;
    if (i < 0) {
        i = c->n++;
        c->attractor[i] = (struct basin_attractor){.motion = *motion};
    }
    struct basin_attractor *a = &c->attractor[i];
    a->count++;
    a->growth += (motion->growth - a->growth) / a->count;
    return i;
}

/* The state that takes the place of i when the shaft's ends are exchanged. */
static int exchanged(const struct model *m, int i)
{
    int half = m->n_states / 2;
    return i < half ? half - 1 - i : 3 * half - 1 - i;
}

static struct basin_motion image_of(const struct model *m, const struct basin_motion *a,
                                    enum basin_image image)
{
    struct basin_motion b = *a;
    for (int i = 0; i < m->n_states; i++) {
        int from = image == IMAGE_MIRROR ? i : exchanged(m, i);
        b.mean[i] = image == IMAGE_ENDS ? a->mean[from] : -a->mean[from];
        b.rms[i] = a->rms[from];
    }
    return b;
}

static void find_images(struct basin_clusters *c, int i)
{
    for (int k = IMAGE_MIRROR; k < IMAGES; k++) {
        struct basin_motion b = image_of(c->model, &c->attractor[i].motion, (enum basin_image)k);
        bool itself = same(c->model, &c->attractor[i].motion, &b);
        c->attractor[i].image[k] = itself ? i : find_attractor(c, &b);
    }
}

void basin_clusters_finish(struct basin_clusters *c, int *order)
{
    static int at[BASIN_ATTRACTORS]; /* old numbers, in the new order */
    for (int i = 0; i < c->n; i++) {
        struct basin_attractor a = c->attractor[i];
        int k = i;
        for (; k > 0 && c->attractor[k - 1].count < a.count; k--) {
            c->attractor[k] = c->attractor[k - 1];
            at[k] = at[k - 1];
        }
        c->attractor[k] = a;
        at[k] = i;
    }
    for (int i = 0; i < c->n; i++) {
        find_images(c, i);
        if (order)
            order[at[i]] = i;
    }
}
