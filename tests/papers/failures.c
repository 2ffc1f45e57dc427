/* failures.c - tests/test.h for programs without a test runner: a failed check ends the program. */
#include "tests/test.h"

#include <stdio.h>
#include <stdlib.h>

static void fail(const char *name)
{
    fprintf(stderr, "FAIL  %s\n", name);
    exit(1);
}

void check_true(const char *name, int condition)
{
    if (!condition)
        fail(name);
}

void check_string(const char *name, const char *got, const char *expected)
{
    fprintf(stderr, "%s, expected %s: ", got, expected);
    fail(name);
}
