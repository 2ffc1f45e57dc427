/* worst_cases.h - motions whose ticks are the hardest: contact just touched, chatter, fast base motion that
 * loses contact more than half of the time. tests/bench/cost/worst.c counts what their worst tick takes on
 * the host, tests/boards/board_cost.c its instructions on a board. */
#ifndef TESTS_WORST_CASES_H
#define TESTS_WORST_CASES_H

#include "tests/bench/rate/rate_cases.h"

enum { WORST_CASES = 9, WORST_PERIODS = 10 };

struct worst_case {
    struct rate_case motion; /* its name says the method, too */
    struct rate_setting setting;
};
extern const struct worst_case worst_case[WORST_CASES];

#endif
