/* clock.c - see clock.h. */
#include "host_sim/cli/clock.h"
#include "hal/posix/clock.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#define WAKE_EARLY_NS INT64_C(100000) /* time that a timer and an idle processor may take to come back */

static volatile sig_atomic_t interrupted; /* set by the signal handler only */

int64_t clock_now_ns(void)
{
    return clock_ns();
}

double clock_now_s(void)
{
    return (double)clock_now_ns() * 1e-9;
}

static struct timespec to_timespec(int64_t ns)
{
    return (struct timespec){.tv_sec = (time_t)(ns / 1000000000), .tv_nsec = (long)(ns % 1000000000)};
}

/* A kernel that cannot sleep by that clock sleeps as long by the other one. */
void clock_sleep_until_ns(int64_t ns)
{
    struct timespec t = to_timespec(ns);
    int error = clock_nanosleep(CLOCK_ELAPSED, TIMER_ABSTIME, &t, NULL);
    if (error == 0 || error == EINTR || clock_now_ns() >= ns)
        return;
    t = to_timespec(ns - clock_now_ns());
    clock_nanosleep(CLOCK_MONOTONIC, 0, &t, NULL);
}

void clock_wait_until_ns(int64_t ns)
{
    clock_sleep_until_ns(ns - WAKE_EARLY_NS);
    while (clock_now_ns() < ns && !interrupted)
        continue;
}

void clock_sleep_s(double seconds)
{
    clock_sleep_until_ns(clock_now_ns() + (int64_t)(seconds * 1e9));
}

static void on_signal(int number)
{
    (void)number;
    interrupted = 1;
}

void clock_catch_signals(void)
{
    struct sigaction a, before;
    memset(&a, 0, sizeof a);
    a.sa_handler = on_signal;
    sigaction(SIGINT, &a, NULL);
    sigaction(SIGTERM, &a, NULL);
    if (!sigaction(SIGHUP, NULL, &before) &&
        before.sa_handler != SIG_IGN) /* nohup: goes on without a terminal */
        sigaction(SIGHUP, &a, NULL);
}

bool clock_interrupted(void)
{
    return interrupted != 0;
}
