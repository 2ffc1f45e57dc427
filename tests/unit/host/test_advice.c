/* test_advice.c - each name that a plant tells of trouble has an advice, once, and no advice is for a name
 * that is not there. */
#include "host_sim/help/advice.h"

#include <stdio.h>
#include <string.h>
#include "tests/unit/test.h"

TEST(advice_for_every_name)
{
    struct named n;
    for (enum advice_list list = 0; list < ADVICE_LISTS; list++)
        for (int i = 0; advice_named(list, i, &n); i++) {
            const char *advice = advice_text(n.name);
            char what[128];
            snprintf(what, sizeof what, "advice for %s (%s)", n.name, advice_list_name[list]);
            check_true(what, advice != NULL);
            check_is("letters of the advice", advice ? strlen(advice) : 0, >=, 20);
        }
}

TEST(advice_lists)
{
    struct named n;
    int count[ADVICE_LISTS] = {0};
    for (enum advice_list list = 0; list < ADVICE_LISTS; list++)
        while (advice_named(list, count[list], &n))
            count[list]++;
    check_int("faults: one for each bit of a byte", count[ADVICE_FAULT], 8);
    check_int("causes, but ok", count[ADVICE_CAUSE], CAUSES - 1);
    check_true("the first fault", advice_named(ADVICE_FAULT, 0, &n));
    check_string("the first fault", n.name, "not_finite");
    check_true("the first cause", advice_named(ADVICE_CAUSE, 0, &n));
    check_string("the first cause", n.name, "range");
}

TEST(advice_for_nothing_else)
{
    struct named n;
    for (int i = 0; advice_name(i); i++) {
        bool found = false;
        for (enum advice_list list = 0; list < ADVICE_LISTS; list++)
            for (int k = 0; advice_named(list, k, &n); k++)
                found = found || !strcmp(n.name, advice_name(i));
        check_true(advice_name(i), found);
        for (int k = 0; k < i; k++)
            check_true("named once", strcmp(advice_name(i), advice_name(k)));
    }
    check_true("no such name", !advice_text("no_such_name"));
}
