/* stdio.h - declarations of C99, see math.h beside it. */
#ifndef LINKER_HOSTED_STDIO_H
#define LINKER_HOSTED_STDIO_H

#include <stdarg.h>
#include <stddef.h>

typedef struct hosted_file FILE; /* for headers that name it: no function takes one here */

int snprintf(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));
int vsnprintf(char *text, size_t size, const char *format, va_list list)
    __attribute__((format(printf, 3, 0)));

#endif
