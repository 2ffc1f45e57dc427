/* remote.c - see remote.h. */
#include "host_sim/live/remote.h"
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/live/client_host.h"

int remote_open(struct remote *t, const struct options *o, enum bus_role role, int i_word)
{
    int status = scene_open(&t->scene, o, i_word, NULL);
    if (status)
        return status;
    status = bus_open_options(&t->bus, o, role, &t->scene.app.scene);
    client_init(&t->client, &t->bus.hal, &t->scene.app.scene);
    t->link = (struct client_link){.context = &t->bus, .wait = bus_wait};
    t->client.link = &t->link;
    clock_catch_signals();
    return status;
}

void remote_close(struct remote *t)
{
    bus_close(&t->bus);
    scene_free(&t->scene);
}
