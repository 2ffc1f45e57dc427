/* decimate.c - see decimate.h. */
#include "host_sim/report/decimate.h"

#include <math.h>

void decimate_begin(struct decimate *d, int n_columns)
{
    d->n_columns = n_columns;
    d->n = d->rows = 0;
    d->per = 1;
}

/* Two neighbours become one. */
static void halve(struct decimate *d)
{
    for (size_t i = 0; i < DECIMATE_BINS / 2; i++) {
        d->x[i] = d->x[2 * i];
        for (int k = 0; k < d->n_columns; k++) {
            d->low[k][i] = fmin(d->low[k][2 * i], d->low[k][2 * i + 1]);
            d->high[k][i] = fmax(d->high[k][2 * i], d->high[k][2 * i + 1]);
        }
    }
    d->n = DECIMATE_BINS / 2;
    d->per *= 2;
}

void decimate_add(struct decimate *d, double x, const double *value)
{
    if (d->rows == d->per * DECIMATE_BINS)
        halve(d);
    if (d->rows % d->per == 0) {
        d->x[d->n] = x;
        for (int k = 0; k < d->n_columns; k++)
            d->low[k][d->n] = d->high[k][d->n] = (double)NAN;
        d->n++;
    }
    for (int k = 0; k < d->n_columns; k++) { /* fmin and fmax take the number before a NaN */
        d->low[k][d->n - 1] = fmin(d->low[k][d->n - 1], value[k]);
        d->high[k][d->n - 1] = fmax(d->high[k][d->n - 1], value[k]);
    }
    d->last = x;
    d->rows++;
}

void decimate_open_begin(struct decimate_open *d, double from, double to, int open)
{
    *d = (struct decimate_open){.from = from, .to = to, .since = from, .open = open};
}

void decimate_open_add(struct decimate_open *d, double t, int open)
{
    double part = (d->to - d->from) / DECIMATE_BINS;
    double a = fmax(d->since, d->from), b = fmin(t, d->to);
    for (int i = (int)fmin((a - d->from) / part, DECIMATE_BINS - 1); d->open && i < DECIMATE_BINS; i++) {
        double left = d->from + i * part;
        if (!(left < b))
            break;
        d->share[i] += d->open == DECIMATE_UNKNOWN ? (double)NAN
                                                   : fmax(0.0, fmin(b, left + part) - fmax(a, left)) / part;
    }
    d->since = t;
    d->open = open;
}
