/* test.h - checks that print their values and go on after a failure; the runner prints `N passed, N failed`.
 *
 * A test is one function in one file, and no list names it:
 *
 *     TEST(lockin_phase)
 *     {
 *         check_near("phase, rad", phase, 0.5, 1e-9);
 *     }
 *
 * Each check prints one line: its name and the values. A failed check prints file, line and its own text,
 * too. The name of values with a unit ends with it: "force, N". check_true is for conditions without values.
 */
#ifndef TESTS_TEST_H
#define TESTS_TEST_H

#include <stddef.h>
#include <stdint.h>

/* The condition holds. check_true(name, condition) */
#define check_true(...) check_true_at(CHECK_PLACE("check_true(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* |got - expected| <= tolerance, absolute. A NaN fails. check_near(name, got, expected, tolerance) */
#define check_near(...) check_near_at(CHECK_PLACE("check_near(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* got <= limit. A NaN fails. check_below(name, got, limit) */
#define check_below(...) check_below_at(CHECK_PLACE("check_below(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* got >= limit. A NaN fails. check_above(name, got, limit) */
#define check_above(...) check_above_at(CHECK_PLACE("check_above(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* Two numbers compare as the operator says: check_is("ramp left, s", left, <, 0.5). Both may be integers or
 * doubles; they are compared without rounding. */
#define check_is(name, got, relation, limit)                                                                 \
    check_is_at(CHECK_PLACE("check_is(" #name ", " #got ", " #relation ", " #limit ")"), name,               \
                (long double)(got), #relation, (long double)(limit))

/* The number is a NaN. check_nan(name, got) */
#define check_nan(...) check_nan_at(CHECK_PLACE("check_nan(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* Equal integers, printed in decimal. check_int(name, got, expected) */
#define check_int(...) check_int_at(CHECK_PLACE("check_int(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* Equal 64-bit words, printed in hexadecimal. check_hex(name, got, expected) */
#define check_hex(...) check_hex_at(CHECK_PLACE("check_hex(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* Equal memory; the first byte that differs is printed. check_bytes(name, got, expected, size) */
#define check_bytes(...) check_bytes_at(CHECK_PLACE("check_bytes(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* Equal strings. Long ones print their length and the line that differs. check_string(name, got, expected) */
#define check_string(...) check_string_at(CHECK_PLACE("check_string(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* The text contains the part; NULL contains nothing. check_contains(name, text, part) */
#define check_contains(...) check_contains_at(CHECK_PLACE("check_contains(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* A call returned no error text, that is NULL. check_no_error(name, error) */
#define check_no_error(...) check_no_error_at(CHECK_PLACE("check_no_error(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* A call returned an error text. check_error(name, error) */
#define check_error(...) check_error_at(CHECK_PLACE("check_error(" #__VA_ARGS__ ")"), __VA_ARGS__)

/* A name made of values, as printf makes it: check_int(check_name("%s: rows", preset), n, 3). It holds until
 * the fourth one after it. */
__attribute__((format(printf, 1, 2))) const char *check_name(const char *format, ...);

/* Where a check stands, and its text. */
struct check_place {
    const char *file;
    int line;
    const char *text;
};
#define CHECK_PLACE(text) ((struct check_place){__FILE__, __LINE__, text})
void check_true_at(struct check_place place, const char *name, int condition);
void check_near_at(struct check_place place, const char *name, double got, double expected, double tolerance);
void check_below_at(struct check_place place, const char *name, double got, double limit);
void check_above_at(struct check_place place, const char *name, double got, double limit);
void check_is_at(struct check_place place, const char *name, long double got, const char *relation,
                 long double limit);
void check_nan_at(struct check_place place, const char *name, double got);
void check_int_at(struct check_place place, const char *name, int64_t got, int64_t expected);
void check_hex_at(struct check_place place, const char *name, uint64_t got, uint64_t expected);
void check_bytes_at(struct check_place place, const char *name, const void *got, const void *expected,
                    size_t size);
void check_string_at(struct check_place place, const char *name, const char *got, const char *expected);
void check_contains_at(struct check_place place, const char *name, const char *text, const char *part);
void check_no_error_at(struct check_place place, const char *name, const char *error);
void check_error_at(struct check_place place, const char *name, const char *error);

/* Checks so far, counted where the runner wants them: a process that crashes has counted up to there. */
struct check_counts {
    int passed, failed;
};
extern struct check_counts *check_counts;

/* A test registers itself before main runs; the runner sorts by file and line. */
struct test {
    const char *name, *file;
    int line;
    void (*run)(void);
    struct test *next;
};
void test_register(struct test *t);

#define TEST(name_)                                                                                          \
    static void test_##name_(void);                                                                          \
    static __attribute__((constructor)) void register_##name_(void)                                          \
    {                                                                                                        \
        static struct test t = {.name = #name_, .file = __FILE__, .line = __LINE__, .run = test_##name_};    \
        test_register(&t);                                                                                   \
    }                                                                                                        \
    static void test_##name_(void)

#endif
