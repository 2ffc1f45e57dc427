/* scope_child.c - see scope_child.h. The scope is a child process that reads what the plant receives and
 * sends. */
#include "host_sim/scope/scope_child.h"
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/scope/hub.h"

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
static bool add_own_plant(struct hub *h, const struct options *o, const struct ring *ring)
{
    const char *bus = options_text(o, "bus", 0), *scene = o->n_words ? o->word[0] : "hertz_rig";
    struct decoder *d = hub_add(h, scene);
    char why[SCENE_REASON];
    if (!d || !scene_from_options(&d->scene, o, 0) || !scene_start(&d->scene, NULL, why))
        return false;
    snprintf(d->bus, sizeof d->bus, "%s", bus ? bus : "udp:20000");
    d->has_commands = d->has_timing = true;
    decoder_begin(d);
    hub_command(h, d, o, d->bus, NULL);
    ring_reader_open(&h->ring, ring);
    h->source[h->n_sources++].hal = &h->ring.hal;
    return true;
}

/* Until the plant has ended, or its process. An interrupt is the plant's: it ends the scope in order. */
static void serve(struct hub *h, const struct options *o, const struct ring *ring, pid_t plant)
{
    signal(SIGINT, SIG_IGN);
    signal(SIGHUP, SIG_IGN);
    signal(SIGTERM, SIG_DFL);
    errno = 0;
    (void)!nice(NICE);
    if (!add_own_plant(h, o, ring))
        return;
    while (!ring_is_over(&h->ring) && getppid() == plant)
        hub_turn(h);
    hub_turn(h);
    hub_close(h, "the plant has ended");
}

static int begin(struct scope_child *c, const struct options *o, struct hub *h)
{
    pid_t plant = getpid();
    c->ring = ring_share();
    if (!c->ring)
        return options_failure(o->usage, "no memory to share with the scope: %s", strerror(errno));
    fflush(NULL);
    c->pid = fork();
    if (c->pid < 0)
        return options_failure(o->usage, "cannot start the scope's process: %s", strerror(errno));
    if (c->pid)
        return STATUS_DONE;
    serve(h, o, c->ring, plant);
    _exit(STATUS_DONE);
}

int scope_child_start(struct scope_child *c, const struct options *o)
{
    const char *at = options_text(o, "http", 0);
    bool more = at || options_given(o, "control");
    if (!options_given(o, "scope"))
        return more ? options_misuse(o->usage, "--http and --control need --scope") : STATUS_DONE;
    struct hub *h = calloc(1, sizeof *h);
    if (!h)
        return options_failure(o->usage, "out of memory");
    int status = hub_open(h, o, at ? at : SCOPE_AT);
    status = status ? status : begin(c, o, h);
    server_close(&h->server); /* the child has its own */
    free(h);
    return status;
}

void scope_child_attach(struct scope_child *c, struct hal *hal, const struct timing *timing)
{
    if (!c->pid)
        return;
    ring_writer_open(&c->writer, c->ring, hal, timing);
    *hal = c->writer.hal;
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
        ring_end(c->ring);
    while (!gone && !(gone = is_gone(c)) && clock_now_s() < end)
        clock_sleep_s(child_look_s);
    if (!gone) {
        kill(c->pid, SIGKILL);
        (void)waitpid(c->pid, NULL, 0);
    }
    if (c->ring)
        ring_unshare(c->ring);
    *c = (struct scope_child){0};
}
