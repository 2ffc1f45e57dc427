/* attractor.c - see attractor.h. */
#include "tests/papers/attractor.h"

#include <complex.h>
#include <math.h>
#include <string.h>
#include "models/math/symmetric3.h"
#include "models/reduced/shaft_mode.h"
#include "tests/fixture/exact.h"
#include "tests/fixture/paper.h"
#include "tests/papers/motion.h"
#include "host_sim/maps/basin/basin_repeat.h"

static const double radians_a_tick = 2.0; /* angle of the fastest eigenfrequency; the guard is at 2.1 */
static const double repeat = 1e-7;        /* a state came back: relative to 1 + its size, model units */
enum { FINE = 128 /* ticks a period, at least, when a motion is measured */ };
static const double bend[3] = {1.0, -2.0, 1.0};

void attractor_paper(double gap_stiffness, double hz, double *paper)
{
    paper_defaults(&shaft_bearing, paper);
    paper[SHAFT_KG1] = paper[SHAFT_KG3] = gap_stiffness;
    paper[SHAFT_PAPER_HZ] = hz;
}

void attractor_modes(const double *paper, double share, double hz[3], double shape[3][3])
{
    double a[3][3], kL = paper[SHAFT_KAPPA] / (paper[SHAFT_LENGTH] * paper[SHAFT_LENGTH]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[i][j] = kL * bend[i] * bend[j] / sqrt(paper[SHAFT_M1 + i] * paper[SHAFT_M1 + j]);
    a[0][0] += (2.0 * paper[SHAFT_KS1] + share * paper[SHAFT_KG1]) / paper[SHAFT_M1];
    a[2][2] += (2.0 * paper[SHAFT_KS3] + share * paper[SHAFT_KG3]) / paper[SHAFT_M3];
    symmetric3_eigen(a, hz, shape);
    for (int i = 0; i < 3; i++)
        hz[i] = sqrt(fmax(hz[i], 0.0)) / MOTION_TWO_PI;
    for (int k = 0; k < 3; k++) {
        double most = 0.0;
        for (int i = 0; i < 3; i++) {
            shape[k][i] /= sqrt(paper[SHAFT_M1 + i]);
            most = fabs(shape[k][i]) > fabs(most) * (1.0 + 1e-9) ? shape[k][i] : most;
        }
        for (int i = 0; i < 3; i++)
            shape[k][i] /= most;
    }
}

void attractor_frequencies(const double *paper, double share, double hz[3])
{
    double shape[3][3];
    attractor_modes(paper, share, hz, shape);
}

void attractor_linear(const double *paper, double amplitude[3])
{
    double w = MOTION_TWO_PI * paper[SHAFT_PAPER_HZ],
           kL = paper[SHAFT_KAPPA] / (paper[SHAFT_LENGTH] * paper[SHAFT_LENGTH]);
    double support[3] = {2.0 * paper[SHAFT_KS1], 0.0, 2.0 * paper[SHAFT_KS3]};
    const double complex i_unit = (double complex)I;
    double complex own[3], bend_load = 0.0, bend_give = 1.0;
    /* (D + kL b b') x = p by the Sherman-Morrison formula */
    for (int i = 0; i < 3; i++) {
        own[i] = support[i] - w * w * paper[SHAFT_M1 + i] + i_unit * w * paper[SHAFT_C1 + i];
        bend_load += bend[i] * paper[SHAFT_PAPER_P1 + i] / own[i];
        bend_give += kL * bend[i] * bend[i] / own[i];
    }
    for (int i = 0; i < 3; i++)
        amplitude[i] = cabs((paper[SHAFT_PAPER_P1 + i] - kL * bend[i] * bend_load / bend_give) / own[i]);
}

int attractor_ticks(const double *paper)
{
    double hz[3];
    attractor_frequencies(paper, 1.0, hz);
    double n = ceil(MOTION_TWO_PI * hz[2] / paper[SHAFT_PAPER_HZ] / radians_a_tick);
    return n < 16.0 ? 16 : (int)n;
}

void attractor_start(uint64_t *seed, double span, double *state)
{
    for (int i = 0; i < 3; i++) {
        state[i] = span * (2.0 * exact_uniform(seed) - 1.0);
        state[3 + i] = exact_uniform(seed) - 0.5;
    }
}

bool attractor_open(struct attractor_shaft *s, const struct model *model, const double *paper)
{
    struct basin_plant *b = &s->plant;
    struct scene scene;
    int ticks = attractor_ticks(paper);
    *s = (struct attractor_shaft){.hz = paper[SHAFT_PAPER_HZ]};
    scenes_default(&scene, model);
    scene.paper = true;
    scene.observable = 4.0; /* position1 */
    memcpy(scene.value, paper, (size_t)model->n_paper * sizeof *paper);
    if (basin_map_read(b, &scene) || exact.refuse(model, b->p, b->period / ticks, 0.0))
        return false;
    b->method = &exact;
    b->steps = ticks;
    bool good =
        stroboscope_start(&s->map, b, ticks) && stroboscope_start(&s->fine, b, ticks < FINE ? FINE : ticks);
    if (!good)
        attractor_close(s);
    return good;
}

void attractor_close(struct attractor_shaft *s)
{
    stroboscope_end(&s->map);
    stroboscope_end(&s->fine);
}

static void paper_of(const struct attractor_shaft *s, const double *x, double *state)
{
    s->plant.model->paper_state(s->plant.p, s->map.tick[0].at[0], x, state);
}

/* The least period after which the state came back three
 * times; 0: none in so many periods. -1: it could not be run. */
static int settle(const struct attractor_shaft *s, double *x, int periods)
{
    struct basin_repeat r;
    int n = s->plant.model->n_states, period = 0;
    basin_repeat_start(&r, x, n);
    for (int i = 0; i < periods && period == 0; i++) {
        if (stroboscope_advance(&s->map, x, NULL) != BASIN_GOOD)
            return -1;
        period = basin_repeat_see(&r, x, n, repeat);
    }
    return period;
}

/* The paper's extremes of one rate or position per mass, from those of the model. */
static void measure(const struct attractor_shaft *s, const struct stroboscope_sum *sum, struct attractor *a)
{
    double high[MODEL_STATES], low[MODEL_STATES];
    paper_of(s, sum->high, high);
    paper_of(s, sum->low, low);
    for (int i = 0; i < 6; i++) {
        bool kept = s->plant.model == &shaft_bearing_mode;
        double phi = kept ? s->plant.p[SHAFT_P_SHAPE + i % 3] : 1.0;
        int from = kept ? i / 3 : i;
        a->high[i] = phi * (phi > 0.0 ? high : low)[from];
        a->low[i] = phi * (phi > 0.0 ? low : high)[from];
    }
}

bool attractor_settle(const struct attractor_shaft *s, const double *state, double seconds,
                      struct attractor *a)
{
    const struct basin_plant *b = &s->plant;
    struct stroboscope_sum sum;
    double x[MODEL_STATES] = {0.0};
    if (state)
        b->model->state_from_paper(b->p, s->map.tick[0].at[0], state, x);
    a->period = settle(s, x, (int)ceil(seconds * s->hz));
    int look = a->period > 0 ? a->period : ATTRACTOR_LOOK;
    stroboscope_sum_start(&sum);
    for (int i = 0; i < look && a->period >= 0; i++) {
        if (stroboscope_advance(&s->fine, x, &sum) != BASIN_GOOD)
            a->period = -1;
    }
    if (a->period < 0)
        return false;
    a->loss = sum.open / (look * b->period);
    a->switches = sum.switches / look;
    measure(s, &sum, a);
    paper_of(s, x, a->state);
    return true;
}

double attractor_exponent(const struct attractor_shaft *s, const double *state, bool unison, int periods)
{
    double here[MODEL_STATES] = {0.0}, there[MODEL_STATES], sum = 0.0;
    const double apart = 1e-9;
    int n = s->plant.model->n_states;
    if (state)
        s->plant.model->state_from_paper(s->plant.p, s->map.tick[0].at[0], state, here);
    memcpy(there, here, sizeof there);
    there[0] += apart;
    for (int i = 0; i < periods; i++) {
        double size = 0.0;
        if (stroboscope_advance(&s->map, here, NULL) != BASIN_GOOD ||
            stroboscope_advance(&s->map, there, NULL) != BASIN_GOOD)
            return (double)NAN;
        if (unison) {
            here[2] = here[0];
            here[5] = here[3];
        }
        for (int k = 0; k < n; k++)
            size += (there[k] - here[k]) * (there[k] - here[k]);
        size = sqrt(size);
        sum += log(size / apart);
        for (int k = 0; k < n; k++)
            there[k] = here[k] + (there[k] - here[k]) * apart / size;
    }
    return sum * s->hz / periods;
}

static bool impacts(const struct attractor *a)
{
    return a->period == 0 && a->switches >= 1.0;
}

double attractor_mean_exponent(const struct attractor_shaft *s, double span, double seconds, int starts,
                               int *counted)
{
    double state[MODEL_STATES], sum = 0.0;
    struct attractor before, after;
    uint64_t seed = 1;
    *counted = 0;
    for (int i = 0; i < starts; i++) {
        attractor_start(&seed, span, state);
        if (!attractor_settle(s, state, seconds, &before) ||
            !attractor_settle(s, before.state, seconds, &after))
            return (double)NAN;
        if (!impacts(&before) || !impacts(&after))
            continue;
        sum += attractor_exponent(s, before.state, false, (int)(seconds * s->hz));
        ++*counted;
    }
    return sum / *counted;
}
