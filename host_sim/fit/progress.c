/* progress.c - see progress.h. */
#include "host_sim/fit/progress.h"

#include <unistd.h>
#include "host_sim/cli/clock.h"

enum { LINE = 60 }; /* longer than any */

void progress_tell(struct fit_setup *s, const char *what, int done, int all)
{
    double now = clock_now_s();
    if (!(s->told_s > 0.0))
        s->told_s = now;
    if (now - s->told_s < 1.0 || !isatty(STDERR_FILENO))
        return;
    s->told_s = now;
    s->told = fprintf(stderr, "contactplant fit: %s %d of %d   \r", what, done, all) > 0;
}

void progress_clear(struct fit_setup *s)
{
    if (s->told)
        fprintf(stderr, "%*s\r", LINE, "");
    s->told = false;
}
