/* test_chatter.c - impacts that follow each other ever faster: every contact is found, and none invented.
 *
 * The count is compared with that of a method that knows nothing of contacts. It is RK4 of the shaft's
 * equation in SI in steps of 1 us; signs of the gaps are compared after each. Both take each tick from the
 * same state, so that the growth of errors has no part in it. */
#include "tests/unit/test.h"

#include <math.h>
#include <string.h>
#include "models/shaft_bearing.h"
#include "tests/fixture/paper.h"
#include "tests/fixture/trajectory.h"

#define TWO_PI 6.283185307179586477

enum { MICROSECONDS = 250, PER_PERIOD = 800, CHATTER_PERIODS = 4 };

static double scratch[METHOD_SCRATCH];
static double chatter_paper[MODEL_PARAMETERS];

/* M x'' + C x' + K x + f_gap = p cos(2 pi f t), state (x, v). */
static void rate_at(double t, const double *x, double *d)
{
    const double *a = chatter_paper;
    double bend = a[SHAFT_KAPPA] / (a[SHAFT_LENGTH] * a[SHAFT_LENGTH]) * (x[0] - 2.0 * x[1] + x[2]);
    double drive = 25.0 * cos(TWO_PI * 5.0 * t);
    double stop1 = a[SHAFT_KG1] * (fmax(x[0] - a[SHAFT_G1], 0.0) + fmin(x[0] + a[SHAFT_G1], 0.0));
    double stop3 = a[SHAFT_KG3] * (fmax(x[2] - a[SHAFT_G3], 0.0) + fmin(x[2] + a[SHAFT_G3], 0.0));
    memcpy(d, x + 3, 3 * sizeof *d);
    d[3] = (-a[SHAFT_C1] * x[3] - 2.0 * a[SHAFT_KS1] * x[0] - bend - stop1) / a[SHAFT_M1];
    d[4] = (drive - a[SHAFT_C2] * x[4] + 2.0 * bend) / a[SHAFT_M2];
    d[5] = (-a[SHAFT_C3] * x[5] - 2.0 * a[SHAFT_KS3] * x[2] - bend - stop3) / a[SHAFT_M3];
}

static void dense_step(double t, double h, double *x)
{
    static const double part[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    double k[6] = {0}, y[6], sum[6] = {0};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 6; i++)
            y[i] = x[i] + part[stage] * h * k[i];
        rate_at(t + part[stage] * h, y, k);
        for (int i = 0; i < 6; i++)
            sum[i] += weight[stage] * k[i];
    }
    for (int i = 0; i < 6; i++)
        x[i] += h * sum[i];
}

/* Bit i: contact i closed. */
static unsigned closed(const double *x)
{
    return (unsigned)(x[0] > chatter_paper[SHAFT_G1]) | (unsigned)(x[0] < -chatter_paper[SHAFT_G1]) << 1 |
           (unsigned)(x[2] > chatter_paper[SHAFT_G3]) << 2 | (unsigned)(x[2] < -chatter_paper[SHAFT_G3]) << 3;
}

static void count_dense(double t, double *x, int *n)
{
    unsigned before = closed(x);
    for (int i = 0; i < MICROSECONDS; i++) {
        dense_step(t + i * 1e-6, 1e-6, x);
        unsigned now = closed(x), changed = now ^ before;
        for (int c = 0; c < SHAFT_CONTACTS; c++)
            n[c] += (changed >> c) & 1u;
        before = now;
    }
}

static void count_events(struct plant *pl, int *n)
{
    struct event e;
    while (plant_take_event(pl, &e))
        n[e.contact]++;
}

/* Damping c diag(1, middle, 1). */
static void check_chatter(double c, double middle, int at_least)
{
    struct plant pl;
    int missed = 0, invented = 0, total = 0;
    double apart = 0.0, x[6], state[6];
    const double start_at[6] = {2.286e-4, 0, 0, 0, 0, 0}; /* 0.9 gaps */
    paper_defaults(&shaft_bearing, chatter_paper);
    chatter_paper[SHAFT_C1] = chatter_paper[SHAFT_C3] = c;
    chatter_paper[SHAFT_C2] = middle * c;
    chatter_paper[paper_index(&shaft_bearing, "freq_hz")] = 5.0;
    chatter_paper[paper_index(&shaft_bearing, "p2")] = 25.0;
    paper_start_by(&pl, &shaft_bearing, &exact, 0.0, scratch, chatter_paper, MICROSECONDS * 1e-6, start_at);
    for (int i = 0; i < CHATTER_PERIODS * PER_PERIOD; i++) {
        int found[SHAFT_CONTACTS] = {0}, dense[SHAFT_CONTACTS] = {0};
        paper_now(&pl, x);
        count_dense(i * MICROSECONDS * 1e-6, x, dense);
        if (!plant_run(&pl, 1))
            check_true("a finite motion", 0);
        count_events(&pl, found);
        paper_now(&pl, state);
        for (int k = 0; k < SHAFT_CONTACTS; k++) {
            missed += found[k] < dense[k];
            invented += found[k] > dense[k];
            total += dense[k];
        }
        for (int k = 0; k < 3; k++)
            apart = fmax(apart, fabs(state[k] - x[k]) / chatter_paper[SHAFT_G1]);
    }
    check_above("switches", total, at_least);
    check_int("ticks in which a contact switched unseen", missed, 0);
    check_int("ticks in which one switched that did not", invented, 0);
    check_below("worst distance of a tick's end, gaps", apart, 1e-6);
}

TEST(chatter_dense)
{
    check_chatter(139.0, 1.0, 600);
    check_chatter(139.0, 2.0, 400);
    check_chatter(4.0, 1.0, 300);
}
