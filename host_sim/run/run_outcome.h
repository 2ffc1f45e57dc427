/* run_outcome.h - the outcome of contactplant run: a JSON file and an exit status for programs, and a page.
 */
#ifndef HOST_SIM_RUN_OUTCOME_H
#define HOST_SIM_RUN_OUTCOME_H

#include "firmware/app/app.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene_app.h"

/* --json and --fail-on. */
extern const struct option run_outcome_options[];

struct run_outcome {
    const struct app *app;
    uint64_t frames, missed; /* bus frames; frames that never began on time */
    unsigned faults;         /* ever latched */
};

/* 0, or the exit status after a line on stderr: --fail-on names something else. */
int run_outcome_check(const struct options *o);

/* Writes the file. 0, or the exit status after lines on stderr:
 * what --fail-on names came about, or there is no file. */
int run_outcome_tell(const struct run_outcome *r, const struct options *o);

/* Whether --report can be, before the run. 0, or the exit status after a line. */
int run_report_check(const struct options *o);

/* Writes --report from the recording, if it was given, once --log is complete: nothing is done for it while
 * the plant runs. 0, or the exit status after a line. */
int run_report(const struct options *o, const struct scene_app *s, int argc, char **argv);

#endif
