/* demo_report.h - the demonstration in one paragraph. */
#ifndef HOST_SIM_DEMO_REPORT_H
#define HOST_SIM_DEMO_REPORT_H

#include "host_sim/demo/demo_script.h"

void demo_print_summary(const struct demo *d);
/* The summary as text. */
void demo_sum_up(const struct demo *d, char *text, size_t size);

#endif
