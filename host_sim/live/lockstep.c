/* lockstep.c - see lockstep.h. */
#include "host_sim/live/lockstep.h"
#include "host_sim/cli/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LOOK_MS = 100 };
static const double word_again_s = 0.01;               /* until a word that nobody took is said again */
static const int64_t too_late_ns = INT64_C(100000000); /* so late, a paced frame is not made up for */

const struct option lockstep_options[] = {
    {.name = "lockstep",
     .meaning = "no clock: a bus frame begins when each peer that is waited for has sent its datagram"},
    {"wait", "HOST:PORT", "with --lockstep: a peer that is waited for (the first peer)", OPTION_TEXT,
     .many = true},
    {"patience", "S",
     "with --lockstep: seconds of silence after which the run ends with status 4 (10; 0: never)",
     OPTION_NUMBER, 0.0, 1e9, .initial = "10"},
    {"speed", "X", "with --lockstep: at most so many times real time (as fast as the words come)",
     OPTION_NUMBER, 1e-3, 1e6, .initial = NULL},
    {.name = NULL},
};

int lockstep_check(const struct options *o)
{
    static const char *const needs_it[] = {"wait", "patience", "speed"};
    const char *spec = options_text(o, "bus", 0);
    bool memory = spec && !strncmp(spec, "memory:", 7);
    if (memory && !options_given(o, "lockstep"))
        return options_misuse(o->usage, "--bus memory: needs --lockstep; nobody else looks there in time");
    if (memory && options_given(o, "wait"))
        return options_misuse(o->usage, "--wait goes with --bus udp: only; memory has one controller");
    if (options_given(o, "lockstep"))
        return spec && !strncmp(spec, "can:", 4)
                   ? options_misuse(o->usage,
                                    "--lockstep needs --bus udp:; on CAN no frame says that a peer is done")
                   : 0;
    for (int i = 0; i < 3; i++)
        if (options_given(o, needs_it[i]))
            return options_misuse(o->usage, "--%s needs --lockstep", needs_it[i]);
    return 0;
}

int lockstep_open(struct lockstep *l, const struct options *o, struct bus *b, double period_s)
{
    uint32_t awaited = 0;
    if (!options_given(o, "lockstep"))
        return 0;
    for (int i = 0; i < options_count(o, "wait"); i++) {
        const char *text = options_text(o, "wait", i);
        int peer = udp_find_peer(&b->udp, text);
        if (peer < 0)
            return options_misuse(o->usage, "--wait %s is no peer; --peer %s lists it, beside the others",
                                  text, text);
        awaited |= 1u << peer;
    }
    if (b->kind == BUS_UDP) {
        const char *reason = udp_begin_lockstep(&b->udp, awaited ? awaited : 1u);
        if (reason)
            return options_failure(o->usage, "%s", reason);
        b->hal = b->udp.hal;
    }
    l->on = true;
    l->bus = b;
    l->patience_s = options_number(o, "patience");
    if (options_given(o, "speed"))
        l->pace_ns = llround(period_s * 1e9 / options_number(o, "speed"));
    return 0;
}

/* Peers as a list, of these bits. */
static void list_peers(const struct bus *b, uint32_t peers, char *text)
{
    char at[BUS_REASON];
    size_t n = 0;
    *text = 0;
    for (int i = 0; i < UDP_PEERS && n < BUS_REASON / 2; i++)
        if (peers >> i & 1u) {
            bus_describe_peer(b, i, at);
            n += (size_t)snprintf(text + n, BUS_REASON - n, "%s%s", n ? " and " : "", at);
        }
}

void lockstep_describe(const struct lockstep *l, char *text)
{
    list_peers(l->bus, l->bus->kind == BUS_MEMORY ? 1u : l->bus->udp.awaited, text);
}

static void complain(const struct lockstep *l, uint32_t silent, char *why)
{
    char who[BUS_REASON];
    bool refused = true;
    for (int i = 0; i < UDP_PEERS; i++)
        refused = refused && (!(silent >> i & 1u) || l->bus->udp.queue[i].refused);
    list_peers(l->bus, silent, who);
    snprintf(why, BUS_REASON, "no word of %.100s for %g s%s; --patience 0 waits for ever", who, l->patience_s,
             refused ? ", and nobody listens there" : "");
}

/* Not before its instant; a frame that is much too late shifts those after it. */
static void pace(struct lockstep *l, bool awake)
{
    int64_t now = clock_now_ns();
    l->begin_ns = l->begin_ns ? l->begin_ns : now;
    l->last_ns = now;
    if (!l->pace_ns)
        return;
    l->next_ns = now > l->next_ns + too_late_ns ? now : l->next_ns;
    (awake ? clock_wait_until_ns : clock_sleep_until_ns)(l->next_ns);
    l->next_ns += l->pace_ns;
}

/* The peers that have not said their word after a wait, as bits. */
static uint32_t await_words(struct bus *b)
{
    return b->kind == BUS_MEMORY ? !memory_await(&b->memory, LOOK_MS) : udp_await(&b->udp, LOOK_MS);
}

/* Silence is counted in looks: where this process or the machine was stopped, nobody was silent. */
enum lockstep_turn lockstep_await(struct lockstep *l, bool awake, char *why)
{
    int64_t begin_ns = clock_now_ns();
    uint32_t silent = await_words(l->bus);
    if (!silent) {
        l->silent_s = 0.0;
        pace(l, awake);
        return LOCKSTEP_BEGINS;
    }
    l->silent_s += 1e-3 * fmin((double)(clock_now_ns() - begin_ns) * 1e-6, LOOK_MS);
    if (l->patience_s > 0.0 && l->silent_s >= l->patience_s) {
        complain(l, silent, why);
        return LOCKSTEP_SILENT;
    }
    return LOCKSTEP_WAITS;
}

/* A plant that is not up yet refuses the first word, which is then said again without its commands; one that
 * has answered before and refuses has ended. */
static enum client_answer answer(void *context)
{
    struct bus *b = context;
    struct udp *u = &b->udp;
    bool refused = false;
    for (uint32_t i = 0; i < u->n_peers; i++) {
        refused = refused || u->queue[i].refused;
        u->queue[i].refused = false;
    }
    if (!u->unanswered || !refused)
        return u->unanswered ? CLIENT_UNANSWERED : CLIENT_ANSWERED;
    if (u->answers)
        return CLIENT_REFUSED;
    clock_sleep_s(word_again_s);
    u->unanswered = 0;
    b->hal.flush(b->hal.context);
    return CLIENT_UNANSWERED;
}

const char *lockstep_follow(struct client_link *link, struct bus *b, double patience_s)
{
    const char *reason = udp_begin_lockstep(&b->udp, 0);
    if (reason)
        return reason;
    b->hal = b->udp.hal;
    *link = (struct client_link){.context = b, .wait = bus_wait, .answer = answer, .patience_s = patience_s};
    return NULL;
}
