/* test_basin.c - starts, returns, clusters, intervals of
 * confidence: the parts of a basin map, against closed forms. */
#include "host_sim/maps/basin/basin_cells.h"
#include "host_sim/maps/basin/basin_clusters.h"
#include "host_sim/maps/basin/basin_repeat.h"
#include "host_sim/maps/basin/basin_starts.h"
#include "models/shaft_bearing.h"
#include "tests/unit/test.h"

#include <math.h>

enum { N_STARTS = 200 };

/* ---- starts ---- */

static const struct basin_box start_box = {{-1.0, 0.0, 5.0}, {1.0, 10.0, 5.0}};

/* How many of the n strata of state k hold exactly one start. */
static int single(const struct basin_starts *s, int k)
{
    int seen[N_STARTS] = {0}, good = 0;
    for (int i = 0; i < s->n; i++) {
        double x[MODEL_STATES], side = s->box.high[k] - s->box.low[k];
        basin_starts_get(s, i, x);
        int stratum = (int)((x[k] - s->box.low[k]) / side * s->n);
        if (stratum >= 0 && stratum < s->n)
            seen[stratum]++;
    }
    for (int i = 0; i < s->n; i++)
        good += seen[i] == 1;
    return good;
}

/* Correlation of the first two states. */
static double correlation(const struct basin_starts *s)
{
    double sum = 0.0;
    for (int i = 0; i < s->n; i++) {
        double x[MODEL_STATES];
        basin_starts_get(s, i, x);
        sum += x[0] * (x[1] - 5.0) / 5.0 * 3.0;
    }
    return sum / s->n;
}

TEST(basin_hypercube)
{
    struct basin_starts a, b, c;
    double x[MODEL_STATES], y[MODEL_STATES], z[MODEL_STATES];
    check_true("memory", basin_starts_make(&a, N_STARTS, 3, 7, &start_box) &&
                             basin_starts_make(&b, N_STARTS, 3, 7, &start_box) &&
                             basin_starts_make(&c, N_STARTS, 3, 8, &start_box));
    check_int("strata of state 0 with one start each", single(&a, 0), N_STARTS);
    check_int("strata of state 1 with one start each", single(&a, 1), N_STARTS);
    check_below("states are drawn independently: |correlation|, 3 deviations", fabs(correlation(&a)),
                3.0 / sqrt(N_STARTS));
    basin_starts_get(&a, 123, x);
    basin_starts_get(&b, 123, y);
    basin_starts_get(&c, 123, z);
    check_bytes("the same seed, the same start", x, y, 3 * sizeof *x);
    check_true("another seed, another start", x[0] < z[0] || x[0] > z[0]);
    check_near("a side without width", x[2], 5.0, 0.0);
    basin_starts_free(&a);
    basin_starts_free(&b);
    basin_starts_free(&c);
}

/* ---- intervals ---- */

TEST(basin_wilson)
{
    /* Newcombe, Statist. Med. 17 (1998) 857-872, table I, method 3 */
    static const struct {
        int k, n;
        double low, high;
    } published[] = {{81, 263, 0.2553, 0.3662},
                     {15, 148, 0.0624, 0.1605},
                     {0, 20, 0.0000, 0.1611},
                     {1, 29, 0.0061, 0.1718}};
    for (int i = 0; i < 4; i++) {
        double low, high;
        basin_clusters_wilson(published[i].k, published[i].n, &low, &high);
        check_near("Wilson's lower end", low, published[i].low, 5.1e-5);
        check_near("Wilson's upper end", high, published[i].high, 5.1e-5);
    }
    double low, high;
    basin_clusters_wilson(29, 29, &low, &high);
    check_near("all of n: upper end", high, 1.0, 0.0);
}

/* ---- returns ---- */

/* Period told of a sequence in the plane: a cycle of `period`
 * points and a decay that turns by `turn` of a circle. */
static int told(int period, double decay, double turn, int bound, int *at)
{
    struct basin_repeat r;
    double angle = 2.0 * acos(-1.0);
    for (int i = 0; i <= bound; i++) {
        double phase = angle * i / period, size = exp(-decay * i);
        double x[2] = {cos(phase) + size * cos(angle * turn * i), sin(phase) + size * sin(angle * turn * i)};
        if (i == 0)
            basin_repeat_start(&r, x, 2);
        int k = i > 0 ? basin_repeat_see(&r, x, 2, 1e-8) : 0;
        *at = i;
        if (k > 0)
            return k;
    }
    return 0;
}

TEST(basin_returns)
{
    static const int period[] = {1, 2, 3, 7, 32};
    int at;
    for (int i = 0; i < 5; i++)
        check_int("period of a cycle with a slow decay", told(period[i], 0.004, 0.1234, 20000, &at),
                  period[i]);
    /* 11 decaying turns bring it near long before a single one does */
    check_int("a decay that turns by 1/11 is no period of 11", told(1, 0.004, 1.0 / 11.0, 20000, &at), 1);
    check_int("nor one by 1/3 a period of 3", told(1, 0.004, 1.0 / 3.0, 20000, &at), 1);
    check_above("told only when the decay is over: periods", at,
                log(1e8 * (1.0 - exp(-0.012))) / 0.004 - 100.0);
}

