/* can_session_print.c - the session of tests/can/can_session.h
 * on this machine over hal/loopback, for tests/boards/boards.sh. */
#include <inttypes.h>
#include <stdio.h>
#include "hal/link/loopback.h"
#include "tests/can/can_session.h"

static void line(const char *what, uint64_t value, int digits)
{
    printf(digits ? "%s %0*" PRIx64 "\n" : "%s %.*" PRIu64 "\n", what, digits ? digits : 1, value);
}

int main(void)
{
    static struct loopback_bus bus;
    static struct can_session session;
    loopback_init(&bus, 2, LOOPBACK_RING);
    const char *why = can_session_run(&session, &bus.port[0].hal, &bus.port[1].hal);
    if (why)
        printf("stopped: %s\n", why);
    can_session_report(&session, line);
    return why != NULL;
}
