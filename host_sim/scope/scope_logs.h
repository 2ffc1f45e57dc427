/* scope_logs.h - contactplant scope --open: recorded logs in a browser. */
#ifndef HOST_SIM_SCOPE_LOGS_H
#define HOST_SIM_SCOPE_LOGS_H

#include "host_sim/cli/options.h"

/* Opens the logs and serves their page until Ctrl-C; the exit status. */
int scope_logs(const struct options *o);

#endif
