/* test_decimate.c - rows in bins against the rows themselves, and open time against closed forms. */
#include "host_sim/report/decimate.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdlib.h>

enum { ROWS = 5000 };

static double value_at(int i)
{
    return sin(0.7 * i) + (i == 3333 ? 10.0 : 0.0);
}

/* Every bin against all of its rows, for numbers of rows around each halving. */
TEST(decimate_keeps_extremes)
{
    struct decimate *d = malloc(sizeof *d);
    int bad = 0, n_max = 0;
    for (int rows = 1; rows <= ROWS; rows += rows % 1024 == 0 || rows % 1024 == 1023 ? 1 : 33) {
        decimate_begin(d, 1);
        for (int i = 0; i < rows; i++) {
            double y = value_at(i);
            decimate_add(d, 0.5 * i, &y);
        }
        for (size_t b = 0; b < d->n; b++) {
            double low = HUGE_VAL, high = -HUGE_VAL;
            size_t first = b * d->per;
            for (size_t i = first; i < first + d->per && i < (size_t)rows; i++) {
                low = fmin(low, value_at((int)i));
                high = fmax(high, value_at((int)i));
            }
            bad += low < d->low[0][b] || low > d->low[0][b] || high < d->high[0][b] || high > d->high[0][b] ||
                   fabs(d->x[b] - 0.5 * (double)first) > 0.0;
        }
        bad += d->n * d->per < (size_t)rows || (d->n - 1) * d->per >= (size_t)rows || d->rows != (size_t)rows;
        n_max = (int)d->n > n_max ? (int)d->n : n_max;
    }
    check_int("bins that are not what their rows say", bad, 0);
    check_int("most bins", n_max, DECIMATE_BINS);
    free(d);
}

TEST(decimate_leaves_no_number_out)
{
    struct decimate *d = malloc(sizeof *d);
    const double gap[2] = {(double)NAN, 1.0}, number[2] = {2.0, (double)NAN};
    decimate_begin(d, 2);
    for (int i = 0; i < 2 * DECIMATE_BINS; i++)
        decimate_add(d, i, i % 2 ? gap : number);
    check_near("a number beside a NaN, low", d->low[0][5], 2.0, 0.0);
    check_near("a number beside a NaN, high", d->high[1][5], 1.0, 0.0);
    free(d);
}

/* Open from 1/3 to 2/3 of every unit: a third of each part that is a unit wide, and of all. */
TEST(decimate_open_time)
{
    struct decimate_open *d = malloc(sizeof *d);
    double sum = 0.0, worst = 0.0;
    decimate_open_begin(d, 0.0, DECIMATE_BINS, 0);
    for (int i = 0; i < DECIMATE_BINS; i++) {
        decimate_open_add(d, i + 1.0 / 3.0, 1);
        decimate_open_add(d, i + 2.0 / 3.0, 0);
    }
    decimate_open_add(d, DECIMATE_BINS, 0);
    for (int i = 0; i < DECIMATE_BINS; i++)
        worst = fmax(worst, fabs(d->share[i] - 1.0 / 3.0));
    check_near("a third of each part", worst, 0.0, 1e-9);
    decimate_open_begin(d, 0.0, 1.0, 1);
    decimate_open_add(d, 0.3337, 0);
    decimate_open_add(d, 2.0, 0);
    for (int i = 0; i < DECIMATE_BINS; i++)
        sum += d->share[i] / DECIMATE_BINS;
    check_near("one span over many parts", sum, 0.3337, 1e-12);
    free(d);
}
