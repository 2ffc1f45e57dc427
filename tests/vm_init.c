/* uml_init.c - the first process inside user-mode-linux: mounts, modules, the job of tests/can_vm.sh, power off.
 *
 * A program of its own, since a bare Debian has neither insmod nor a halt command that works without an init system.
 * The job's path arrives as CAN_VM_JOB, which the kernel passes on from its command line. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const module[] = {"net/can/can",          "net/can/can-raw",
                                     "net/can/can-bcm",      "drivers/net/can/dev/can-dev",
                                     "drivers/net/can/vcan", "net/sched/sch_plug"};

static void load_modules(void)
{
    struct utsname system;
    char path[256];
    uname(&system);
    for (size_t i = 0; i < sizeof module / sizeof module[0]; i++) {
        snprintf(path, sizeof path, "/usr/lib/uml/modules/%s/kernel/%s.ko", system.release, module[i]);
        int fd = open(path, O_RDONLY | O_CLOEXEC);
        if (fd < 0 || syscall(SYS_finit_module, fd, "", 0) != 0)
            printf("uml_init: %s: %s\n", path, strerror(errno));
        if (fd >= 0)
            close(fd);
    }
}

static void run_job(const char *job)
{
    pid_t pid = fork();
    if (pid == 0) {
        execl("/bin/sh", "sh", job, (char *)NULL);
        _exit(127);
    }
    while (pid > 0 && wait(NULL) != pid) /* orphans of the job are collected on the way */
        ;
}

int main(void)
{
    const char *job = getenv("CAN_VM_JOB");
    mount("proc", "/proc", "proc", 0, NULL);
    mount("sysfs", "/sys", "sysfs", 0, NULL);
    mount("tmpfs", "/run", "tmpfs", 0, NULL);
    setenv("PATH", "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", 1);
    load_modules();
    if (job)
        run_job(job);
    sync();
    reboot(RB_POWER_OFF);
    return 1;
}
