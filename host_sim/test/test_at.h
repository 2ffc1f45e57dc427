/* test_at.h - the `at` lines of a test file: what happens to the plant, in the words of contactplant send.
 */
#ifndef HOST_SIM_TEST_AT_H
#define HOST_SIM_TEST_AT_H

#include "host_sim/test/test_reader.h"

/* `at TIME VERB WORDS`, without the `at`: arm INPUT FIELD=VALUE.., fire INPUT, set NAME=VALUE.., stream INPUT
 * VALUE, faults LIST. */
bool test_read_at(struct test_reader *r, struct word rest);

/* All lines of the case are known: gives each fire what was armed for it. */
bool test_bind_fires(struct test_reader *r, struct test_case *c);

/* The instant of a fire, to a 256th of a tick as FIRE names it. */
struct instant test_instant(const struct test_act *a, double tick_s);

#endif
