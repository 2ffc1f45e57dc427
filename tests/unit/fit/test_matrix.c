/* test_matrix.c - linear algebra of fits against hand-made numbers and identities. */
#include "host_sim/fit/solve/matrix.h"
#include "tests/unit/test.h"

#include <math.h>

TEST(matrix_solve)
{
    double a[MATRIX_MAX][MATRIX_MAX] = {{0.0, 2.0, 1.0}, {1.0, -1.0, 0.0}, {3.0, 0.0, -2.0}};
    double b[MATRIX_MAX] = {7.0, -1.0, -3.0}; /* for x = 1, 2, 3 */
    double singular[MATRIX_MAX][MATRIX_MAX] = {{1.0, 2.0}, {2.0, 4.0}}, c[MATRIX_MAX] = {1.0, 1.0};
    check_true("a matrix with a zero at its first pivot", matrix_solve(3, a, b));
    for (int i = 0; i < 3; i++)
        check_near("solution", b[i], i + 1.0, 1e-14);
    check_true("a singular matrix is refused", !matrix_solve(2, singular, c));
}

/* A turn by any angle with this factor: its multipliers have that modulus. */
static bool turn_contracts(double factor)
{
    double a[MATRIX_MAX][MATRIX_MAX] = {{0.8 * factor, 0.6 * factor}, {-0.6 * factor, 0.8 * factor}};
    return matrix_contracts(2, a);
}

TEST(matrix_contracts)
{
    double shear[MATRIX_MAX][MATRIX_MAX] = {{0.9, 1e3}, {0.0, 0.9}};
    check_true("multipliers of modulus 0.99 contract", turn_contracts(0.99));
    check_true("of 1.01 do not", !turn_contracts(1.01));
    check_true("a shear contracts, though it grows at first", matrix_contracts(2, shear));
}

/* a = U S V^T with known factors: columns (3, 0, 4)/5 and (0, 1, 0), values 10 and 2, V a turn. */
TEST(matrix_singular)
{
    const double u[3][2] = {{0.6, 0.0}, {0.0, 1.0}, {0.8, 0.0}}, s[2] = {10.0, 2.0}, cosine = 0.28,
                 sine = 0.96;
    const double v[2][2] = {{cosine, -sine}, {sine, cosine}};
    double a[6], got[MATRIX_MAX], w[MATRIX_MAX][MATRIX_MAX];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            a[2 * i + k] = u[i][0] * s[0] * v[k][0] + u[i][1] * s[1] * v[k][1];
    matrix_singular(3, 2, a, got, w);
    check_near("the larger singular value", got[0], 10.0, 1e-13);
    check_near("the smaller one", got[1], 2.0, 1e-13);
    check_near("its direction, first", fabs(w[0][1]), sine, 1e-13);
    check_near("its direction, second", fabs(w[1][1]), cosine, 1e-13);
    check_near("the columns are at right angles", a[0] * a[1] + a[2] * a[3] + a[4] * a[5], 0.0, 1e-12);
}
