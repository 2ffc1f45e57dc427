/* progress.c - see progress.h. */
#include "host_sim/fit/progress.h"

#include <unistd.h>
#include "host_sim/cli/clock.h"

void progress_tell(struct fit_setup *s, const char *what, int done, int all)
{
    bool terminal = isatty(STDERR_FILENO);
    double now = clock_now_s();
    if (!(s->told_s > 0.0))
        s->told_s = now;
    if (now - s->told_s < (terminal ? 1.0 : 10.0))
        return;
    fprintf(stderr, "contactplant fit: %s %d of %d%s", what, done, all, terminal ? "   \r" : "\n");
    s->told_s = now;
}
