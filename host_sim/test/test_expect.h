/* test_expect.h - the `expect` lines of a test file: metric, operator, value and window. */
#ifndef HOST_SIM_TEST_EXPECT_H
#define HOST_SIM_TEST_EXPECT_H

#include "host_sim/test/test_reader.h"

/* `expect METRIC OP VALUE [from TIME] [to TIME]`, without the `expect`. */
bool test_read_expect(struct test_reader *r, struct word rest);

#endif
