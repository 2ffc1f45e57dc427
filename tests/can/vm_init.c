/* vm_init.c - the first process inside a virtual machine: modules, mounts, the job, power off.
 *
 * A program of its own, since a bare Debian has neither insmod nor a halt command that works without an
 * init system. The kernel passes on these variables from its command line:
 * - CAN_VM_MODULES, a file with a module's path in each line, in the order of loading;
 * - CAN_VM_JOB, the path of the program to run;
 * - CAN_VM_HOST, a directory, when the first root is not yet this machine's (qemu). Its files then come by 9P
 *   under the name `host`. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

static void load_module(const char *path)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0 || syscall(SYS_finit_module, fd, "", 0) != 0)
        printf("vm_init: %s: %s\n", path, strerror(errno));
    if (fd >= 0)
        close(fd);
}

static void load_modules(const char *list)
{
    char path[256];
    FILE *f = fopen(list, "r");
    if (!f)
        printf("vm_init: %s: %s\n", list, strerror(errno));
    while (f && fgets(path, sizeof path, f)) {
        path[strcspn(path, "\n")] = 0;
        load_module(path);
    }
    if (f)
        fclose(f);
}

static void enter_host(const char *directory)
{
    if (mount("host", directory, "9p", 0, "trans=virtio,version=9p2000.L,msize=512000,cache=loose") != 0 ||
        chroot(directory) != 0 || chdir("/") != 0)
        printf("vm_init: this machine's files: %s\n", strerror(errno));
    mount("devtmpfs", "/dev", "devtmpfs", 0, NULL); /* its devices are not ours */
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
    const char *job = getenv("CAN_VM_JOB"), *list = getenv("CAN_VM_MODULES"), *host = getenv("CAN_VM_HOST");
    if (list)
        load_modules(list);
    if (host)
        enter_host(host);
    mount("proc", "/proc", "proc", 0, NULL);
    mount("sysfs", "/sys", "sysfs", 0, NULL);
    mount("tmpfs", "/run", "tmpfs", 0, NULL);
    setenv("PATH", "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", 1);
    if (job)
        run_job(job);
    sync();
    reboot(RB_POWER_OFF);
    return 1;
}
