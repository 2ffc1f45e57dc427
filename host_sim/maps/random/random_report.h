/* random_report.h - statistics over all realisations beside the closed form: a CSV, a summary, a figure. */
#ifndef HOST_SIM_RANDOM_REPORT_H
#define HOST_SIM_RANDOM_REPORT_H

#include "host_sim/maps/random/random.h"

/* Statistics of the rows: --statistics, the summary, --svg and --report. 0, or the exit status after a
 * line. */
int random_report(const struct random_runs *r);

#endif
