/* check.c - the checks of test.h: each prints its values, counts, and when it fails says where it stands. */
#include "tests/unit/test.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { LONG_TEXT = 1000 }; /* bytes of a string that are printed whole */

static struct check_counts own_counts;
struct check_counts *check_counts = &own_counts;

static const char *word(bool ok)
{
    return ok ? "ok  " : "FAIL";
}

static void count(struct check_place place, bool ok)
{
    check_counts->passed += ok;
    check_counts->failed += !ok;
    if (!ok)
        printf("      %s:%d: %s\n", place.file, place.line, place.text);
    fflush(stdout);
}

void check_true_at(struct check_place place, const char *name, int condition)
{
    printf("%s  %s\n", word(condition), name);
    count(place, condition);
}

void check_near_at(struct check_place place, const char *name, double got, double expected, double tolerance)
{
    bool ok = fabs(got - expected) <= tolerance;
    printf("%s  %s: %.12g, expected %.12g, off by %.2g (allowed %.2g)\n", word(ok), name, got, expected,
           got - expected, tolerance);
    count(place, ok);
}

void check_below_at(struct check_place place, const char *name, double got, double limit)
{
    bool ok = got <= limit;
    printf("%s  %s: %.6g, at most %.6g\n", word(ok), name, got, limit);
    count(place, ok);
}

void check_above_at(struct check_place place, const char *name, double got, double limit)
{
    bool ok = got >= limit;
    printf("%s  %s: %.6g, at least %.6g\n", word(ok), name, got, limit);
    count(place, ok);
}

static bool compare(long double a, const char *relation, long double b)
{
    bool equal = a == b;
    switch (relation[0]) {
    case '<':
        return a < b || (relation[1] && equal);
    case '>':
        return a > b || (relation[1] && equal);
    default:
        return equal == (relation[0] == '=');
    }
}

void check_is_at(struct check_place place, const char *name, long double got, const char *relation,
                 long double limit)
{
    bool ok = compare(got, relation, limit);
    int digits = fabsl(got - limit) <= 1e-9L * fabsl(limit) ? 20 : 12;
    printf("%s  %s: %.*Lg %s%s %.*Lg\n", word(ok), name, digits, got, ok ? "" : "is not ", relation, digits,
           limit);
    count(place, ok);
}

void check_nan_at(struct check_place place, const char *name, double got)
{
    printf("%s  %s: %.12g, expected nan\n", word(isnan(got)), name, got);
    count(place, isnan(got));
}

void check_int_at(struct check_place place, const char *name, int64_t got, int64_t expected)
{
    bool ok = got == expected;
    printf("%s  %s: %lld, expected %lld\n", word(ok), name, (long long)got, (long long)expected);
    count(place, ok);
}

void check_hex_at(struct check_place place, const char *name, uint64_t got, uint64_t expected)
{
    bool ok = got == expected;
    printf("%s  %s: %016llx, expected %016llx\n", word(ok), name, (unsigned long long)got,
           (unsigned long long)expected);
    count(place, ok);
}

void check_bytes_at(struct check_place place, const char *name, const void *got, const void *expected,
                    size_t size)
{
    const unsigned char *a = got, *b = expected;
    size_t i = 0;
    while (i < size && a[i] == b[i])
        i++;
    if (i == size)
        printf("ok    %s: %zu bytes equal\n", name, size);
    else
        printf("FAIL  %s: byte %zu of %zu is 0x%02x, expected 0x%02x\n", name, i, size, a[i], b[i]);
    count(place, i == size);
}

/* The line of a text around the byte at `at`. */
static void print_line(const char *what, const char *text, size_t at)
{
    const char *begin = text + at;
    while (begin > text && begin[-1] != '\n')
        begin--;
    printf("      %s: \"%.*s\"\n", what, (int)strcspn(begin, "\n"), begin);
}

static void print_difference(const char *got, const char *expected)
{
    size_t i = 0;
    while (got[i] && got[i] == expected[i])
        i++;
    print_line("the first line that differs", got, i);
    print_line("                   expected", expected, i);
}

static void print_strings(bool ok, const char *name, const char *got, const char *expected)
{
    bool is_long = got && expected && (strlen(got) > LONG_TEXT || strlen(expected) > LONG_TEXT);
    if (!is_long) {
        printf("%s  %s: \"%s\", expected \"%s\"\n", word(ok), name, got ? got : "(null)",
               expected ? expected : "(null)");
        return;
    }
    printf("%s  %s: %zu bytes of text, expected %zu\n", word(ok), name, strlen(got), strlen(expected));
    if (!ok)
        print_difference(got, expected);
}

void check_string_at(struct check_place place, const char *name, const char *got, const char *expected)
{
    bool ok = got && expected && strcmp(got, expected) == 0;
    print_strings(ok, name, got, expected);
    count(place, ok);
}

void check_contains_at(struct check_place place, const char *name, const char *text, const char *part)
{
    bool ok = text && strstr(text, part);
    printf("%s  %s: \"%s\", expected to contain \"%s\"\n", word(ok), name, text ? text : "(null)", part);
    count(place, ok);
}

void check_no_error_at(struct check_place place, const char *name, const char *error)
{
    if (error)
        printf("FAIL  %s: \"%s\", expected no error\n", name, error);
    else
        printf("ok    %s\n", name);
    count(place, !error);
}

void check_error_at(struct check_place place, const char *name, const char *error)
{
    if (error)
        printf("ok    %s: \"%s\"\n", name, error);
    else
        printf("FAIL  %s: no error, expected one\n", name);
    count(place, error != NULL);
}

const char *check_name(const char *format, ...)
{
    static char name[4][200];
    static unsigned n;
    char *text = name[n++ % 4];
    va_list values;
    va_start(values, format);
    (void)vsnprintf(text, sizeof name[0], format, values);
    va_end(values);
    return text;
}
