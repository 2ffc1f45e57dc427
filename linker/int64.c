/* int64.c - 64-bit integers to double, for Arm processors with double in hardware. They have instructions for
 * 32 bits only. The compiler's own library does the whole conversion in integer code, 70 instructions instead
 * of ten. Rounded once, as there. (Names and calls: Run-time ABI for the Arm Architecture, 4.1.2.) */
#include <stdint.h>

/* The helpers of that ABI pass doubles in integer registers, whatever the rest of the program does. */
#define BASE   __attribute__((pcs("aapcs")))
#define TWO_32 4294967296.0

BASE double __aeabi_l2d(int64_t n);
BASE double __aeabi_ul2d(uint64_t n);

/* Both halves are exact, so only their sum is rounded. */
double __aeabi_l2d(int64_t n)
{
    return (double)(int32_t)(n >> 32) * TWO_32 + (double)(uint32_t)n;
}

double __aeabi_ul2d(uint64_t n)
{
    return (double)(uint32_t)(n >> 32) * TWO_32 + (double)(uint32_t)n;
}
