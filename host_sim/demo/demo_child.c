/* demo_child.c - the plant as a child process: the same program, another subcommand. */
#include "host_sim/demo/demo.h"
#include "host_sim/cli/clock.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

static const double patience_s = 5.0; /* from asking the plant to end to killing it */

bool demo_free_ports(int port[2], char *why)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    socklen_t size = sizeof address;
    int fd[2];
    bool good = true;
    for (int i = 0; i < 2; i++) { /* both at once, or they would be one and the same */
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        address.sin_port = 0;
        fd[i] = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        good = good && fd[i] >= 0 && !bind(fd[i], (struct sockaddr *)&address, sizeof address) &&
               !getsockname(fd[i], (struct sockaddr *)&address, &size);
        port[i] = ntohs(address.sin_port);
    }
    if (!good)
        snprintf(why, DEMO_REASON, "no free UDP port on 127.0.0.1: %s", strerror(errno));
    for (int i = 0; i < 2; i++)
        if (fd[i] >= 0)
            close(fd[i]);
    return good;
}

/* In the child: only async-signal-safe calls until execv. */
static void become(char *const *argv, int words)
{
    dup2(words, STDOUT_FILENO);
    dup2(words, STDERR_FILENO);
    execv("/proc/self/exe", argv);
    execv(argv[0], argv);
    _exit(127);
}

bool demo_child_start(struct demo_child *c, char *const *argv, const char *words_path, char *why)
{
    int words = open(words_path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (words < 0) {
        snprintf(why, DEMO_REASON, "cannot write %s: %s", words_path, strerror(errno));
        return false;
    }
    fflush(NULL);
    pid_t pid = fork();
    if (pid == 0)
        become(argv, words);
    if (pid < 0)
        snprintf(why, DEMO_REASON, "cannot start the plant's process: %s", strerror(errno));
    close(words);
    c->pid = pid > 0 ? pid : 0;
    return pid > 0;
}

bool demo_child_runs(struct demo_child *c)
{
    if (c->pid && waitpid(c->pid, &c->status, WNOHANG) == c->pid)
        c->pid = 0;
    return c->pid != 0;
}

/* Waits until it has ended or the time is over. */
static bool wait_for_end(struct demo_child *c, double seconds)
{
    double end = clock_now_s() + seconds;
    while (demo_child_runs(c) && clock_now_s() < end)
        clock_sleep_s(0.01);
    return c->pid == 0;
}

bool demo_child_end(struct demo_child *c, char *why)
{
    if (demo_child_runs(c))
        kill(c->pid, SIGTERM);
    if (!wait_for_end(c, patience_s)) {
        kill(c->pid, SIGKILL);
        wait_for_end(c, patience_s);
        snprintf(why, DEMO_REASON, "the plant did not end within %.0f s of being asked and was killed",
                 patience_s);
        return false;
    }
    if (WIFEXITED(c->status) && WEXITSTATUS(c->status) == 0)
        return true;
    if (WIFEXITED(c->status))
        snprintf(why, DEMO_REASON, "the plant ended with status %d", WEXITSTATUS(c->status));
    else
        snprintf(why, DEMO_REASON, "the plant was ended by signal %d", WTERMSIG(c->status));
    return false;
}
