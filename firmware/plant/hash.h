/* hash.h - FNV-1a over words of state, in an order that the caller fixes. */
#ifndef FIRMWARE_HASH_H
#define FIRMWARE_HASH_H

#include <stdint.h>
#include <string.h>

#define HASH_BEGIN 0xCBF29CE484222325u

static inline uint64_t hash_word(uint64_t hash, uint64_t word)
{
    for (int i = 0; i < 8; i++) {
        hash ^= (word >> (8 * i)) & 0xFFu;
        hash *= 0x100000001B3u;
    }
    return hash;
}

static inline uint64_t hash_double(uint64_t hash, double x)
{
    uint64_t word;
    memcpy(&word, &x, sizeof word);
    return hash_word(hash, word);
}

#endif
