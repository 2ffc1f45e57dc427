/* matrix.c - see matrix.h. */
#include "host_sim/fit/solve/matrix.h"

#include <math.h>
#include <string.h>

enum { SQUARINGS = 12, JACOBI_ROUNDS = 40 };
static const double grown = 1e6, vanished = 1e-3;

static void swap(double *a, double *b)
{
    double was = *a;
    *a = *b;
    *b = was;
}

static void exchange_rows(int n, double a[MATRIX_MAX][MATRIX_MAX], double *b, int i, int k)
{
    for (int c = 0; c < n; c++)
        swap(&a[i][c], &a[k][c]);
    swap(&b[i], &b[k]);
}

bool matrix_solve(int n, double a[MATRIX_MAX][MATRIX_MAX], double *b)
{
    for (int i = 0; i < n; i++) {
        int pivot = i;
        for (int k = i + 1; k < n; k++)
            pivot = fabs(a[k][i]) > fabs(a[pivot][i]) ? k : pivot;
        if (!(fabs(a[pivot][i]) > 0.0) || !isfinite(a[pivot][i]))
            return false;
        exchange_rows(n, a, b, i, pivot);
        for (int k = i + 1; k < n; k++) {
            double factor = a[k][i] / a[i][i];
            for (int c = i; c < n; c++)
                a[k][c] -= factor * a[i][c];
            b[k] -= factor * b[i];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int c = i + 1; c < n; c++)
            b[i] -= a[i][c] * b[c];
        b[i] /= a[i][i];
    }
    return true;
}

/* a becomes a a. Returns its largest element. */
static double square(int n, double a[MATRIX_MAX][MATRIX_MAX])
{
    double b[MATRIX_MAX][MATRIX_MAX] = {{0.0}}, most = 0.0;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) {
            for (int c = 0; c < n; c++)
                b[i][k] += a[i][c] * a[c][k];
            most = fmax(most, fabs(b[i][k]));
        }
    memcpy(a, b, sizeof b);
    return most;
}

bool matrix_contracts(int n, double a[MATRIX_MAX][MATRIX_MAX])
{
    for (int i = 0; i < SQUARINGS; i++) {
        double most = square(n, a);
        if (most < vanished)
            return true;
        if (!(most < grown))
            return false;
    }
    return false;
}

/* Turns columns i and k of m rows until they are at right angles. Returns the cosine that was between them.
 */
static double rotate(int m, int n, double *a, double v[MATRIX_MAX][MATRIX_MAX], int i, int k)
{
    double ii = 0.0, kk = 0.0, ik = 0.0;
    for (int r = 0; r < m; r++) {
        ii += a[r * n + i] * a[r * n + i];
        kk += a[r * n + k] * a[r * n + k];
        ik += a[r * n + i] * a[r * n + k];
    }
    if (!(ii > 0.0) || !(kk > 0.0) || !(fabs(ik) > 0.0))
        return 0.0;
    double zeta = (kk - ii) / (2.0 * ik);
    double tangent = (zeta < 0.0 ? -1.0 : 1.0) / (fabs(zeta) + sqrt(1.0 + zeta * zeta));
    double cosine = 1.0 / sqrt(1.0 + tangent * tangent), sine = cosine * tangent;
    for (int r = 0; r < m + n; r++) {
        double *x = r < m ? &a[r * n + i] : &v[r - m][i], *y = r < m ? &a[r * n + k] : &v[r - m][k];
        double was = *x;
        *x = cosine * was - sine * *y;
        *y = sine * was + cosine * *y;
    }
    return fabs(ik) / sqrt(ii * kk);
}

/* The largest singular values first. */
static void sort(int m, int n, double *a, double s[MATRIX_MAX], double v[MATRIX_MAX][MATRIX_MAX])
{
    for (int i = 0; i < n; i++)
        for (int k = i + 1; k < n; k++) {
            if (s[k] <= s[i])
                continue;
            swap(&s[i], &s[k]);
            for (int r = 0; r < m; r++)
                swap(&a[r * n + i], &a[r * n + k]);
            for (int r = 0; r < n; r++)
                swap(&v[r][i], &v[r][k]);
        }
}

void matrix_singular(int m, int n, double *a, double s[MATRIX_MAX], double v[MATRIX_MAX][MATRIX_MAX])
{
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            v[i][k] = i == k;
    for (int round = 0; round < JACOBI_ROUNDS; round++) {
        double most = 0.0;
        for (int i = 0; i < n; i++)
            for (int k = i + 1; k < n; k++)
                most = fmax(most, rotate(m, n, a, v, i, k));
        if (most < 1e-15)
            break;
    }
    for (int k = 0; k < n; k++) {
        double sum = 0.0;
        for (int r = 0; r < m; r++)
            sum += a[r * n + k] * a[r * n + k];
        s[k] = sqrt(sum);
    }
    sort(m, n, a, s, v);
}
