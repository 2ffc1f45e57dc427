/* run_report.h - the report of a run, from its own recording: nothing is done for it while the plant runs. */
#ifndef HOST_SIM_RUN_REPORT_H
#define HOST_SIM_RUN_REPORT_H

#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_app.h"

/* Whether --report can be, before the run. 0, or the exit status after a line. */
int run_report_check(const struct options *o);

/* Writes --report, if it was given, once --log is complete. 0, or the exit status after a line. */
int run_report(const struct options *o, const struct scene_app *s, int argc, char **argv);

#endif
