/* test.h - checks that print their values and go on after a failure; the runner prints `N passed, N failed`.
 *
 * A test file defines `void test_NAME(void)` functions and lists them in tests/main.c. Each check prints one line:
 * name, measured value, what it is compared with and where that comes from. */
#ifndef TESTS_TEST_H
#define TESTS_TEST_H

#include <stdint.h>

/* The condition holds. */
void check_true(const char *name, int condition);

/* |got - expected| <= tolerance, absolute. A NaN fails. */
void check_near(const char *name, double got, double expected, double tolerance);

/* got <= limit. A NaN fails. */
void check_below(const char *name, double got, double limit);

/* got >= limit. */
void check_above(const char *name, double got, double limit);

/* Equal integers, printed in decimal. */
void check_int(const char *name, int64_t got, int64_t expected);

/* Equal 64-bit words, printed in hexadecimal. */
void check_hex(const char *name, uint64_t got, uint64_t expected);

/* Equal strings. */
void check_string(const char *name, const char *got, const char *expected);

#endif
