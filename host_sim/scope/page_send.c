/* page_send.c - see page_send.h. */
#include "host_sim/scope/page_send.h"
#include "host_sim/cli/clock.h"
#include "host_sim/live/send_verbs.h"
#include "host_sim/scene/scene.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/random.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    SEND_PORT = 3,                               /* send's port over UDP is the plant's and so much more */
    WORDS = 10 + 2 * OPTIONS_GIVEN + SEND_WORDS, /* in send's command line */
    TEXT = 16384                                 /* and its bytes */
};

static const double command_patience_s = 1.0, command_look_s = 0.005; /* for a command to end */

bool page_send_open(struct page_send *c)
{
    unsigned char random[(HTTP_TOKEN - 1) / 2];
    if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random)
        return false;
    for (size_t i = 0; i < sizeof random; i++)
        snprintf(c->token + 2 * i, 3, "%02x", random[i]);
    return true;
}

static int port_of(const char *address)
{
    const char *colon = strrchr(address, ':');
    return atoi(colon ? colon + 1 : address);
}

/* Where send is, and whom it speaks with over UDP: a plant
 * that runs beside us at udp:HOST:PORT, or at `peer`. */
static void place(struct page_send_plant *p, const char *bus, const char *peer)
{
    snprintf(p->bus, sizeof p->bus, "%s", bus);
    if (strncmp(bus, "udp:", 4))
        return;
    const char *host = bus + strlen("udp:"), *colon = strrchr(host, ':');
    int n = colon ? (int)(colon - host) : 0;
    bool is_any = n == 0 || !strncmp(host, "0.0.0.0:", 8);
    p->is_beside = !peer;
    if (peer)
        snprintf(p->peer, sizeof p->peer, "%s", peer);
    else
        snprintf(p->peer, sizeof p->peer, "%.*s:%s", is_any ? 9 : n, is_any ? "127.0.0.1" : host,
                 colon ? colon + 1 : host);
    snprintf(p->bus, sizeof p->bus, "udp:%.*s%s%d", n, host, n ? ":" : "", port_of(p->peer) + SEND_PORT);
}

void page_send_add(struct page_send *c, const struct options *o, const char *scene, uint32_t base_id,
                   const char *bus, const char *peer)
{
    struct page_send_plant *p = &c->plant[c->n_plants++];
    *p = (struct page_send_plant){.o = o, .words = -1};
    snprintf(p->scene, sizeof p->scene, "%s", scene);
    snprintf(p->base_id, sizeof p->base_id, "0x%X", base_id);
    place(p, bus, peer);
}

/* ---- the words of send ---- */

/* A number, or an option that belongs to the command rather than to the plant or to this machine. */
static bool is_allowed(const char *word)
{
    static const char *const own[] = {"--hold", "--in", "--tick"};
    double number;
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++)
        if (!strncmp(word, own[i], strlen(own[i])) && strchr("=", word[strlen(own[i])]))
            return true;
    return word[0] != '-' || options_read_number(word, &number);
}

static int split(char *line, char **word)
{
    int n = 0;
    char *rest = line, *at;
    while (n <= SEND_WORDS && (at = strtok_r(n ? NULL : line, " ", &rest)))
        word[n++] = at;
    return n;
}

uint32_t page_send_begin(struct page_send *c, int i, const char *line, size_t n, const char **why)
{
    char copy[HTTP_BODY + 1], *word[SEND_WORDS + 1];
    struct page_send_plant *p = &c->plant[i];
    snprintf(copy, sizeof copy, "%.*s", (int)n, line);
    int n_words = split(copy, word);
    *why = "write a command of contactplant send, for instance: start";
    if (n_words == 0)
        return 0;
    *why = "a command has at most 80 words";
    if (n_words > SEND_WORDS)
        return 0;
    *why = "--hold, --in and --tick belong to a command; the scope knows the plant and its bus";
    for (int k = 0; k < n_words; k++)
        if (!is_allowed(word[k]))
            return 0;
    page_send_leave(c, i, p->number);
    snprintf(p->line, sizeof p->line, "%.*s", (int)n, line);
    p->waits = true;
    return ++p->number;
}

static bool describes_the_plant(const struct option *option)
{
    for (const struct option *s = scene_options; s->name; s++)
        if (!strcmp(s->name, option->name))
            return strcmp(s->name, "base-id") != 0;
    return false;
}

/* A command line, whose words are copies. */
struct words {
    char *argv[WORDS + 1], text[TEXT];
    size_t n, used;
    bool full;
};

static void add_word(struct words *w, const char *dashes, const char *word)
{
    int n = snprintf(w->text + w->used, sizeof w->text - w->used, "%s%s", dashes, word);
    w->full = w->full || w->n == WORDS || (size_t)n >= sizeof w->text - w->used;
    if (w->full)
        return;
    w->argv[w->n++] = w->text + w->used;
    w->used += (size_t)n + 1;
}

