/* failures.c - tests/unit/test.h for programs without a test runner: a failed check ends the program. */
#include "tests/unit/test.h"

#include <stdio.h>
#include <stdlib.h>

static void fail(struct check_place place, const char *name)
{
    fprintf(stderr, "FAIL  %s\n      %s:%d: %s\n", name, place.file, place.line, place.text);
    exit(1);
}

void check_true_at(struct check_place place, const char *name, int condition)
{
    if (!condition)
        fail(place, name);
}

void check_string_at(struct check_place place, const char *name, const char *got, const char *expected)
{
    fprintf(stderr, "%s, expected %s: ", got, expected);
    fail(place, name);
}
