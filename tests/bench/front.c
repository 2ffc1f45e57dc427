/* front.c - cost at an error, from scattered measurements. */
#include "tests/bench/bench.h"

#include <math.h>
#include <string.h>

static bool belongs(const struct entry *e, const char *family, enum side side)
{
    return e->timed && (family ? strcmp(e->family, family) == 0 : e->side == side);
}

/* Another entry of the same set is at least as good in both and better in one. */
static bool beaten(const struct bench *b, const struct entry *e, const char *family, enum side side)
{
    for (int i = 0; i < b->n; i++) {
        const struct entry *o = &b->entry[i];
        if (o != e && belongs(o, family, side) && o->error <= e->error && o->ns_median <= e->ns_median &&
            (o->error < e->error || o->ns_median < e->ns_median || o < e))
            return true;
    }
    return false;
}

bool front_has(const struct bench *b, const struct entry *e)
{
    return e->timed && !beaten(b, e, e->family, e->side);
}

double front_cost(const struct bench *b, const char *family, enum side side, double error, const char **which)
{
    const struct entry *above = NULL, *below = NULL;
    for (int i = 0; i < b->n; i++) {
        const struct entry *e = &b->entry[i];
        if (!belongs(e, family, side) || beaten(b, e, family, side))
            continue;
        if (e->error <= error && (!below || e->error > below->error))
            below = e;
        if (e->error > error && (!above || e->error < above->error))
            above = e;
    }
    if (!below)
        return 0.0;
    if (which)
        *which = below->family;
    if (!above || below->error <= 0.0)
        return below->ns_median;
    double x = log(error / below->error) / log(above->error / below->error);
    return below->ns_median * pow(above->ns_median / below->ns_median, x);
}
