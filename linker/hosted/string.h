/* string.h - declarations of C99, see math.h beside it. */
#ifndef LINKER_HOSTED_STRING_H
#define LINKER_HOSTED_STRING_H

#include <stddef.h>

void *memcpy(void *to, const void *from, size_t n);
void *memmove(void *to, const void *from, size_t n);
void *memset(void *to, int value, size_t n);
int memcmp(const void *a, const void *b, size_t n);
void *memchr(const void *in, int value, size_t n);
size_t strlen(const char *text);
int strcmp(const char *a, const char *b);
int strncmp(const char *a, const char *b, size_t n);
char *strchr(const char *text, int value);
char *strstr(const char *text, const char *part);
size_t strcspn(const char *text, const char *stops);
char *strpbrk(const char *text, const char *set);

#endif
