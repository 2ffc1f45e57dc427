/* sweep_report.h - the findings of a sweep: jumps, the largest amplitude, what did not settle; and as a
 * picture and a page amplitudes, phase, time out of contact and peak force. */
#ifndef HOST_SIM_SWEEP_REPORT_H
#define HOST_SIM_SWEEP_REPORT_H

#include "host_sim/maps/sweep/sweep.h"

extern const struct maps_finding sweep_finding; /* its context is a struct sweep */

#endif
