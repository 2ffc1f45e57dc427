/* elementary.c - every function of models/math/elementary.h of
 * any argument, NaN and infinities among them, but turns_of. */
#include "models/math/elementary.h"
#include "tests/eva/eva.h"

static double any(void)
{
    double x;
    eva_any(&x, sizeof x);
    return x;
}

int main(void)
{
    double c, s;
    cos_sin(any(), &c, &s);
    cos_sin_turns(eva_word(), &c, &s);
    (void)turns_to_double(eva_word());
    (void)arc_tangent(any(), any());
    (void)exponential(any());
    (void)logarithm(any());
    (void)cube_root(any());
    return 0;
}
