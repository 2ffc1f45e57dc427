/* clock_shim.c - preload library that lets a program believe that its machine has slept.
 *
 * CLOCK_BOOTTIME is ahead by the seconds that the file CLOCK_SHIM holds, read anew at each call.
 * CLOCK_MONOTONIC is the system's. With CLOCK_SHIM_OLD set the kernel has no CLOCK_BOOTTIME. Built and
 * preloaded by tests/cli/test_cli.sh; not part of the product. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static long asleep_s(void)
{
    const char *path = getenv("CLOCK_SHIM");
    FILE *f = path ? fopen(path, "r") : NULL;
    long s = 0;
    if (f && fscanf(f, "%ld", &s) != 1)
        s = 0;
    if (f)
        fclose(f);
    return s;
}

int clock_gettime(clockid_t id, struct timespec *t)
{
    if (id == CLOCK_BOOTTIME && getenv("CLOCK_SHIM_OLD")) {
        errno = EINVAL;
        return -1;
    }
    long status = syscall(SYS_clock_gettime, id, t);
    if (id == CLOCK_BOOTTIME)
        t->tv_sec += asleep_s();
    return (int)status;
}

int clock_nanosleep(clockid_t id, int flags, const struct timespec *t, struct timespec *left)
{
    struct timespec until = *t;
    if (id == CLOCK_BOOTTIME && getenv("CLOCK_SHIM_OLD"))
        return EINVAL;
    if (id == CLOCK_BOOTTIME && (flags & TIMER_ABSTIME))
        until.tv_sec -= asleep_s();
    return syscall(SYS_clock_nanosleep, id, flags, &until, left) == 0 ? 0 : errno;
}
