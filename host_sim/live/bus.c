/* bus.c - see bus.h. */
#include "host_sim/live/bus.h"
#include "host_sim/cli/files.h"

#include "host_sim/cli/options_nearest.h"
#include "host_sim/live/fault_list.h"

#include <arpa/inet.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

const struct option bus_options[] = {
    {"bus", "BUS",
     "udp:PORT, udp:HOST:PORT, can:IFACE; run --lockstep: memory:FILE, too (run udp:20000, control :20001, "
     "monitor :20002, send :20003)",
     OPTION_TEXT, .initial = NULL},
    {"peer", "HOST:PORT", "peer over UDP; repeatable, up to 4 (run 127.0.0.1:20001 to :20003, others :20000)",
     OPTION_TEXT, .many = true},
    {.name = NULL},
};

/* The addresses that each role binds to and speaks with by default. */
static const struct {
    const char *spec;
    int n_peers;
    const char *peer[3];
} role_default[] = {
    [BUS_PLANT] = {"udp:20000", 3, {"127.0.0.1:20001", "127.0.0.1:20002", "127.0.0.1:20003"}},
    [BUS_CONTROLLER] = {"udp:20001", 1, {"127.0.0.1:20000"}},
    [BUS_MONITOR] = {"udp:20002", 1, {"127.0.0.1:20000"}},
    [BUS_SENDER] = {"udp:20003", 1, {"127.0.0.1:20000"}},
};

static bool refuse_bus(char *why, const char *reason)
{
    snprintf(why, BUS_REASON, "%s", reason);
    return false;
}

static bool open_udp(struct bus *b, const char *local, const char *const *peer, int n_peers, char *why)
{
    struct udp_config c = {.local = local, .n_peers = (uint32_t)n_peers};
    if (n_peers < 1 || n_peers > UDP_PEERS)
        return refuse_bus(why, "a UDP bus has 1 to 4 peers; give each by --peer HOST:PORT");
    for (int i = 0; i < n_peers; i++)
        c.peer[i] = peer[i];
    const char *reason = udp_open(&b->udp, &c);
    if (reason)
        return refuse_bus(why, reason);
    b->kind = BUS_UDP;
    b->interface = "udp";
    b->hal = b->udp.hal;
    return true;
}

static bool open_can(struct bus *b, const char *interface, const struct wire_scene *scene, char *why)
{
    const struct socketcan_config c = {.interface = interface,
                                       .base_id = scene->base_id,
                                       .n_plants = b->n_plants,
                                       .extended = scene->extended};
    const char *reason = socketcan_open(&b->can, &c);
    if (reason)
        return refuse_bus(why, reason);
    b->kind = BUS_CAN;
    b->interface = interface;
    b->hal = b->can.hal;
    return true;
}

static bool open_memory(struct bus *b, const char *path, char *why)
{
    char clash[FILES_REASON];
    struct stat there; /* memory_open refuses it, also a link that a killed plant left */
    if (*path && lstat(path, &there) && !files_take("bus", path, false, clash))
        return refuse_bus(why, clash);
    const char *reason = memory_open(&b->memory, *path ? path : NULL);
    if (reason)
        return refuse_bus(why, reason);
    b->kind = BUS_MEMORY;
    b->interface = "udp"; /* a run has equal logs over both */
    b->hal = b->memory.hal;
    return true;
}

bool bus_open(struct bus *b, const char *spec, const char *const *peer, int n_peers,
              const struct wire_scene *scene, char *why)
{
    b->kind = BUS_NONE;
    b->recording = false;
    b->faults = NULL;
    b->strangers_told = 0;
    memset(b->peer_told, 0, sizeof b->peer_told);
    memset(b->malformed_told, 0, sizeof b->malformed_told);
    memset(b->passed_over_told, 0, sizeof b->passed_over_told);
    b->log_told = false;
    if (!strncmp(spec, "udp:", 4))
        return open_udp(b, spec + 4, peer, n_peers, why);
    if (!strncmp(spec, "can:", 4))
        return open_can(b, spec + 4, scene, why);
    if (!strncmp(spec, "memory:", 7))
        return open_memory(b, spec + 7, why);
    return refuse_bus(why, "a bus is udp:PORT, udp:HOST:PORT or can:IFACE");
}

