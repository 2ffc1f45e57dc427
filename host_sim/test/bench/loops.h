/* loops.h - one run of a case on a microscope with its own loops: a sample at a time, without a bus.
 *
 * A measurement sees every sample. The contact is open while no force has touched the tip for two periods of
 * the lever. */
#ifndef HOST_SIM_LOOPS_H
#define HOST_SIM_LOOPS_H

#include "host_sim/test/bench/bench.h"

/* As bench_approve. */
bool loops_approve(const struct test_file *t, const struct test_case *c, char *why);

/* As bench_run. */
void loops_run(const struct bench_setting *s, struct bench_result *r);

#endif
