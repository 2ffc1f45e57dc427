/* scope_child.c - run --scope: the scope as a child process that reads what the plant hears and says. */
#include "host_sim/scope/scope.h"
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/scope/ear.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NICE = 10 }; /* anybody else who wants the processor has it first */

static const double child_patience_s = 2.0, child_look_s = 0.005;

const struct option scope_options[] = {
    {.name = "scope", .meaning = "show the plant in a browser; see contactplant scope"},
    SCOPE_HTTP,
    {.name = NULL},
};

/* The plant of these options, in the child. False after a line on stderr. */
static bool add_own_plant(struct ear *e, const struct options *o, const struct tee_memory *memory)
{
    const char *bus = options_text(o, "bus", 0), *scene = o->n_words ? o->word[0] : "hertz_rig";
    struct voice *v = ear_add(e, scene);
    char why[SCENE_REASON];
    if (!v || !scene_from_options(&v->scene, o, 0) || !scene_start(&v->scene, NULL, why))
        return false;
    snprintf(v->bus, sizeof v->bus, "%s", bus ? bus : "udp:20000");
    v->hears_commands = v->has_timing = true;
    voice_begin(v);
    ear_command(e, v, o, v->bus, NULL);
    tee_read(&e->tee, memory);
    e->source[e->n_sources++].hal = &e->tee.hal;
    return true;
}

/* Until the plant has ended, or its process. An interrupt is the plant's: it ends the scope in order. */
static void serve(struct ear *e, const struct options *o, const struct tee_memory *memory, pid_t plant)
{
    signal(SIGINT, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    signal(SIGTERM, SIG_DFL);
    errno = 0;
    (void)!nice(NICE);
    if (!add_own_plant(e, o, memory))
        return;
    while (!tee_is_over(&e->tee) && getppid() == plant)
        ear_turn(e);
    ear_turn(e);
    ear_close(e, "the plant has ended");
}

static int begin(struct scope_child *c, const struct options *o, struct ear *e)
{
    pid_t plant = getpid();
    c->memory = tee_share();
    if (!c->memory)
        return options_failure(o->usage, "no memory to share with the scope: %s", strerror(errno));
    fflush(NULL);
    c->pid = fork();
    if (c->pid < 0)
        return options_failure(o->usage, "cannot start the scope's process: %s", strerror(errno));
    if (c->pid)
        return STATUS_DONE;
    serve(e, o, c->memory, plant);
    _exit(STATUS_DONE);
}

int scope_child_start(struct scope_child *c, const struct options *o)
{
    const char *at = options_text(o, "http", 0);
    bool more = at || options_given(o, "control");
    if (!options_given(o, "scope"))
        return more ? options_misuse(o->usage, "--http and --control need --scope") : STATUS_DONE;
    struct ear *e = calloc(1, sizeof *e);
    if (!e)
        return options_failure(o->usage, "out of memory");
    int status = ear_open(e, o, at ? at : SCOPE_AT);
    status = status ? status : begin(c, o, e);
    server_close(&e->server); /* the child has its own */
    free(e);
    return status;
}

void scope_child_attach(struct scope_child *c, struct hal *hal, const struct timing *timing)
{
    if (!c->pid)
        return;
    tee_open(&c->tee, c->memory, hal, timing);
    *hal = c->tee.hal;
}

static bool is_gone(struct scope_child *c)
{
    return waitpid(c->pid, NULL, WNOHANG) != 0;
}

void scope_child_end(struct scope_child *c)
{
    double end = clock_now_s() + child_patience_s;
    bool gone = c->pid <= 0;
    if (!gone)
        tee_end(c->memory);
    while (!gone && !(gone = is_gone(c)) && clock_now_s() < end)
        clock_sleep_s(child_look_s);
    if (!gone) {
        kill(c->pid, SIGKILL);
        (void)waitpid(c->pid, NULL, 0);
    }
    if (c->memory)
        tee_unshare(c->memory);
    *c = (struct scope_child){0};
}
