/* bench_afm.h - one run of a case on a microscope: lever and station in this process, a sample at a time,
 * without a bus.
 *
 * A measurement sees every sample. The contact is open while no force has touched the tip for two periods of
 * the lever. */
#ifndef HOST_SIM_AFM_BENCH_AFM_H
#define HOST_SIM_AFM_BENCH_AFM_H

#include "host_sim/trial/bench/bench.h"

/* As bench_approve. */
bool bench_afm_approve(const struct trial *t, const struct trial_case *c, char *why);

/* As bench_run. */
void bench_afm_run(const struct bench_setting *s, struct bench_result *r);

#endif
