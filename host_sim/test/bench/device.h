/* device.h - one run of a case in real time: a plant that runs elsewhere, heard and told by its bus alone.
 *
 * The plant is brought to rest with the case's values in a session of the bench's own. Then the controller
 * has its session, in which the bench only gives the drives and sets of the `at` lines. Nothing is measured
 * but what the bus tells. */
#ifndef HOST_SIM_DEVICE_H
#define HOST_SIM_DEVICE_H

#include "host_sim/test/bench/bench.h"

/* As bench_run. */
void device_run(const struct bench_setting *s, struct bench_result *r);

#endif
