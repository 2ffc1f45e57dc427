/* attractor.c - see attractor.h. */
#include "tests/papers/attractor.h"

#include <complex.h>
#include <math.h>
#include <string.h>
#include "models/symmetric3.h"
#include "tests/exact.h"
#include "tests/paper.h"

static const double radians_a_tick = 2.0; /* of the fastest eigenfrequency; the guard is at 2.1 */
static const double same = 2e-3;          /* of the gap: two states are one */
static const double bend[3] = {1.0, -2.0, 1.0};

void attractor_paper(double gap_stiffness, double hz, double *paper)
{
    paper_defaults(&shaft_bearing, paper);
    paper[SHAFT_KG1] = paper[SHAFT_KG3] = gap_stiffness;
    paper[SHAFT_PAPER_HZ] = hz;
}

void attractor_frequencies(const double *paper, double share, double hz[3])
{
    double a[3][3], vector[3][3], kL = paper[SHAFT_KAPPA] / (paper[SHAFT_LENGTH] * paper[SHAFT_LENGTH]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a[i][j] = kL * bend[i] * bend[j] / sqrt(paper[SHAFT_M1 + i] * paper[SHAFT_M1 + j]);
    a[0][0] += (2.0 * paper[SHAFT_KS1] + share * paper[SHAFT_KG1]) / paper[SHAFT_M1];
    a[2][2] += (2.0 * paper[SHAFT_KS3] + share * paper[SHAFT_KG3]) / paper[SHAFT_M3];
    symmetric3_eigen(a, hz, vector);
    for (int i = 0; i < 3; i++)
        hz[i] = sqrt(fmax(hz[i], 0.0)) / MOTION_TWO_PI;
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

static bool close_to(const double *a, const double *b, double gap, double speed)
{
    double worst = 0.0;
    for (int i = 0; i < 3; i++)
        worst = fmax(worst, fmax(fabs(a[i] - b[i]) / gap, fabs(a[3 + i] - b[3 + i]) / speed));
    return worst < same;
}

/* The least period of the stroboscopic points. */
static int period_of(double point[][MODEL_STATES], double gap, double speed)
{
    for (int n = 1; n <= ATTRACTOR_PERIODS; n++) {
        bool fits = true;
        for (int i = 0; i + n < ATTRACTOR_LOOK && fits; i++)
            fits = close_to(point[i], point[i + n], gap, speed);
        if (fits)
            return n;
    }
    return 0;
}

bool attractor_settle(struct motion *m, const struct model *model, const double *paper, const double *state,
                      double seconds, struct attractor *a)
{
    static double point[ATTRACTOR_LOOK][MODEL_STATES];
    int ticks = attractor_ticks(paper);
    double hz = paper[SHAFT_PAPER_HZ], size = paper[SHAFT_G1], now[MODEL_STATES];
    uint64_t periods = (uint64_t)ceil(seconds * hz);
    if (motion_start(m, model, paper, 1.0 / (hz * ticks), 0.0, state) != NULL ||
        !plant_run(&m->pl, periods * (uint64_t)ticks))
        return false;
    uint32_t switches = m->pl.counts.switches;
    m->pl.loss_time = m->pl.total_time = 0.0;
    for (int k = 0; k < 3; k++) {
        a->high[k] = -HUGE_VAL;
        a->low[k] = HUGE_VAL;
    }
    memset(point, 0, sizeof point);
    for (int i = 0; i < ATTRACTOR_LOOK; i++) {
        motion_state(m, point[i]);
        for (int j = 0; j < ticks; j++) {
            if (!plant_run(&m->pl, 1))
                return false;
            motion_state(m, now);
            for (int k = 0; k < model->n_states / 2; k++) {
                a->high[k] = fmax(a->high[k], now[k]);
                a->low[k] = fmin(a->low[k], now[k]);
            }
        }
    }
    for (int k = 0; k < model->n_states / 2; k++)
        size = fmax(size, a->high[k] - a->low[k]);
    a->period = period_of(point, size, size * MOTION_TWO_PI * hz);
    a->loss = m->pl.loss_time / m->pl.total_time;
    a->switches = (double)(m->pl.counts.switches - switches) / ATTRACTOR_LOOK;
    motion_state(m, a->state);
    return true;
}
