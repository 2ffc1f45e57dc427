/* trial_expect.h - the `expect` lines of a test file: metric, operator, value and window. */
#ifndef HOST_SIM_TRIAL_EXPECT_H
#define HOST_SIM_TRIAL_EXPECT_H

#include "host_sim/trial/trial_reader.h"

/* `expect METRIC OP VALUE [from TIME] [to TIME]`, without the `expect`. */
bool trial_read_expect(struct trial_reader *r, struct word rest);

#endif
