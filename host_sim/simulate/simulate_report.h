/* simulate_report.h - the report of contactplant simulate: what ran, and charts of its rows. */
#ifndef HOST_SIM_SIMULATE_REPORT_H
#define HOST_SIM_SIMULATE_REPORT_H

#include "host_sim/simulate/simulate.h"

/* The report --report: opened before the run; a row with its columns, states and then the observable; an
 * event; written at the end. Without --report nothing is done. 0, or the exit status after a line. */
int simulate_report_begin(struct simulation *r, int argc, char **argv);
void simulate_report_row(struct simulation *r, double t, const double *value);
void simulate_report_event(struct simulation *r, double t, const struct event *e);
int simulate_report_end(struct simulation *r, int status);

#endif
