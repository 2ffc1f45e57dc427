/* client_host.c - see client_host.h. */
#include "host_sim/live/client_host.h"
#include "host_sim/cli/clock.h"

static const double poll_pause_s = 50e-6;

static double host_now_s(void *context)
{
    (void)context;
    return clock_now_s();
}

static bool host_is_interrupted(void *context)
{
    (void)context;
    return clock_interrupted();
}

static void rest(void *context, double seconds)
{
    (void)context;
    clock_sleep_s(seconds < poll_pause_s ? seconds : poll_pause_s);
}

void client_init(struct client *c, const struct hal *hal, const struct wire_scene *scene)
{
    static const struct client_waiter waiter = {NULL, host_now_s, host_is_interrupted, rest};
    client_begin(c, hal, scene, &waiter);
}
