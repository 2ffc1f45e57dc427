/* survival.c - see survival.h. */
#include "tests/papers/survival.h"

#include <math.h>
#include <string.h>
#include "tests/papers/one_mode.h"

enum { FEWEST = 30 };
static const double bracket = 0.25; /* Hz */

/* 1: contact after `seconds`, 0: quiet before, -1: it could not be run. */
static int lasts(const struct attractor_shaft *s, const double *state, double seconds)
{
    double x[MODEL_STATES] = {0.0}, switches = 0.0;
    int wait = (int)ceil(seconds * s->hz), calm = (int)ceil(SURVIVAL_CALM * s->hz), last = 0;
    struct stroboscope_sum sum;
    s->plant.model->state_from_paper(s->plant.p, s->map.tick[0].at[0], state, x);
    stroboscope_sum_start(&sum);
    for (int i = 0; i < last + calm && last < wait; i++) {
        if (stroboscope_advance(&s->map, x, &sum) != BASIN_GOOD)
            return -1;
        if (sum.switches > switches)
            last = i + 1;
        switches = sum.switches;
    }
    return last >= wait;
}

/* Far from `level` already after n of the starts: by more than three standard errors. */
static bool is_decided(int alive, int n, double level)
{
    return n >= FEWEST && fabs((double)alive / n - level) > 3.0 * sqrt(level * (1.0 - level) / n);
}

/* The share, of fewer starts than all where it is decided on which side of `level` it is; level < 0: of all.
 * mode: of the model, 0: of the shaft. */
static double share(const double *paper, int mode, double seconds, int starts, double level)
{
    struct attractor_shaft s;
    uint64_t seed = 77;
    int alive = 0, good = 1, n = 0;
    if (!(mode ? one_mode_open(&s, paper, mode) : attractor_open(&s, &shaft_bearing, paper)))
        return (double)NAN;
    while (n < starts && good >= 0 && !(level >= 0.0 && is_decided(alive, n, level))) {
        double state[MODEL_STATES];
        (mode ? one_mode_start : attractor_start)(&seed, paper[SHAFT_G1], state);
        good = lasts(&s, state, seconds);
        alive += good;
        n++;
    }
    attractor_close(&s);
    return good < 0 ? (double)NAN : (double)alive / n;
}

double survival_share(const double *paper, double seconds, int starts)
{
    return share(paper, 0, seconds, starts, -1.0);
}

double survival_share_mode(const double *paper, int mode, double seconds, int starts)
{
    return share(paper, mode, seconds, starts, -1.0);
}

static bool is_above(const struct survival *s, double hz)
{
    double paper[MODEL_PARAMETERS];
    memcpy(paper, s->paper, sizeof paper);
    paper[SHAFT_PAPER_HZ] = hz;
    return share(paper, 0, s->seconds, s->starts, s->level) >= s->level;
}

double survival_edge(const struct survival *s, double inside, double outside)
{
    if (!is_above(s, inside) || is_above(s, outside))
        return (double)NAN;
    while (fabs(outside - inside) > bracket) {
        double middle = 0.5 * (inside + outside);
        *(is_above(s, middle) ? &inside : &outside) = middle;
    }
    return 0.5 * (inside + outside);
}

double survival_quiet(const double *paper, double inside, double outside)
{
    double at[MODEL_PARAMETERS], amplitude[3];
    memcpy(at, paper, sizeof at);
    while (fabs(outside - inside) > 1e-6) {
        at[SHAFT_PAPER_HZ] = 0.5 * (inside + outside);
        attractor_linear(at, amplitude);
        bool touches = amplitude[0] > at[SHAFT_G1] || amplitude[2] > at[SHAFT_G3];
        *(touches ? &inside : &outside) = at[SHAFT_PAPER_HZ];
    }
    return outside;
}
