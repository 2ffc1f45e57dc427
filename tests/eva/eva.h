/* eva.h - arbitrary values for the harnesses. Each harness is a program whose inputs are unknown; Frama-C's
 * Eva follows all of them at once and reports each operation that some input could make undefined. */
#ifndef TESTS_EVA_EVA_H
#define TESTS_EVA_EVA_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include "__fc_builtin.h"

/* One of the calls of check_failed that a proof must exclude: an assertion that fails is an alarm. */
void check_failed(const char *file, int line)
{
    Frama_C_show_each_failed(file, line);
    /*@ assert assertion_holds: \false; */
    while (true)
        ;
}

/* Any bytes. */
static inline void eva_any(void *p, size_t n)
{
    Frama_C_make_unknown((char *)p, n);
}

static inline double eva_between(double min, double max)
{
    return Frama_C_double_interval(min, max);
}

static inline bool eva_bool(void)
{
    return Frama_C_interval(0, 1) != 0;
}

static inline uint32_t eva_uint(uint32_t min, uint32_t max)
{
    return Frama_C_unsigned_int_interval(min, max);
}

static inline uint64_t eva_word(void)
{
    uint64_t x;
    eva_any(&x, sizeof x);
    return x;
}

#endif
