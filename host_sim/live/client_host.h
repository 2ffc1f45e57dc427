/* client_host.h - a client that waits by the host's clock, and ends its wait when the user interrupts. */
#ifndef HOST_SIM_CLIENT_HOST_H
#define HOST_SIM_CLIENT_HOST_H

#include "host_sim/live/client.h"

/* A new client without a session. */
void client_init(struct client *c, const struct hal *hal, const struct wire_scene *scene);

#endif
