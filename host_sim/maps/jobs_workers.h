/* jobs_workers.h - processes that compute jobs side by side. */
#ifndef HOST_SIM_JOBS_WORKERS_H
#define HOST_SIM_JOBS_WORKERS_H

#include <stdbool.h>
#include <stdio.h>

enum { JOBS_REASON = 512 };

struct workers {
    bool (*compute)(void *context, int i, FILE *rows); /* see jobs.h; in a process of its own */
    void *context;
    /* Here, as pieces and jobs end; text is the taker's to free. */
    bool (*take)(void *taker, int job, char *text, bool last);
    void *taker;
    int next, end; /* jobs */
    int n;         /* processes */
};

/* Cores that this process may use. */
int workers_cores(void);

/* All jobs. False: why[JOBS_REASON] says what happened, a signal to stop included; every process has ended. */
bool workers_run(const struct workers *w, char *why);

#endif
