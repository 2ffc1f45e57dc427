/* child.c - see child.h. */
#include "host_sim/test/bench/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include "host_sim/cli/shell.h"

enum {
    FILES_MAX = 1024, /* that a child closes */
    CHILDREN = 1024,  /* that a process has */
    SHOWN = 120,
    CHUNK = 4096,
    CHUNKS = 64,         /* pieces of output that one look takes */
    PIPE = 1 << 20,      /* bytes of output that wait for a look */
    COPY_MAX = 64 << 20, /* bytes of output that are kept */
    MANY = 1000000,      /* bytes of output that are worth telling */
    PAUSE_MS = 1,
    PAUSES = 20,
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
        if (c->copy && c->n_output < COPY_MAX)
            (void)fwrite(text, 1, (size_t)n, c->copy);
        if (c->copy && c->n_output < COPY_MAX && c->n_output + (size_t)n >= COPY_MAX)
            fprintf(c->copy, "\n[contactplant: what it printed beyond %d MB is left out]\n", COPY_MAX >> 20);
        c->n_output += (size_t)n;
    }
}

/* ---- a process ---- */

/* Children that this process had before any controller: a shell gives them to what it becomes by exec. */
static struct {
    bool begun;
    int n_before;
    pid_t before[CHILDREN];
} adopted;

static int list_children(pid_t child[CHILDREN])
{
    int n = 0, pid = 0;
    FILE *f = fopen("/proc/thread-self/children", "r");
    while (f && n < CHILDREN && fscanf(f, "%d", &pid) == 1)
        child[n++] = pid;
    if (f)
        (void)fclose(f);
    return n;
}

static bool was_before(pid_t pid)
{
    bool was = false;
    for (int i = 0; i < adopted.n_before; i++)
        was = was || adopted.before[i] == pid;
    return was;
}

/* In the child. Its parent's death ends it; signals are as a shell gives them; no other file is open. A
 * program takes the place of the shell, so that how it ended is known. */
static void become(const struct child *c, const char *command, const char *folder, int output)
{
    char *line = NULL;
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
    if (chdir(folder) == 0 && asprintf(&line, "%s%s", c->is_program ? "exec " : "", command) > 0)
        execl("/bin/sh", "sh", "-c", line, (char *)NULL);
    fprintf(stderr, "cannot run in %s: %s\n", folder, strerror(errno));
    _exit(127);
}

void child_adopt(void)
{
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    if (!adopted.begun)
        adopted.n_before = list_children(adopted.before);
    adopted.begun = true;
}

bool child_start(struct child *c, const char *command, const char *folder, FILE *copy, char *why)
{
    int output[2];
    memset(c, 0, sizeof *c);
    c->output = -1;
    c->copy = copy;
    c->is_program = shell_is_program(command);
    child_adopt();
    if (pipe2(output, O_CLOEXEC) || fcntl(output[0], F_SETFL, O_NONBLOCK)) {
        snprintf(why, CHILD_REASON, "no pipe for the controller: %s", strerror(errno));
        return false;
    }
    (void)fcntl(output[0], F_SETPIPE_SZ, PIPE); /* or what the system allows */
    fflush(NULL);
    c->pid = fork();
    if (c->pid == 0)
        become(c, command, folder, output[1]);
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

bool child_group_runs(struct child *c)
{
    if (child_look(c))
        return true;
    while (c->pid && waitpid(-c->pid, NULL, WNOHANG) > 0)
        ;
    return c->pid && kill(-c->pid, 0) == 0;
}

void child_listen(struct child *c)
{
    struct pollfd output = {c->output, POLLIN, 0};
    for (int i = 0; i < PAUSES && c->output >= 0 && poll(&output, 1, PAUSE_MS) > 0 && output.revents & POLLIN;
         i++)
        drain(c);
}

void child_ask(struct child *c)
{
    if (c->pid)
        kill(-c->pid, SIGTERM);
}

/* ---- what it left behind ---- */

/* A running child of this process that is a controller, or what one left. 0: none. */
static pid_t next_left(bool has_workers)
{
    pid_t child[CHILDREN], found = 0;
    int n = list_children(child);
    for (int i = 0; i < n && !found; i++) {
        bool spared = was_before(child[i]) || (has_workers && getpgid(child[i]) == getpgrp());
        found = !spared && waitpid(child[i], NULL, WNOHANG) == 0 ? child[i] : 0;
    }
    return found;
}

static void wait_for_left(void)
{
    for (int i = 0; i < LEFT_ROUNDS && next_left(false); i++)
        usleep(LEFT_WAIT_US);
}

int child_end_left(bool has_workers)
{
    int left = 0;
    for (pid_t pid = next_left(has_workers); pid && left < CHILDREN; pid = next_left(has_workers)) {
        left++;
        kill(pid, SIGKILL);
        (void)waitpid(pid, NULL, 0);
    }
    return left;
}

int child_end(struct child *c)
{
    if (!c->pid)
        return 0;
    if (!c->is_program)
        kill(-c->pid, SIGKILL); /* all of the line is the controller */
    if (!c->ended) {
        kill(c->pid, SIGKILL);
        (void)waitpid(c->pid, &c->status, 0);
        c->ended = true;
    }
    wait_for_left();
    int left = child_end_left(false);
    kill(-c->pid, SIGKILL);
    drain(c);
    close(c->output);
    c->output = -1;
    c->pid = 0;
    return left;
}

void child_describe_output(const struct child *c, char text[CHILD_REASON])
{
    const char *line = c->n_part ? c->part : c->line;
    int n = 0;
    *text = 0;
    if (c->n_output >= MANY)
        n = snprintf(text, CHILD_REASON, "; it printed %.0f MB", (double)c->n_output * 1e-6);
    if (*line)
        snprintf(text + n, (size_t)(CHILD_REASON - n), "; its last line: %.*s", SHOWN, line);
}

void child_describe(const struct child *c, char text[CHILD_REASON])
{
    char output[CHILD_REASON];
    bool killed = WIFSIGNALED(c->status);
    child_describe_output(c, output);
    snprintf(text, CHILD_REASON, "ended %s %d%.200s", killed ? "by signal" : "with status",
             killed ? WTERMSIG(c->status) : WEXITSTATUS(c->status), output);
}
