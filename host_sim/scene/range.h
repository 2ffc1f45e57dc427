/* range.h - a range of numbers as text: NAME=FROM:TO:N for N values, with :log behind it for equal ratios, or
 * NAME=FROM:TO; likewise without NAME=. All ranges of command lines and test files are read here. */
#ifndef HOST_SIM_RANGE_H
#define HOST_SIM_RANGE_H

#include <stdbool.h>
#include <stddef.h>

struct range {
    double from, to;
    int n; /* values; 0: a range without a count, or none */
    bool logarithmic;
};

enum range_order { RANGE_UPWARDS, RANGE_UPWARDS_OR_EQUAL, RANGE_ANY_ORDER };

/* A range keeps to these. */
struct range_rules {
    bool named;       /* NAME= stands before it */
    const char *unit; /* both ends have it; "" or "1" for none */
    bool bare;        /* a number without a unit is in it, too */
    double min, max;  /* both ends */
    int n_min, n_max; /* bounds of N; n_max 0: there is no N */
    enum range_order order;
};

enum { RANGE_REASON = 512 };

/* The range in this text into *r. False: why[RANGE_REASON] says what to write instead. */
bool range_read(const char *text, const struct range_rules *rules, struct range *r, char *why);

/* One number of a range alone, text[0..n-1]: its unit, and inside [min, max]. */
bool range_read_number(const char *text, size_t n, const struct range_rules *rules, double *value, char *why);

/* Value i of a range; both ends are exact. */
double range_value(const struct range *r, int i);

#endif
