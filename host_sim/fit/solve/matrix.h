/* matrix.h - the linear algebra of a fit: small dense matrices, no heap. */
#ifndef HOST_SIM_FIT_MATRIX_H
#define HOST_SIM_FIT_MATRIX_H

#include <stdbool.h>

enum { MATRIX_MAX = 16 };

/* b becomes a^-1 b, for n <= MATRIX_MAX, by elimination with pivots; a is used up. False: a is singular. */
bool matrix_solve(int n, double a[MATRIX_MAX][MATRIX_MAX], double *b);

/* Do powers of a fall to 0? Those up to 2^12 are looked at. */
bool matrix_contracts(int n, double a[MATRIX_MAX][MATRIX_MAX]);

/* The singular values s[n], the largest first, of the m rows of n numbers in `a` (row i at a[i * n]), and
 * their directions: column k of v. Column k of `a` becomes s[k] times the left direction. By Jacobi's
 * rotations of pairs of columns (Hestenes 1958). */
void matrix_singular(int m, int n, double *a, double s[MATRIX_MAX], double v[MATRIX_MAX][MATRIX_MAX]);

#endif