/* contactplant send, the plant, and the command. */
static void compose(struct words *w, struct page_send_plant *p)
{
    const char *const own[] = {"contactplant", "send",  "--model", p->scene, "--base-id",
                               p->base_id,     "--bus", p->bus,    "--peer", p->peer};
    char *word[SEND_WORDS + 1];
    for (size_t i = 0; i < sizeof own / sizeof own[0] - (p->peer[0] ? 0 : 2); i++)
        add_word(w, "", own[i]);
    const char *more = NULL;
    for (int i = 1; p->peer[0] && !p->is_beside && (more = options_text(p->o, "peer", i)); i++) {
        add_word(w, "", "--peer");
        add_word(w, "", more);
    }
    for (int i = 0; i < p->o->n_given; i++) {
        const struct given *g = &p->o->given[i];
        bool shared = describes_the_plant(g->option);
        if (shared)
            add_word(w, "--", g->option->name);
        if (shared && g->text)
            add_word(w, "", g->text);
    }
    int n = split(p->line, word);
    for (int i = 0; i < n; i++)
        add_word(w, "", word[i]);
}

/* ---- its process ---- */

/* In the child. It ends with the scope, however that ends. */
static void become(char *const *argv, int words)
{
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    signal(SIGINT, SIG_DFL);
    dup2(words, STDOUT_FILENO);
    dup2(words, STDERR_FILENO);
    execv("/proc/self/exe", argv);
    _exit(127);
}

static void start(struct page_send_plant *p)
{
    struct words w = {.n = 0};
    int words[2];
    p->waits = false;
    p->until_s = 0.0;
    compose(&w, p);
    if (w.full || pipe2(words, O_CLOEXEC))
        return;
    (void)fcntl(words[0], F_SETFL, O_NONBLOCK);
    fflush(NULL);
    p->pid = fork();
    if (p->pid == 0)
        become(w.argv, words[1]);
    close(words[1]);
    p->words = words[0];
    if (p->pid > 0)
        return;
    close(words[0]);
    p->words = -1;
    p->pid = 0;
}

/* Takes note of its end, and brings it about where it is due. */
static void look_after(struct page_send_plant *p)
{
    if (p->pid && waitpid(p->pid, &p->status, WNOHANG) == p->pid)
        p->pid = 0;
    if (p->pid && p->until_s > 0.0 && clock_now_s() > p->until_s)
        kill(p->pid, SIGKILL);
}

void page_send_turn(struct page_send *c)
{
    for (int i = 0; i < c->n_plants; i++) {
        look_after(&c->plant[i]);
        if (c->plant[i].waits && !c->plant[i].pid)
            start(&c->plant[i]);
    }
}

static size_t say_end(const struct page_send_plant *p, char *text, size_t room)
{
    bool began = p->words >= 0, exited = began && WIFEXITED(p->status);
    if (exited)
        return (size_t)snprintf(text, room, "exit %d\n", WEXITSTATUS(p->status));
    return (size_t)snprintf(text, room, began ? "ended by a signal\n" : "cannot start contactplant send\n");
}

size_t page_send_read(struct page_send *c, int i, uint32_t number, char *text, size_t room, bool *over)
{
    struct page_send_plant *p = &c->plant[i];
    *over = number != p->number;
    if (*over)
        return (size_t)snprintf(text, room, "ended by a later command\n");
    if (p->waits)
        return 0;
    ssize_t n = p->words < 0 ? 0 : read(p->words, text, room);
    *over = n == 0 && !p->pid;
    return *over ? say_end(p, text, room) : n > 0 ? (size_t)n : 0;
}

void page_send_leave(struct page_send *c, int i, uint32_t number)
{
    struct page_send_plant *p = &c->plant[i];
    if (number != p->number)
        return;
    p->waits = false;
    if (p->words >= 0)
        close(p->words);
    p->words = -1;
    if (!p->pid)
        return;
    kill(p->pid, SIGTERM);
    p->until_s = clock_now_s() + command_patience_s;
}

static bool is_at_work(struct page_send *c)
{
    bool any = false;
    page_send_turn(c);
    for (int i = 0; i < c->n_plants; i++)
        any = any || c->plant[i].pid;
    return any;
}

void page_send_close(struct page_send *c)
{
    double end = clock_now_s() + 2.0 * command_patience_s;
    for (int i = 0; i < c->n_plants; i++)
        page_send_leave(c, i, c->plant[i].number);
    while (is_at_work(c) && clock_now_s() < end)
        clock_sleep_s(command_look_s);
    c->n_plants = 0;
}
