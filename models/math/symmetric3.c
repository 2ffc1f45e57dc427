/* symmetric3.c - the eigenvalues of a symmetric 3x3 matrix by Jacobi rotations; see symmetric3.h. */
#include "models/math/symmetric3.h"

#include <math.h>

/* One rotation in the plane (i, j) that makes a[i][j] zero; the rows of v turn along. */
static void rotate(double a[3][3], double v[3][3], int i, int j)
{
    if (a[i][j] == 0.0)
        return;
    double half = 0.5 * (a[j][j] - a[i][i]) / a[i][j];
    double t = (half >= 0.0 ? 1.0 : -1.0) / (fabs(half) + sqrt(half * half + 1.0)); /* tangent, |t| <= 1 */
    double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
    for (int k = 0; k < 3; k++) {
        double x = a[k][i], y = a[k][j];
        a[k][i] = c * x - s * y;
        a[k][j] = s * x + c * y;
    }
    for (int k = 0; k < 3; k++) {
        double x = a[i][k], y = a[j][k], p = v[i][k], q = v[j][k];
        a[i][k] = c * x - s * y;
        a[j][k] = s * x + c * y;
        v[i][k] = c * p - s * q;
        v[j][k] = s * p + c * q;
    }
}

static void swap_if_above(double value[3], double v[3][3], int i, int j)
{
    if (!(value[i] > value[j]))
        return;
    double x = value[i];
    value[i] = value[j];
    value[j] = x;
    for (int k = 0; k < 3; k++) {
        x = v[i][k];
        v[i][k] = v[j][k];
        v[j][k] = x;
    }
}

void symmetric3_eigen(double a[3][3], double value[3], double vector[3][3])
{
    enum { SWEEPS = 12 };
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            vector[i][j] = i == j ? 1.0 : 0.0;
    for (int i = 0; i < SWEEPS; i++) {
        rotate(a, vector, 0, 1);
        rotate(a, vector, 0, 2);
        rotate(a, vector, 1, 2);
    }
    for (int i = 0; i < 3; i++)
        value[i] = a[i][i];
    swap_if_above(value, vector, 0, 1);
    swap_if_above(value, vector, 1, 2);
    swap_if_above(value, vector, 0, 1);
}
