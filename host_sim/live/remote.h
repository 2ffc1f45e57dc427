/* remote.h - a plant elsewhere, as every program on the controller's side has it: its scene, a bus, and a
 * client on it. */
#ifndef HOST_SIM_REMOTE_H
#define HOST_SIM_REMOTE_H

#include "host_sim/live/bus.h"
#include "host_sim/live/client.h"
#include "host_sim/scene/scene.h"

/* It must not be moved: its parts point to each other. All zero before remote_open. */
struct remote {
    struct scene_app scene; /* the plant's identity and scale, from the same options as the plant's */
    struct bus bus;
    struct client_link link;
    struct client client; /* without a session yet; it waits on the bus */
};

/* Opens what the options say; `i_word`: the word that names the model. From here on Ctrl-C is seen by
 * clock_interrupted. 0, or the exit status after a line on stderr; remote_close in any case. */
int remote_open(struct remote *t, const struct options *o, enum bus_role role, int i_word);

void remote_close(struct remote *t);

#endif
