/* test_equation.c - the cosine that the benchmark's peers are given, against long double libm. */
#include "tests/unit/test.h"

#include "tests/bench/equation.h"

/* The largest error over n + 1 arguments from a to b. */
static double worst_error(double a, double b, int n)
{
    double worst = 0.0;
    for (int i = 0; i <= n; i++) {
        double x = a + (b - a) * ((double)i / n);
        double error = (double)fabsl((long double)equation_cosine(x) - cosl((long double)x));
        worst = error <= worst ? worst : error;
    }
    return worst;
}

TEST(equation_cosine_is_one)
{
    check_near("cos 0", equation_cosine(0.0), 1.0, 0.0);
    check_below("error within a turn", worst_error(-6.3, 6.3, 200000), 4e-16);
    check_below("error up to 1000 rad", worst_error(-1e3, 1e3, 200001), 4e-16);
    check_below("error up to 1e5 rad", worst_error(9.9e4, 1e5, 200001), 4e-16);
}
