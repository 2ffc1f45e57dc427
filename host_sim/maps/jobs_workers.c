/* jobs_workers.c - the processes: each gets numbers of jobs through one pipe and sends rows through
 * another. */
#include "host_sim/maps/jobs_workers.h"

#include "host_sim/cli/clock.h"
#include "host_sim/maps/jobs.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

struct answer {
    int32_t job;
    int16_t good, last; /* last: this is the job's last piece */
    uint64_t bytes;
};

struct worker {
    pid_t pid; /* 0: it could not be started */
    int to, from;
    int job; /* that it computes, or -1 */
};

struct team {
    const struct workers *w;
    struct worker worker[JOBS_CORES];
    int n, next, busy;
    char *why;
};

int workers_cores(void)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    return n < 1 ? 1 : n > JOBS_CORES ? JOBS_CORES : (int)n;
}

static bool write_all(int fd, const void *data, size_t n)
{
    const char *at = data;
    while (n > 0) {
        ssize_t done = write(fd, at, n);
        if (done < 0 && errno != EINTR)
            return false;
        at += done > 0 ? done : 0;
        n -= done > 0 ? (size_t)done : 0;
    }
    return true;
}

static bool read_all(int fd, void *data, size_t n)
{
    char *at = data;
    while (n > 0) {
        ssize_t done = read(fd, at, n);
        if (done == 0 || (done < 0 && errno != EINTR))
            return false;
        at += done > 0 ? done : 0;
        n -= done > 0 ? (size_t)done : 0;
    }
    return true;
}

/* The job that this process computes. */
static struct {
    int32_t job;
    int to;
    char *text; /* its rows since the last piece */
    size_t bytes;
} work_now;

static bool send_rows(bool good, bool last)
{
    struct answer a = {work_now.job, good, last, work_now.bytes};
    return write_all(work_now.to, &a, sizeof a) && write_all(work_now.to, work_now.text, work_now.bytes);
}

void jobs_piece(FILE *rows)
{
    if (fflush(rows) || !send_rows(true, false))
        _exit(1);
    rewind(rows);
}

static bool answer_job(const struct workers *w, int job, int to)
{
    work_now.job = job;
    work_now.to = to;
    FILE *rows = open_memstream(&work_now.text, &work_now.bytes);
    if (!rows)
        return false;
    bool good = w->compute(w->context, job, rows);
    if (fclose(rows))
        return false;
    bool sent = send_rows(good, true);
    free(work_now.text);
    return sent;
}

