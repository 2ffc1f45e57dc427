/* test_batch_series.c - the series of batches against the scalar ones, which
 * tests/unit/taylor/test_taylor_series.c holds against plain convolutions in extended precision; roots
 * against closed forms. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/method/taylor/taylor_load.h"
#include "firmware/method/taylor/taylor_regular.h"
#include "firmware/method/taylor/taylor_series.h"
#include "host_sim/batch/batch_root.h"
#include "host_sim/batch/batch_series.h"
#include "tests/fixture/exact.h"

enum { CASES = 40, COMMON = (int)BATCH_ORDER < (int)TAYLOR_ORDER ? (int)BATCH_ORDER : (int)TAYLOR_ORDER };

static double between(uint64_t *seed, double a, double b)
{
    return a + (b - a) * exact_uniform(seed);
}

/* Draws a load, equal for one lane of a batch and for the scalar series. */
static void random_load(uint64_t *seed, int n_tones, struct batch_load *batch, int lane,
                        struct taylor_load *scalar)
{
    memset(scalar, 0, sizeof *scalar);
    scalar->damping = between(seed, 0.0, 0.5);
    scalar->stiffness = n_tones == BATCH_TONES ? between(seed, 0.0, 1.0) : 0.0;
    scalar->constant[0] = between(seed, -1.0, 1.0);
    scalar->constant[1] = between(seed, 0.3, 2.0);
    scalar->n_tones = n_tones;
    for (int i = 0; i < n_tones; i++) {
        struct taylor_tone *t = &scalar->tone[i];
        t->lane = i == BATCH_STIFFNESS_TONE;
        t->omega = between(seed, 0.1, 5.0);
        t->p = between(seed, -0.5, 0.5);
        t->q = between(seed, -0.5, 0.5);
        scalar->varies |= 1u << t->lane;
        batch->tone[i].omega[lane] = t->omega;
        batch->tone[i].p[lane] = t->p;
        batch->tone[i].q[lane] = t->q;
    }
    batch->damping[lane] = scalar->damping;
    batch->stiffness[lane] = scalar->stiffness;
    batch->constant[lane] = scalar->constant[0];
    batch->hertz[lane] = scalar->constant[1];
}

/* Worst difference up to the common order, relative to the largest coefficient so far. */
static void compare(const double *scalar, const quad *batch, int lane, int last, double *worst)
{
    double size = 1e-3;
    for (int n = 0; n <= last; n++) {
        size = fmax(size, fabs(scalar[n]));
        *worst = fmax(*worst, fabs(scalar[n] - batch[n][lane]) / size);
    }
}

static void check_load(uint64_t *seed, int n_tones, double *worst)
{
    struct batch_load load[BATCH_WIDE];
    struct batch_series regular[BATCH_WIDE], flight[BATCH_WIDE], contact[BATCH_WIDE];
    struct taylor_load scalar[BATCH_WIDE][QUAD];
    quad x[BATCH_WIDE], v[BATCH_WIDE];
    double a[TAYLOR_TERMS], b[TAYLOR_TERMS], c[TAYLOR_TERMS];
    memset(load, 0, sizeof load);
    for (int i = 0; i < BATCH_WIDE * QUAD; i++) {
        random_load(seed, n_tones, &load[i / QUAD], i % QUAD, &scalar[i / QUAD][i % QUAD]);
        x[i / QUAD][i % QUAD] = between(seed, 0.5, 2.0);
        v[i / QUAD][i % QUAD] = between(seed, -1.0, 1.0);
    }
    batch_series_regular(load, n_tones, x, v, regular);
    batch_series_flight(load, n_tones, x, v, flight);
    batch_series_contact(load, n_tones, x, v, contact);
    for (int i = 0; i < BATCH_WIDE * QUAD; i++) {
        int w = i / QUAD, lane = i % QUAD;
        taylor_regular(&scalar[w][lane], x[w][lane], v[w][lane], a, b, c);
        compare(a, regular[w].a, lane, COMMON, &worst[0]);
        compare(b, regular[w].b, lane, COMMON, &worst[0]);
        compare(c, regular[w].time, lane, COMMON, &worst[0]);
        taylor_flight(&scalar[w][lane], x[w][lane], v[w][lane], a);
        compare(a, flight[w].a, lane, COMMON, &worst[1]);
        taylor_contact(&scalar[w][lane], x[w][lane], v[w][lane], a, b);
        compare(a, contact[w].a, lane, COMMON, &worst[2]);
        compare(b, contact[w].force, lane, COMMON - 2, &worst[2]);
    }
}

TEST(batch_series)
{
    uint64_t seed = 9;
    for (int n_tones = 1; n_tones <= BATCH_TONES; n_tones++) {
        double worst[3] = {0.0};
        for (int i = 0; i < CASES; i++)
            check_load(&seed, n_tones, worst);
        check_below(check_name("%d tones: regularised contact, worst coefficient", n_tones), worst[0], 1e-12);
        check_below(check_name("%d tones: flight, worst coefficient", n_tones), worst[1], 1e-13);
        check_below(check_name("%d tones: contact in time, worst coefficient", n_tones), worst[2], 1e-11);
    }
}

/* (x - r) (x + 1), its negative, x (x - r), a dip between the
 * points that are looked at, a root before it and after it. */
TEST(batch_root)
{
    static const double c[7][4] = {
        {-0.3, 0.7, 1.0, 0.0},  {0.0, -0.3, 1.0, 0.0}, {-0.011, 0.21, -1.0, 0.0}, {-0.0111, 0.21, -1.0, 0.0},
        {-0.1, -0.1, 0.0, 0.0}, {-2.0, 1.0, 0.0, 0.0}, {-1e-9, 1e-3, 0.0, 0.0}};
    static const double root[7] = {0.3, 0.3, 0.1, -1.0, -1.0, -1.0, 1e-6};
    for (int i = 0; i < 7; i++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            struct batch_series s;
            struct batch_root r;
            quad end = all_lanes(1.0);
            memset(&s, 0, sizeof s);
            for (int lane = 0; lane < QUAD; lane++) { /* other company in other lanes */
                const double *k = c[(i + lane) % 7];
                for (int n = 0; n < 4; n++)
                    s.a[n][lane] = sign * k[n];
                for (int n = 0; n < 3; n++)
                    s.b[n][lane] = sign * (n + 1) * k[n + 1];
            }
            batch_series_root(&s, sign, &end, &r);
            check_near("root, 1 where there is none", r.at[0], root[i] < 0.0 ? 1.0 : root[i], 1e-15);
            check_is("found or not", (r.found[0] != 0), ==, (root[i] > 0.0));
            check_int("found or not", r.residual[0], 0);
        }
    }
}

TEST(batch_cos_sin)
{
    double worst = 0.0;
    uint64_t seed = 2;
    for (int i = 0; i < 20000; i++) {
        double turns = between(&seed, -20.0, 20.0);
        quad c, s;
        cos_sin_of(all_lanes(turns), &c, &s);
        worst = fmax(worst, fabs(c[0] - (double)cosl(EXACT_TURN * (long double)turns)));
        worst = fmax(worst, fabs(s[0] - (double)sinl(EXACT_TURN * (long double)turns)));
    }
    check_below("cosine and sine of turns, worst error", worst, 5e-16);
}
