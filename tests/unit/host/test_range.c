/* test_range.c - the one reader of ranges: NAME=FROM:TO:N and its like. */
#include "host_sim/scene/range.h"
#include "tests/unit/test.h"

#include <stdio.h>

static const struct range_rules plain = {
    .named = true, .unit = "Hz", .bare = true, .min = 0.0, .max = 1e6, .n_min = 2, .n_max = 100};
static const struct range_rules any = {
    .named = true, .unit = "m", .min = -1.0, .max = 1.0, .n_min = 1, .n_max = 9, .order = RANGE_ANY_ORDER};
static const struct range_rules ends = {
    .unit = "", .bare = true, .min = -9.0, .max = 9.0, .order = RANGE_UPWARDS_OR_EQUAL};

/* why NULL: it is read, with these values. */
static const struct row {
    const struct range_rules *rules;
    const char *text, *why;
    double from, to;
    int n;
    bool logarithmic;
} rows[] = {
    {&plain, "f=1:2:3", NULL, 1.0, 2.0, 3, false},
    {&plain, "f=1 kHz:2 kHz:3", NULL, 1000.0, 2000.0, 3, false},
    {&plain, "f = 1Hz : 2 Hz : 3 : log", NULL, 1.0, 2.0, 3, true},
    {&plain, "f=1:2:3:log", NULL, 1.0, 2.0, 3, true},
    {&plain, "1:2:3", .why = "write NAME=FROM:TO:N, or NAME=FROM:TO:N:log"},
    {&plain, "f=1:2", .why = "write NAME=FROM:TO:N, or NAME=FROM:TO:N:log"},
    {&plain, "f=1:2:3:cubic", .why = "write NAME=FROM:TO:N, or NAME=FROM:TO:N:log"},
    {&plain, "f=1:2:3:log:", .why = "write NAME=FROM:TO:N, or NAME=FROM:TO:N:log"},
    {&plain, "f=2:1:3", .why = "give the smaller end first"},
    {&plain, "f=1:1:3", .why = "give the smaller end first"},
    {&plain, "f=0:1:3:log", .why = "a logarithmic range begins above 0"},
    {&plain, "f=1:2:1", .why = "N is a whole number of values, 2 to 100"},
    {&plain, "f=1:2:2.5", .why = "N is a whole number of values, 2 to 100"},
    {&plain, "f=1:2:", .why = "N is a whole number of values, 2 to 100"},
    {&plain, "f=1:2:nan", .why = "N is a whole number of values, 2 to 100"},
    {&plain, "f=-1:2:3", .why = "-1 is out of range; give 0 to 1e+06 Hz"},
    {&any, "x=1 mm:-1 mm:1", NULL, 1e-3, -1e-3, 1, false},
    {&any, "x=1:2:3", .why = "the unit is missing; it is m"},
    {&any, "x=-1 mm:1 mm:3:log", .why = "a logarithmic range begins above 0"},
    {&ends, "-1:1", NULL, -1.0, 1.0, 0, false},
    {&ends, "1:1", NULL, 1.0, 1.0, 0, false},
    {&ends, "2:1", .why = "give the smaller end first"},
    {&ends, "1", .why = "write FROM:TO"},
    {&ends, "1:2:3", .why = "write FROM:TO"},
    {&ends, "-1:10", .why = "10 is out of range; give -9 to 9"},
};

TEST(range_is_read_or_refused_with_a_reason)
{
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const struct row *q = &rows[i];
        struct range r = {.n = -1};
        char why[RANGE_REASON] = "";
        bool good = range_read(q->text, q->rules, &r, why);
        printf("      %s\n", q->text);
        check_int("is read", good, !q->why);
        if (q->why) {
            check_string("reason", why, q->why);
            continue;
        }
        check_near("from", r.from, q->from, 0.0);
        check_near("to", r.to, q->to, 0.0);
        check_int("values", r.n, q->n);
        check_int("by equal ratios", r.logarithmic, q->logarithmic);
    }
}

TEST(range_values)
{
    const struct range even = {0.1, 0.7, 4, false}, ratios = {0.1, 100.0, 4, true},
                       one = {5.0, 7.0, 1, false};
    check_near("first", range_value(&even, 0), 0.1, 0.0);
    check_near("last", range_value(&even, 3), 0.7, 0.0);
    check_near("between", range_value(&even, 1), 0.3, 1e-15);
    check_near("last of ratios", range_value(&ratios, 3), 100.0, 0.0);
    check_near("ten times the first", range_value(&ratios, 1), 1.0, 1e-14);
    check_near("the only one", range_value(&one, 0), 5.0, 0.0);
}
