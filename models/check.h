/* check.h - compile-time assumptions, assertions and compiler attributes used in the core. */
#ifndef MODELS_CHECK_H
#define MODELS_CHECK_H

#include <float.h>
#include <limits.h>

/* A false condition is a negative array size: C99 has no _Static_assert. */
#define STATIC_ASSERT(condition, name) typedef char static_assert_##name[(condition) ? 1 : -1]

/* Bits are equal everywhere where each operation is rounded to its own type, in the order of the source. */
#if FLT_EVAL_METHOD != 0 && (defined(__i386__) || defined(__x86_64__))
#error "x87 keeps more digits than a double has: compile with -msse2 -mfpmath=sse (make does so by itself)"
#elif FLT_EVAL_METHOD != 0
#error "a float is not rounded to float here: compile with -fexcess-precision=fast or -std=gnu99 (s390x)"
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) ||                     \
    defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || defined(__NO_SIGNED_ZEROS__)
#error                                                                                                       \
    "-ffast-math and its parts change the bits of a plant: compile without -ffast-math, -Ofast and the like"
#endif
STATIC_ASSERT(CHAR_BIT == 8, bytes_have_eight_bits);
STATIC_ASSERT(sizeof(double) == 8 && DBL_MANT_DIG == 53, double_is_binary64);
STATIC_ASSERT(sizeof 1.0 == sizeof(double), constants_are_doubles); /* no -fsingle-precision-constant */

/* Reports an error of the programmer. The platform provides it: it latches the fault, turns the drives off
 * and does not return. */
void check_failed(const char *file, int line);
#define ASSERT(condition) ((condition) ? (void)0 : check_failed(__FILE__, __LINE__))

/* For kernels: each pair of model and method has its own copy at every level of optimisation. */
#define ALWAYS_INLINE static inline __attribute__((always_inline))
/* For rare cases: inlined into a kernel they would take registers from every step. */
#define NEVER_INLINE static __attribute__((noinline))
/* Keeps the calling convention. Where gcc sees all callers it moves arguments, which costs every step. */
#define CALLED_FROM_ANYWHERE static __attribute__((noinline, used))
/* Stands before a short loop in every step, most often of known length: gcc's -O2 alone does not unroll
 * it. */
#if defined(__clang__)
#define UNROLL
#define UNROLL_TWO
#else
#define UNROLL     _Pragma("GCC unroll 8")
#define UNROLL_TWO _Pragma("GCC unroll 2") /* a loop of two turns, or of a number that is not known */
#endif
/* A product that goes into a sum, for kernels. On a Cortex-M7 gcc makes one instruction of both, which takes
 * 9 cycles where the two take 5 (by LLVM's model of the part). The bits are the same. */
#if defined(__ARM_ARCH_7EM__) && defined(__ARM_FP) && (__ARM_FP & 8) && !defined(__FRAMAC__)
ALWAYS_INLINE double unfused(double product)
{
    __asm__("" : "+w"(product));
    return product;
}
#else
#define unfused(product) (product)
#endif
#define MUST_CHECK __attribute__((warn_unused_result))

#endif
