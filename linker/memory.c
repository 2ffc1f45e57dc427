/* memory.c - the four functions that the compiler, the core and the hal take from a C library, for targets
 * that have none. Bytes, but words where both ends allow: a state of a few kilobytes is copied seldom. */
#include <stddef.h>
#include <stdint.h>

void *memcpy(void *restrict to, const void *restrict from, size_t n);
void *memmove(void *to, const void *from, size_t n);
void *memset(void *to, int value, size_t n);
int memcmp(const void *a, const void *b, size_t n);

/* Words of any type at all. */
typedef uint32_t __attribute__((may_alias)) word;
struct __attribute__((may_alias)) block {
    uint32_t word[4];
};

void *memcpy(void *restrict to, const void *restrict from, size_t n)
{
    unsigned char *t = to;
    const unsigned char *f = from;
    if (((uintptr_t)t | (uintptr_t)f) % sizeof(word) == 0) {
        for (; n >= sizeof(struct block); n -= sizeof(struct block)) {
            *(struct block *)(void *)t = *(const struct block *)(const void *)f;
            t += sizeof(struct block);
            f += sizeof(struct block);
        }
        for (; n >= sizeof(word); n -= sizeof(word), t += sizeof(word), f += sizeof(word))
            *(word *)(void *)t = *(const word *)(const void *)f;
    }
    for (size_t i = 0; i < n; i++)
        t[i] = f[i];
    return to;
}

void *memmove(void *to, const void *from, size_t n)
{
    unsigned char *t = to;
    const unsigned char *f = from;
    if (t <= f)
        for (size_t i = 0; i < n; i++)
            t[i] = f[i];
    else
        for (size_t i = n; i > 0; i--)
            t[i - 1] = f[i - 1];
    return to;
}

void *memset(void *to, int value, size_t n)
{
    unsigned char *t = to;
    const word four = 0x01010101u * (unsigned char)value;
    const struct block sixteen = {{four, four, four, four}};
    if ((uintptr_t)t % sizeof(word) == 0) {
        for (; n >= sizeof(struct block); n -= sizeof(struct block), t += sizeof(struct block))
            *(struct block *)(void *)t = sixteen;
        for (; n >= sizeof(word); n -= sizeof(word), t += sizeof(word))
            *(word *)(void *)t = four;
    }
    for (size_t i = 0; i < n; i++)
        t[i] = (unsigned char)value;
    return to;
}

int memcmp(const void *a, const void *b, size_t n)
{
    const unsigned char *x = a, *y = b;
    for (size_t i = 0; i < n; i++)
        if (x[i] != y[i])
            return x[i] < y[i] ? -1 : 1;
    return 0;
}
