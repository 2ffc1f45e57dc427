/* child.c - see child.h. */
#include "host_sim/trial/bench/child.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    FILES_MAX = 1024, /* that a child closes */
    SHOWN = 120,
    CHUNK = 4096,
    CHUNKS = 64,      /* pieces of output that one look takes */
    LEFT_ROUNDS = 50, /* waits for processes to end */
    LEFT_WAIT_US = 10000
};

/* ---- output ---- */

static void keep(struct child *c, const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        unsigned char byte = (unsigned char)text[i];
        if (byte == '\n') {
            if (c->n_part)
                memcpy(c->line, c->part, sizeof c->line);
            c->n_part = 0;
        } else if (c->n_part + 1 < sizeof c->part) {
            c->part[c->n_part++] = (char)(byte >= ' ' && byte <= '~' ? byte : '?');
        }
        c->part[c->n_part] = 0;
    }
}

static void drain(struct child *c)
{
    char text[CHUNK];
    for (int i = 0; i < CHUNKS && c->output >= 0; i++) {
        ssize_t n = read(c->output, text, sizeof text);
        if (n <= 0)
            return;
        keep(c, text, (size_t)n);
        if (c->copy)
            (void)fwrite(text, 1, (size_t)n, c->copy);
    }
}

/* ---- a process ---- */

/* In the child. Its parent's death ends it; signals are as a shell gives them; no other file is open. */
static void become(const char *command, const char *folder, int output)
{
    char text[CHUNK];
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    for (int i = 1; i < NSIG; i++)
        signal(i, SIG_DFL);
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, 0), dup2(output, 1), dup2(output, 2);
    for (int i = 3; i < FILES_MAX; i++)
        close(i);
    snprintf(text, sizeof text, "exec %s", command);
    if (chdir(folder) == 0)
        execl("/bin/sh", "sh", "-c", text, (char *)NULL);
    fprintf(stderr, "cannot run in %s: %s\n", folder, strerror(errno));
    _exit(127);
}

bool child_start(struct child *c, const char *command, const char *folder, FILE *copy, char *why)
{
    int output[2];
    memset(c, 0, sizeof *c);
    c->output = -1;
    c->copy = copy;
    prctl(PR_SET_CHILD_SUBREAPER, 1); /* processes that it leaves behind become ours */
    if (pipe2(output, O_CLOEXEC) || fcntl(output[0], F_SETFL, O_NONBLOCK)) {
        snprintf(why, CHILD_REASON, "no pipe for the controller: %s", strerror(errno));
        return false;
    }
    fflush(NULL);
    c->pid = fork();
    if (c->pid == 0)
        become(command, folder, output[1]);
    close(output[1]);
    c->output = output[0];
    if (c->pid > 0) {
        setpgid(c->pid, c->pid);
        return true;
    }
    snprintf(why, CHILD_REASON, "no process for the controller: %s", strerror(errno));
    c->pid = 0;
    return false;
}

bool child_look(struct child *c)
{
    drain(c);
    if (c->pid && !c->ended && waitpid(c->pid, &c->status, WNOHANG) == c->pid) {
        c->ended = true;
        drain(c);
    }
    return c->pid && !c->ended;
}

void child_ask(struct child *c)
{
    if (c->pid)
        kill(-c->pid, SIGTERM);
}

/* ---- what it left behind ---- */

/* A child of this process other than those that have ended; 0: none. */
static pid_t next_left(void)
{
    int pid = 0;
    while (waitpid(-1, NULL, WNOHANG) > 0)
        ;
    FILE *f = fopen("/proc/thread-self/children", "r");
    if (f && fscanf(f, "%d", &pid) != 1)
        pid = 0;
    if (f)
        (void)fclose(f);
    return pid;
}

static void wait_for_left(void)
{
    for (int i = 0; i < LEFT_ROUNDS && next_left(); i++)
        usleep(LEFT_WAIT_US);
}

int child_end(struct child *c)
{
    int left = 0;
    if (!c->pid)
        return 0;
    if (!c->ended) {
        kill(c->pid, SIGKILL);
        (void)waitpid(c->pid, &c->status, 0);
        c->ended = true;
    }
    wait_for_left();
    for (pid_t pid = next_left(); pid && left < FILES_MAX; pid = next_left()) {
        left++;
        kill(pid, SIGKILL);
        (void)waitpid(pid, NULL, 0);
    }
    kill(-c->pid, SIGKILL);
    drain(c);
    close(c->output);
    c->output = -1;
    c->pid = 0;
    return left;
}

void child_describe(const struct child *c, char text[CHILD_REASON])
{
    const char *line = c->n_part ? c->part : c->line;
    int n = WIFSIGNALED(c->status)
                ? snprintf(text, CHILD_REASON, "ended by signal %d", WTERMSIG(c->status))
                : snprintf(text, CHILD_REASON, "ended with status %d", WEXITSTATUS(c->status));
    if (*line)
        snprintf(text + n, (size_t)(CHILD_REASON - n), "; its last line: %.*s", SHOWN, line);
}
