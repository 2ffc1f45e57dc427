/* follow.c - see follow.h. */
#include "host_sim/fit/motion/follow.h"

#include <math.h>

enum { SETTLE_PERIODS = 32, SETTLE_ROUNDS = 5, SETTLE_HASTY = 2 }; /* each twice as long as the one before */
static const double narrow = 1e-5;                                 /* the shortest step, over the frequency */
static const double arrived = 0.1; /* a motion that has settled is so near to its orbit, of its size */

/* The difference of two motions over the size of the larger one. */
static double apart(const struct orbit_task *t, const struct orbit *a, const struct orbit *b)
{
    double rest[MODEL_STATES], unit[MODEL_STATES], difference = 0.0, size = 0.0;
    orbit_rest(t, rest, unit);
    for (int i = 0; i < t->model->n_states; i++) {
        difference = fmax(difference, fabs(a->x[i] - b->x[i]) / unit[i]);
        size = fmax(size, fmax(fabs(a->x[i] - rest[i]), fabs(b->x[i] - rest[i])) / unit[i]);
    }
    return size > 0.0 ? difference / size : 0.0;
}

static bool find_stable(struct orbit_task *t, const struct orbit *from, double frequency_Hz, double change,
                        struct orbit *o)
{
    *o = *from;
    o->frequency_Hz = frequency_Hz;
    return orbit_find(t, o) && orbit_is_stable(t, o) && apart(t, from, o) <= change;
}

/* Takes *o along its branch to this frequency. False: the branch ends at o->frequency_Hz. */
static bool advance(struct orbit_task *t, struct orbit *o, double to_Hz)
{
    struct orbit next;
    double step = to_Hz - o->frequency_Hz, change = t->hasty ? HUGE_VAL : FOLLOW_CHANGE;
    while (o->frequency_Hz < to_Hz || o->frequency_Hz > to_Hz) {
        double left = to_Hz - o->frequency_Hz;
        bool last = fabs(step) >= fabs(left);
        if (find_stable(t, o, last ? to_Hz : o->frequency_Hz + step, change, &next)) {
            *o = next;
            step *= 2.0;
        } else {
            step = 0.5 * (last ? left : step);
            if (t->hasty || fabs(step) < narrow * to_Hz)
                return false;
        }
    }
    return true;
}

/* Lets the plant run at o->frequency_Hz until it is near a stable motion, which *o becomes. */
static bool settle(struct orbit_task *t, struct orbit *o)
{
    for (int i = 0; i < (t->hasty ? SETTLE_HASTY : SETTLE_ROUNDS); i++) {
        struct orbit settled;
        if (!orbit_settle(t, o, SETTLE_PERIODS << i))
            return false;
        if (find_stable(t, o, o->frequency_Hz, arrived, &settled)) {
            *o = settled;
            return true;
        }
    }
    return false;
}

bool follow_on(struct orbit_task *t, const struct orbit *from, struct orbit *o)
{
    return find_stable(t, from, from->frequency_Hz, FOLLOW_CHANGE, o);
}

int follow_curve(struct orbit_task *t, const double *frequency, int n, int by, struct follow_point *at)
{
    double unit[MODEL_STATES], rest[MODEL_STATES];
    struct orbit o = {.frequency_Hz = 0.0};
    bool found = false;
    int jumps = 0;
    orbit_rest(t, rest, unit);
    for (int k = 0; k < n; k++) {
        int i = by > 0 ? k : n - 1 - k;
        at[i] = (struct follow_point){.found = false};
        if (!found)
            for (int s = 0; s < t->model->n_states; s++)
                o.x[s] = rest[s];
        if (!(found && advance(t, &o, frequency[i]))) {
            at[i].jump_Hz = found ? o.frequency_Hz : 0.0;
            jumps += found;
            o.frequency_Hz = frequency[i];
            found = settle(t, &o);
        }
        at[i].found = found;
        at[i].orbit = o;
    }
    return jumps;
}