/* Period told of the logistic map. */
static int logistic(double r, double x)
{
    struct basin_repeat repeat;
    basin_repeat_start(&repeat, &x, 1);
    for (int i = 0; i < 20000; i++) {
        x = r * x * (1.0 - x);
        int k = basin_repeat_see(&repeat, &x, 1, 1e-8);
        if (k > 0)
            return k;
    }
    return 0;
}

TEST(basin_no_return)
{
    int at;
    check_int("the golden mean's rotation has no period", told(1, 0.0, 0.5 * (sqrt(5.0) - 1.0), 5000, &at),
              0);
    check_int("nor has a cycle of 33", told(33, 0.01, 0.0, 5000, &at), 0);
    check_int("logistic map, r 3.2", logistic(3.2, 0.3), 2);
    check_int("logistic map, r 3.5", logistic(3.5, 0.3), 4);
    check_int("logistic map, r 3.55", logistic(3.55, 0.3), 8);
    check_int("logistic map, r 3.83: the window of 3", logistic(3.83, 0.3), 3);
    check_int("logistic map, r 3.9: chaos", logistic(3.9, 0.3), 0);
}

/* ---- clusters ---- */

static struct basin_motion motion_of(int period, double mean1, double mean3)
{
    struct basin_motion m = {.outcome = BASIN_SETTLED, .period = period, .growth = -0.1};
    m.mean[0] = mean1;
    m.mean[2] = mean3;
    for (int i = 0; i < 6; i++)
        m.rms[i] = 1.0;
    return m;
}

TEST(basin_mirrors)
{
    static struct basin_clusters c;
    const struct basin_motion gone = {.outcome = BASIN_GONE};
    struct basin_motion wobble = {.outcome = BASIN_UNSETTLED, .growth = 0.001},
                        chaos = {.outcome = BASIN_UNSETTLED};
    chaos.growth = 0.5;
    for (int i = 0; i < 6; i++)
        wobble.rms[i] = chaos.rms[i] = 1.0;
    basin_clusters_start(&c, &shaft_bearing);
    const struct basin_motion seen[] = {motion_of(1, 0.0, 0.0),
                                        motion_of(1, 1e-4, -1e-4),
                                        motion_of(1, 1e-5, 0.0),
                                        motion_of(2, 0.3, 0.1),
                                        motion_of(2, 0.3001, 0.1),
                                        motion_of(2, -0.3, -0.1),
                                        motion_of(3, 0.0, 0.0),
                                        gone,
                                        wobble,
                                        chaos};
    int order[16];
    for (int i = 0; i < 10; i++)
        check_int("a motion counts", basin_clusters_add(&c, &seen[i]) >= -1, 1);
    basin_clusters_finish(&c, order);
    check_int("attractors: 1, 2 and its mirror image, 3, aperiodic, chaotic", c.n, 6);
    check_int("total", c.total, 10);
    check_int("escaped", c.escaped, 1);
    check_int("the most frequent", c.attractor[0].count, 3);
    check_int("which was the first seen", order[0], 0);
    check_int("is its own mirror image", c.attractor[0].image[IMAGE_MIRROR], 0);
    check_int("the broken one is not", c.attractor[1].image[IMAGE_MIRROR], order[2]);
    check_int("and vice versa", c.attractor[order[2]].image[IMAGE_MIRROR], 1);
    check_int("its ends exchanged were not seen", c.attractor[1].image[IMAGE_ENDS], -1);
    check_int("a motion without period is no period-1 motion", c.attractor[0].count + c.attractor[1].count,
              5);
}

/* ---- cells ---- */

/* Four starts, one at each corner of the unit square: each has the quarter that is next to it. */
TEST(basin_cells_have_the_nearest_start)
{
    static struct basin_cells c;
    const double x[] = {0.0, 1.0, 0.0, 1.0}, y[] = {0.0, 0.0, 1.0, 1.0};
    int wrong = 0;
    basin_cells_make(&c, x, y, 4);
    for (int i = 0; i < BASIN_LINES * BASIN_COLUMNS; i++) {
        int line = i / BASIN_COLUMNS, column = i % BASIN_COLUMNS;
        wrong += c.start[line][column] != 2 * (line >= BASIN_LINES / 2) + (column >= BASIN_COLUMNS / 2);
    }
    check_int("cells of a start in another quarter", wrong, 0);
    check_near("the last column ends at the last start", c.x + BASIN_COLUMNS * c.width, 1.0, 1e-12);
    check_near("and the last line", c.y + BASIN_LINES * c.height, 1.0, 1e-12);
    basin_cells_make(&c, x, y, 1);
    check_int("one start spans no plane", c.start[0][0], -1);
}
