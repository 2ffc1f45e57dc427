/* runner_cases.c - tests that fail in every way, for
 * tests/house/test_runner.sh; a program of their own with the runner. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/unit/test.h"

TEST(passing)
{
    check_int("seven", 7, 7);
    check_is("a double", 0.1, <, 0.2);
    fprintf(stderr, "noise on stderr\n");
}

TEST(values)
{
    const struct {
        int pair[2];
    } p = {{1, 2}};
    check_true("a condition", p.pair[0] == p.pair[1]);
    check_near("force, N", 1.5, 1.0, 0.25);
    check_near("not a number", (double)NAN, 1.0, 1.0);
    check_below("at most", 2.0, 1.0);
    check_above("at least", 1.0, 2.0);
    check_is("2^53 and one more", (1ll << 53) + 1, ==, 1ll << 53);
    check_is("equal doubles", 0.1, >, 0.1);
    check_is("a NaN is less than nothing", (double)NAN, <, 1.0);
    check_nan("a number", 3.0);
    check_int("integers", (int[]){1, 2}[1], 3);
    check_hex("words", 255, 254);
    check_bytes("memory", "abc", "abd", 3);
    check_string("strings", "one", "two");
    check_contains("a part", "a long text", "short");
    check_contains("a part of no text", NULL, "short");
    check_no_error("taken", "mass must be positive");
    check_error("refused", NULL);
}

TEST(long_text)
{
    static char a[3000], b[3000];
    memset(a, 'x', sizeof a - 1);
    memcpy(a + 2000, "\nthis line\n", 11);
    memcpy(b, a, sizeof a);
    b[2003] = 'u';
    check_string("a long text", a, b);
}

TEST(crash)
{
    check_int("before it", 1, 1);
    raise(SIGSEGV);
}

TEST(leaves)
{
    exit(0);
}

TEST(leaves_with_status)
{
    exit(3);
}

TEST(after_it)
{
    check_int("goes on", 1, 1);
}
