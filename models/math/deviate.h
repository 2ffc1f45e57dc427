/* deviate.h - standard normal deviates of numbered words: a function of sequence and number alone.
 *
 * SplitMix64 (Steele, Lea & Flood 2014) and AS 241 (Wichura, Appl. Statist. 37, 1988). */
#ifndef MODELS_DEVIATE_H
#define MODELS_DEVIATE_H

#include <stdint.h>

/* The largest value of noise of standard deviation 1. */
#define NOISE_PEAK 6.66

/* Word k of SplitMix64 started at `sequence`. */
static inline uint64_t noise_word(uint64_t sequence, uint64_t k)
{
    uint64_t z = sequence + (k + 1) * 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

/* Standard normal deviate of the upper 35 bits of a word, at the middle of its interval: relative error of
 * the inverse 1e-15, |value| <= NOISE_PEAK. The distribution function is that of a normal variable
 * to 1.5e-11. 85 % of all words take 17 multiplications and a division, the others also a logarithm and a
 * square root. */
double noise_deviate(uint64_t word);

#endif
