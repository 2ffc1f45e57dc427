/* test_html.h - the report of a run of tests as a page:
 * verdicts, expectations, and charts around what failed. */
#ifndef HOST_SIM_TEST_HTML_H
#define HOST_SIM_TEST_HTML_H

#include "host_sim/cli/options.h"
#include "host_sim/test/report/report.h"

/* Writes --report, if it was given. Charts come from the
 * recordings of --log. Texts of requirements come from `all`, and `untraced` are those that no case names. 0,
 * or the exit status after a line. */
int test_html(const struct options *o, int argc, char **argv, const struct report_case *r, int n,
              const struct requirements *all, const struct requirements *untraced);

#endif
