/* demo_report.h - the demonstration in one paragraph, and as a page. */
#ifndef HOST_SIM_DEMO_REPORT_H
#define HOST_SIM_DEMO_REPORT_H

#include "host_sim/demo/demo_script.h"

void demo_print_summary(const struct demo *d);

/* The page --report. NULL, or what went wrong. */
const char *demo_write_html(const struct demo *d, const char *path, int argc, char **argv);

#endif