/* PORT or ANYTHING:PORT with a port that a number can be. */
static bool has_port(const char *text)
{
    const char *colon = strrchr(text, ':');
    double port;
    return options_read_number(colon ? colon + 1 : text, &port) && port >= 0.0 && port <= 65535.0 &&
           port == floor(port);
}

static const char *no_bus(const char *spec)
{
    static char text[BUS_REASON];
    static const char *const kind[] = {"udp", "can", "memory"};
    char own[16];
    snprintf(own, sizeof own, "%.*s", (int)strcspn(spec, ":"), spec);
    const char *near = strchr(spec, ':') ? options_nearest(own, kind, 3) : NULL;
    snprintf(text, sizeof text,
             "a bus is udp:PORT, udp:HOST:PORT or can:IFACE; for run --lockstep memory:FILE, too%s%s%s",
             near ? "; did you mean " : "", near ? near : "", near ? ":?" : "");
    return text;
}

const char *bus_misspelt(const char *spec, const char *const *peer, int n_peers, enum bus_role role)
{
    bool udp = !strncmp(spec, "udp:", 4), memory = !strncmp(spec, "memory:", 7);
    if (!udp && !memory && strncmp(spec, "can:", 4))
        return no_bus(spec);
    if (memory && role != BUS_PLANT)
        return "memory: is a bus of run --lockstep alone; its controller maps the file "
               "(docs/guide/lockstep.md)";
    if (memory && !spec[7])
        return "a bus of memory is memory:FILE, a file that run makes, say memory:/dev/shm/rig";
    if (udp && !has_port(spec + 4))
        return "a UDP bus is udp:PORT or udp:HOST:PORT, PORT 0 to 65535";
    if (!udp && n_peers)
        return "--peer goes with --bus udp: only";
    for (int i = 0; i < n_peers; i++)
        if (!strchr(peer[i], ':') || !has_port(peer[i]))
            return "a peer is HOST:PORT, PORT 1 to 65535";
    return n_peers > UDP_PEERS ? "at most 4 peers; take a --peer away" : NULL;
}

int bus_open_options(struct bus *b, const struct options *o, enum bus_role role,
                     const struct wire_scene *scene)
{
    const char *spec = options_text(o, "bus", 0), *peer[OPTIONS_GIVEN];
    char why[BUS_REASON];
    int n = options_count(o, "peer");
    for (int i = 0; i < n; i++)
        peer[i] = options_text(o, "peer", i);
    spec = spec ? spec : role_default[role].spec;
    if (!n && !strncmp(spec, "udp:", 4))
        for (; n < role_default[role].n_peers; n++)
            peer[n] = role_default[role].peer[n];
    const char *wrong = bus_misspelt(spec, peer, n, role);
    if (wrong)
        return options_misuse(o->usage, "%s", wrong);
    return bus_open(b, spec, peer, n, scene, why) ? 0 : options_failure(o->usage, "%s", why);
}

void bus_describe(const struct bus *b, char *text)
{
    if (b->kind == BUS_UDP)
        snprintf(text, BUS_REASON, "udp:%u", b->udp.port);
    else if (b->kind == BUS_MEMORY)
        snprintf(text, BUS_REASON, "memory:%s", b->memory.path);
    else
        snprintf(text, BUS_REASON, "can:%s", b->interface);
}

void bus_wait(void *context, double seconds)
{
    struct bus *b = context;
    int ms = (int)ceil(seconds * 1e3);
    struct pollfd p = {.fd = b->can.socket, .events = POLLIN};
    if (b->kind == BUS_UDP)
        udp_wait(&b->udp, ms);
    else
        (void)poll(&p, 1, ms);
}

bool bus_add_faults(struct bus *b, const char *list, uint64_t seed, double frame_s, char *why)
{
    b->faults = malloc(sizeof *b->faults);
    if (!b->faults)
        return refuse_bus(why, "out of memory");
    faults_init(b->faults, &b->hal, seed);
    if (*list && !fault_list_read(b->faults, list, frame_s, why))
        return false;
    b->hal = b->faults->hal;
    return true;
}

