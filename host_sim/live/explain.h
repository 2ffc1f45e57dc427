/* explain.h - why a client and a plant do not come together, and what to do, in one line. */
#ifndef HOST_SIM_EXPLAIN_H
#define HOST_SIM_EXPLAIN_H

#include "host_sim/live/client.h"

enum { EXPLAIN_REASON = 1024 };

/* After client_open failed; into why[EXPLAIN_REASON]. */
void explain_no_session(const struct client *c, char *why);

/* How the plant differs from what this client assumes, part by part; into why[EXPLAIN_REASON]. */
void explain_identity(const struct client *c, char *why);

#endif
