/* slope.h - of the line through n points by least squares: an order of convergence, from logarithms of steps and errors. */
#ifndef TESTS_SLOPE_H
#define TESTS_SLOPE_H

static inline double slope(const double *x, const double *y, int n)
{
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (int i = 0; i < n; i++) {
        sx += x[i];
        sy += y[i];
        sxx += x[i] * x[i];
        sxy += x[i] * y[i];
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

#endif
