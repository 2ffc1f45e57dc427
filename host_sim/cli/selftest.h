/* selftest.h - the self-test with everything that is in this program. */
#ifndef HOST_SIM_SELFTEST_H
#define HOST_SIM_SELFTEST_H

#include <stdbool.h>
#include "firmware/app/selftest.h"

/* False: no memory. */
bool selftest_of_host(struct selftest_result *r);

#endif