/* A process: answers until its pipe closes. Its parent handles a stop from the terminal. */
static void work(const struct workers *w, int from, int to)
{
    int32_t job;
    signal(SIGINT, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    signal(SIGTERM, SIG_DFL);
    while (read_all(from, &job, sizeof job) && answer_job(w, job, to))
        ;
    _exit(0);
}

static bool start_worker(struct team *t, int i)
{
    int to[2], from[2];
    if (pipe(to))
        return false;
    if (pipe(from)) {
        close(to[0]), close(to[1]);
        return false;
    }
    fflush(NULL); /* else both processes write what is buffered */
    pid_t pid = fork();
    if (pid == 0) {
        for (int k = 0; k < t->n; k++)
            if (k != i)
                close(t->worker[k].to), close(t->worker[k].from);
        close(to[1]), close(from[0]);
        work(t->w, to[0], from[1]);
    }
    close(to[0]), close(from[1]);
    t->worker[i] = (struct worker){pid > 0 ? pid : 0, to[1], from[0], -1};
    t->n = i < t->n ? t->n : i + 1;
    return pid > 0;
}

/* Gives the next job, if there is one, to an idle worker. */
static bool give_job(struct team *t, struct worker *v)
{
    v->job = -1;
    if (t->next == t->w->end)
        return true;
    int32_t job = t->next++;
    v->job = job;
    t->busy++;
    return write_all(v->to, &job, sizeof job);
}

static bool cannot_start(struct team *t)
{
    return snprintf(t->why, JOBS_REASON, "no further process: %s", strerror(errno)) < 0;
}

/* The place of a process that ended without an answer gets another process, if there are more jobs. */
static bool replace(struct team *t, int i)
{
    struct worker *v = &t->worker[i];
    int status = 0, job = v->job;
    if (!t->w->lose)
        return snprintf(t->why, JOBS_REASON, "the process at job %d ended without an answer", job) < 0;
    kill(v->pid, SIGKILL);
    (void)waitpid(v->pid, &status, 0);
    close(v->to), close(v->from);
    *v = (struct worker){0, -1, -1, -1};
    t->busy--;
    if (!t->w->lose(t->w->taker, job, status))
        return snprintf(t->why, JOBS_REASON, "out of memory") < 0;
    return t->next == t->w->end || start_worker(t, i) ? true : cannot_start(t);
}

static bool employ(struct team *t, int i)
{
    bool good = true;
    while (good && !give_job(t, &t->worker[i]))
        good = replace(t, i);
    return good;
}

/* Text is to be freed. False: the process has ended, or memory has. */
static bool read_answer(const struct worker *v, struct answer *a, char **text)
{
    *text = read_all(v->from, a, sizeof *a) ? calloc(a->bytes + 1, 1) : NULL;
    if (*text && read_all(v->from, *text, a->bytes))
        return true;
    free(*text);
    return false;
}

static bool take_answer(struct team *t, int i)
{
    struct answer a;
    char *text;
    if (!read_answer(&t->worker[i], &a, &text))
        return replace(t, i) && employ(t, i);
    t->busy -= a.last;
    if (!a.good) {
        snprintf(t->why, JOBS_REASON, "job %d: %s", (int)a.job, text);
        free(text);
        return false;
    }
    if (!t->w->take(t->w->taker, a.job, text, a.last)) {
        snprintf(t->why, JOBS_REASON, "the rows cannot be written (%s)", strerror(errno));
        return false;
    }
    return !a.last || employ(t, i);
}

/* A process that was stopped by its job, not with all others, goes on. */
static void wake(const struct worker *v)
{
    siginfo_t found = {.si_pid = 0};
    if (v->pid && !waitid(P_PID, (id_t)v->pid, &found, WSTOPPED | WNOHANG) && found.si_pid)
        kill(v->pid, SIGCONT);
}

static bool serve(struct team *t)
{
    struct pollfd fd[JOBS_CORES];
    while (t->busy > 0) {
        for (int i = 0; i < t->n; i++)
            fd[i] = (struct pollfd){t->worker[i].job < 0 ? -1 : t->worker[i].from, POLLIN, 0};
        if (poll(fd, (nfds_t)t->n, 1000) < 0 && errno != EINTR)
            return snprintf(t->why, JOBS_REASON, "poll: %s", strerror(errno)) < 0;
        if (clock_interrupted())
            return snprintf(t->why, JOBS_REASON, "interrupted") < 0;
        for (int i = 0; i < t->n; i++)
            if (fd[i].fd >= 0 && fd[i].revents && !take_answer(t, i))
                return false;
        for (int i = 0; i < t->n && t->w->lose; i++)
            wake(&t->worker[i]);
    }
    return true;
}

static void end_workers(struct team *t, bool good)
{
    for (int i = 0; i < t->n; i++) {
        if (!good && t->worker[i].pid)
            kill(t->worker[i].pid, SIGKILL);
        close(t->worker[i].to), close(t->worker[i].from);
    }
    for (int i = 0; i < t->n; i++)
        if (t->worker[i].pid)
            waitpid(t->worker[i].pid, NULL, 0);
}

bool workers_run(const struct workers *w, char *why)
{
    struct team t = {.w = w, .next = w->next, .why = why};
    int n = w->end - w->next < w->n ? w->end - w->next : w->n;
    bool good = true;
    clock_catch_signals();
    for (int i = 0; good && i < n; i++)
        good = start_worker(&t, i) ? true : cannot_start(&t);
    for (int i = 0; good && i < t.n; i++)
        good = employ(&t, i);
    if (good)
        good = serve(&t);
    end_workers(&t, good);
    return good;
}
