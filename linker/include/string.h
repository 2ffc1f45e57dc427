/* string.h - for targets without a C library: what the core uses of it; linker/memory.c has the bodies. */
#ifndef LINKER_STRING_H
#define LINKER_STRING_H

#include <stddef.h>

#define memcpy(to, from, n)  __builtin_memcpy(to, from, n)
#define memmove(to, from, n) __builtin_memmove(to, from, n)
#define memset(to, value, n) __builtin_memset(to, value, n)
#define memcmp(a, b, n)      __builtin_memcmp(a, b, n)

#endif
