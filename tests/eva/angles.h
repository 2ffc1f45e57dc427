/* angles.h - models/math/elementary.c with two functions standing back: turns_of, which resists
 * (docs/why/proofs.md), gives any integer; cos_sin, which `elementary` proves by itself, any point about the
 * unit circle. Instead of that file among the sources. */
#ifndef TESTS_EVA_ANGLES_H
#define TESTS_EVA_ANGLES_H

#define turns_of turns_of_elsewhere
#define cos_sin  cos_sin_elsewhere
#include "models/math/elementary.c"
#undef turns_of
#undef cos_sin
#include "tests/eva/eva.h"

uint64_t turns_of(double turns);
void cos_sin(double radians, double *cosine, double *sine);

uint64_t turns_of(double turns)
{
    (void)turns;
    return eva_word();
}

void cos_sin(double radians, double *cosine, double *sine)
{
    (void)radians;
    *cosine = eva_between(-1.1, 1.1);
    *sine = eva_between(-1.1, 1.1);
}

#endif
