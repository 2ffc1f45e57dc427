/* check_host.c - a failed assertion on a host: prints its place, and ends the program. A program that defines
 * its own check_failed gets that one instead: this file is then not linked from the library. */
#include <stdio.h>
#include <stdlib.h>
#include "models/check.h"

void check_failed(const char *file, int line)
{
    fprintf(stderr, "assertion failed: %s:%d\n", file, line);
    abort();
}
