/* jobs_workers.h - processes that compute jobs side by side. */
#ifndef HOST_SIM_JOBS_WORKERS_H
#define HOST_SIM_JOBS_WORKERS_H

#include <stdbool.h>
#include <stdio.h>

enum { JOBS_REASON = 512 };

struct workers {
    bool (*compute)(void *context, int i, FILE *rows); /* see jobs.h; runs in a process of its own */
    void *context;
    /* Called in this process for each piece and job that ends; frees text. */
    bool (*take)(void *taker, int job, char *text, bool last);
    /* Called for a job whose process ended without an answer, with its status as of waitpid. The other jobs
     * go on, and a process that was stopped is woken. NULL: the end of such a process ends all. */
    bool (*lose)(void *taker, int job, int status);
    void *taker;   /* the first argument of both */
    int next, end; /* jobs */
    int n;         /* processes */
};

/* How many cores this process may use. */
int workers_cores(void);

/* Runs all jobs. False: why[JOBS_REASON] says what went wrong, or that a signal came. Every process has
 * ended then. */
bool workers_run(const struct workers *w, char *why);

#endif
