/* stdlib.h - declarations of C99, see math.h beside it. */
#ifndef LINKER_HOSTED_STDLIB_H
#define LINKER_HOSTED_STDLIB_H

double strtod(const char *text, char **end);
int atoi(const char *text);

#endif