bool bus_record(struct bus *b, const char *path, uint64_t limit, char *why)
{
    const struct hal device = b->hal;
    if (!files_may_write(path))
        return refuse_bus(why, "log: it is read by this command; choose another file");
    const char *reason = log_open(&b->log, path, b->interface, &device);
    if (reason)
        return refuse_bus(why, reason);
    b->log.limit = limit;
    b->hal = b->log.hal;
    b->recording = true;
    return true;
}

void bus_set_frame(struct bus *b, uint64_t frame, double frame_s, uint32_t missed)
{
    if (!b->recording)
        return;
    log_set_frame(&b->log, frame, frame_s);
    log_missed(&b->log, missed);
}

static void write_address(const struct sockaddr_in *a, char text[32])
{
    char host[INET_ADDRSTRLEN];
    inet_ntop(AF_INET, &a->sin_addr, host, sizeof host);
    snprintf(text, 32, "%s:%u", host, ntohs(a->sin_port));
}

void bus_describe_peer(const struct bus *b, int i, char *text)
{
    if (b->kind == BUS_MEMORY)
        snprintf(text, BUS_REASON, "the controller");
    else
        write_address(&b->udp.peer[i], text);
}

/* The first peer of which this is true and was not told yet; it counts as told. -1: none. */
static int first_untold(const struct bus *b, const bool *is, bool *told)
{
    for (uint32_t i = 0; i < b->udp.n_peers; i++)
        if (is[i] && !told[i]) {
            told[i] = true;
            return (int)i;
        }
    return -1;
}

static bool peer_news(const struct bus *b, const bool *is, bool *told, const char *what, char *text)
{
    char at[32];
    int i = first_untold(b, is, told);
    if (i >= 0) {
        write_address(&b->udp.peer[i], at);
        snprintf(text, BUS_REASON, "the peer %s %s", at, what);
    }
    return i >= 0;
}

static bool udp_news(struct bus *b, char text[BUS_REASON])
{
    char at[32];
    if (b->strangers_told < b->udp.n_strangers) {
        write_address(&b->udp.stranger[b->strangers_told++], at);
        snprintf(text, BUS_REASON,
                 "%s sent packets that were dropped: it is not a listed peer; add --peer %s to the --peer of "
                 "the others",
                 at, at);
        return true;
    }
    bool failed[UDP_PEERS];
    for (int i = 0; i < UDP_PEERS; i++)
        failed[i] = b->udp.peer_error[i] != 0;
    int i = first_untold(b, failed, b->peer_told);
    if (i >= 0) {
        write_address(&b->udp.peer[i], at);
        snprintf(text, BUS_REASON, "cannot send to the peer %s: %s; check its address and the route", at,
                 strerror(b->udp.peer_error[i]));
        return true;
    }
    return peer_news(
               b, b->udp.peer_malformed, b->malformed_told,
               "sends what is refused: no packet of cannelloni version 2; see docs/reference/protocol.md",
               text) ||
           peer_news(
               b, b->udp.peer_passed_over, b->passed_over_told,
               "sends CAN FD, remote or error frames, too: they are passed over, and rx_foreign counts them",
               text);
}

bool bus_news(struct bus *b, char text[BUS_REASON])
{
    const char *ended = b->recording ? log_error(&b->log) : NULL;
    if (ended && !b->log_told) {
        b->log_told = true;
        snprintf(text, BUS_REASON, "%s", ended);
        return true;
    }
    return b->kind == BUS_UDP && udp_news(b, text);
}

bool bus_end_record(struct bus *b, char *why)
{
    const char *reason = b->recording ? log_close(&b->log) : NULL;
    if (b->recording)
        b->hal = b->log.inner;
    b->recording = false;
    return reason && !b->log.limited ? refuse_bus(why, reason) : true;
}

void bus_close(struct bus *b)
{
    char why[BUS_REASON];
    (void)bus_end_record(b, why);
    free(b->faults);
    b->faults = NULL;
    if (b->kind == BUS_UDP)
        udp_close(&b->udp);
    if (b->kind == BUS_CAN)
        socketcan_close(&b->can);
    if (b->kind == BUS_MEMORY)
        memory_close(&b->memory);
    b->kind = BUS_NONE;
}
