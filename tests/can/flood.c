/* flood.c - a bus at saturation and beyond beside normal commands.
 *
 *   flood check BUS [OTHER]          a plant, its controller and a flooder in this process, bus frame by bus
 *                                    frame and without a clock: prints `ok`/`FAIL` lines. BUS is udp
 *                                    (loopback) or can:IFACE; OTHER is a second can:IFACE on the same wire,
 *                                    where controller and flooder are then. Over UDP a process of its own
 *                                    floods too, as fast as it is told or can, from a stranger's port, a
 *                                    peer's or the controller's own, while STOPs are counted in bus frames
 *   flood send BUS [PEER] N SECONDS  N frames a second to a plant that runs elsewhere; says how many went out
 *
 * Flood frames carry the plant's command identifiers and a wrong checksum: the costliest that are still
 * refused. */
#include <arpa/inet.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#include "firmware/app/app.h"
#include "host_sim/live/bus.h"
#include "host_sim/live/client_host.h"
#include "host_sim/cli/clock.h"
#include "models/hertz_rig.h"

enum {
    SUBSTEPS = 64,
    KINDS = 15,      /* commands that there are, from the base identifier on */
    FRAMES = 50,     /* bus frames of each flood */
    FIRE_EVERY = 10, /* bus frames */
    FIRE_AHEAD = 3,  /* bus frames from sending a FIRE to the instant that it names */
    BEYOND =
        2000, /* frames in a bus frame: more than APP_RECV_BUDGET, so that the kernel's queue overflows */
    BEYOND_FRAMES = 10,
    STOPS = 10,          /* under each flood of another process */
    STOP_FRAMES = 2,     /* in which each of them must act */
    BACK_FRAMES = 20,    /* after which a new session runs the plant again */
    PEER_RATE = 4800000, /* bytes a second from a listed peer */
    PACKET_FRAMES = 107, /* frames in the longest packet that the hal sends */
    OWN_PACKETS = 100,   /* before a STOP of their sender: they fit into any system's queue */
    LONG_TURNS = 3,      /* turns of the hal that a queue of its sender before a STOP takes */
    STOP_WAIT = 100,     /* bus frames after which a STOP counts as lost */
    STOOD_MS = 100,      /* that this process may stand still before a STOP that counts */
    EXCUSES = 5,         /* so many STOPs under a flood of their own sender need not count */
    BATCH = 64,          /* packets of a stranger in one system call */
    DRAIN_FRAMES = 5000, /* bound of the wait for an empty queue */
    SETTLE_MS = 20000    /* and of that for the kernel to bring to every socket what was sent */
};

static const struct wire_scene identity = {.base_id = 0x200};
static struct bus plant_bus, control_bus, flood_bus;
static struct bus *flooder = &flood_bus; /* whose address the flood comes from */
static struct app app;
static struct client client;
static int n_failed, n_passed;
static uint64_t n_sent;                   /* frames that the plant should see or know of as dropped */
static bool two_ends;                     /* plant and controller at two interfaces */
static uint64_t plant_heard, others_sent; /* counts of the interfaces at the start */

static void check(const char *name, bool good, uint64_t got, const char *relation, uint64_t expected)
{
    printf("%s  %s: %llu, %s %llu\n", good ? "ok  " : "FAIL", name, (unsigned long long)got, relation,
           (unsigned long long)expected);
    n_passed += good;
    n_failed += !good;
}

static void check_equal(const char *name, uint64_t got, uint64_t expected)
{
    check(name, got == expected, got, "expected", expected);
}

/* ---- the flooder ---- */

static bool add_flood(uint32_t i)
{
    struct message m = {.kind = (uint8_t)(i % KINDS), .counter = (uint8_t)(i % WIRE_COUNTER_STATES)};
    struct frame f;
    wire_encode(&identity, &m, &f);
    f.data[0] ^= 0x55;
    return flooder->hal.send(flooder->hal.context, &f);
}

/* A packet each over UDP: drops are counted in packets. */
static bool flood_one(uint32_t i)
{
    bool taken = add_flood(i);
    flooder->hal.flush(flooder->hal.context);
    return taken;
}

/* The longest packet over UDP. */
static uint64_t flood_packet(void)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < PACKET_FRAMES - 1; i++)
        n += add_flood(i);
    return n + flood_one(PACKET_FRAMES);
}

static void flood(uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        n_sent += flood_one(i);
}

/* ---- check ---- */

static void open_or_die(struct bus *b, const char *spec, const char *const *peer, int n_peers)
{
    char why[BUS_REASON];
    if (bus_open(b, spec, peer, n_peers, &identity, why))
        return;
    printf("FAIL  %s: %s\n", spec, why);
    exit(1);
}

static uint64_t interface_count(const struct bus *b, const char *name)
{
    char path[128];
    unsigned long long n = 0;
    snprintf(path, sizeof path, "/sys/class/net/%s/statistics/%s", b->interface, name);
    FILE *f = fopen(path, "r");
    if (!f || fscanf(f, "%llu", &n) != 1)
        printf("FAIL  %s cannot be read\n", path), exit(1);
    fclose(f);
    return n;
}

static void open_all_can(const char *spec, const char *other)
{
    two_ends = other != NULL;
    open_or_die(&plant_bus, spec, NULL, 0);
    open_or_die(&control_bus, two_ends ? other : spec, NULL, 0);
    open_or_die(&flood_bus, two_ends ? other : spec, NULL, 0);
    plant_heard = interface_count(&plant_bus, "rx_packets");
    others_sent = interface_count(&flood_bus, "tx_packets");
}

/* Over UDP three ports of this process; on CAN three sockets. */
static void open_all(const char *spec, const char *other)
{
    if (strcmp(spec, "udp")) {
        open_all_can(spec, other);
        return;
    }
    char at[3][32], to[3][32];
    int port = 22000 + (int)(getpid() % 3500) * 3; /* below those that the kernel gives away */
    for (int i = 0; i < 3; i++) {
        snprintf(at[i], sizeof at[i], "udp:%d", port + i);
        snprintf(to[i], sizeof to[i], "127.0.0.1:%d", port + i);
    }
    open_or_die(&plant_bus, at[0], (const char *[]){to[1], to[2]}, 2);
    open_or_die(&control_bus, at[1], (const char *[]){to[0]}, 1);
    open_or_die(&flood_bus, at[2], (const char *[]){to[0]}, 1);
}

static uint32_t dropped(void)
{
    return plant_bus.kind == BUS_UDP ? plant_bus.udp.dropped : plant_bus.can.dropped;
}

/* By the kernel, or by the plant as part of a flood. */
static uint64_t lost(void)
{
    return (uint64_t)dropped() + app.count[DIAG_RX_FLOOD];
}

/* Whether the kernel has brought n frames to each socket on this interface. A sender's own come back to it
 * and count, though it does not hear them. */
static bool is_delivered(const struct bus *b, uint64_t n)
{
    char line[256], interface[32];
    unsigned long long matches, least = UINT64_MAX;
    FILE *f = fopen("/proc/net/can/rcvlist_fil", "r");
    while (f && fgets(line, sizeof line, f))
        if (sscanf(line, "%31s %*x %*x %*s %*s %llu", interface, &matches) == 2 &&
            !strcmp(interface, b->interface))
            least = matches < least ? matches : least;
    if (!f)
        printf("FAIL  /proc/net/can/rcvlist_fil cannot be read\n"), exit(1);
    fclose(f);
    return least != UINT64_MAX && least >= n;
}

/* Frames are on their way for a while: until this end has all. */
static void settle(const struct bus *b)
{
    uint64_t sent = (uint64_t)plant_bus.can.sent + control_bus.can.sent + flood_bus.can.sent;
    for (int i = 0; b->kind == BUS_CAN && i < SETTLE_MS && !is_delivered(b, sent); i++)
        usleep(1000);
}

static void turn(void)
{
    settle(&plant_bus);
    app_frame(&app);
    settle(&control_bus);
    client_poll(&client);
}

static void enable(void)
{
    n_sent += client_enable(&client, true);
}

/* A STOP ends a session, as a time-out does: the next number. */
static void ask_for_session(void)
{
    client.session = (uint8_t)(app.session % WIRE_SESSIONS + 1);
    memset(client.counter, 0, sizeof client.counter);
    enable();
}

/* A new session, running. */
static void open_session(void)
{
    ask_for_session();
    turn();
    n_sent += client_control(&client, CONTROL_START, 0);
    turn();
}

struct seen {
    uint64_t fires, answered, applied, in_time, beats;
};

/* One bus frame of flood and commands: every tenth has
 * a FIRE that names an instant FIRE_AHEAD frames later. */
static void flooded_turn(struct seen *s, uint32_t n_flood, int i, uint64_t *named)
{
    uint32_t fires = app.count[DIAG_FIRE_APPLIED];
    uint64_t replies = client.latest.count[WIRE_REPLY];
    flood(n_flood);
    if (i % 5 == 0)
        enable(), s->beats++;
    bool fire = i % FIRE_EVERY == 0;
    if (fire) {
        *named = app.plant.now.tick + FIRE_AHEAD * SUBSTEPS;
        n_sent += client_arm(&client, RIG_FORCE, 1.0, 200.0, 0.0, 0.01) ? 4 : 0;
        n_sent += client_fire(&client, 1u << RIG_FORCE, false, *named, 0.0);
        s->fires++;
    }
    turn();
    s->answered += fire && client.latest.count[WIRE_REPLY] == replies + 1;
    if (app.count[DIAG_FIRE_APPLIED] == fires)
        return;
    s->applied++;
    s->in_time += app.latency.applied_tick == *named;
}

/* Until nothing waits: frames without flood. A heartbeat in each carries the kernel's count of drops. */
static void drain(void)
{
    uint64_t before, after;
    int i = 0;
    do {
        before = app.count[DIAG_FRAMES_RECEIVED] + lost();
        enable();
        turn();
        after = app.count[DIAG_FRAMES_RECEIVED] + lost();
    } while (after > before + 1 && i++ < DRAIN_FRAMES);
}

static void account(uint64_t crc)
{
    drain();
    check_equal("received + dropped, of all that was sent",
                (uint64_t)app.count[DIAG_FRAMES_RECEIVED] + lost(), n_sent);
    check_equal("refused for their checksum", app.count[DIAG_CRC], crc);
}

/* A flood that one bus frame can take: no command may be late or lost. */
static void check_flood(uint32_t n_flood)
{
    struct seen s = {0};
    uint64_t named = 0, crc = app.count[DIAG_CRC], frame = app.frame, tick = app.plant.now.tick;
    printf("--- %u frames of flood in every bus frame: %u a second\n", n_flood, n_flood * 1000);
    for (int i = 0; i < FRAMES; i++)
        flooded_turn(&s, n_flood, i, &named);
    check_equal("FIREs answered in the frame after their arrival", s.answered, s.fires);
    check_equal("applied", s.applied, s.fires);
    check_equal("at the tick that they name", s.in_time, s.fires);
    check_equal("plant frames in as many bus frames", (app.plant.now.tick - tick) / SUBSTEPS,
                app.frame - frame);
    check_equal("dropped", lost(), 0);
    account(crc + (uint64_t)n_flood * FRAMES);
}

/* More than the plant takes in a frame: what is beyond is dropped, by the plant or in the queue. Everything
 * is counted, nothing acts late, and a new session finds the plant as it should be. */
static void check_beyond(void)
{
    struct seen s = {0};
    uint64_t named = 0, sent = n_sent;
    printf("--- beyond: %d frames of flood in every bus frame\n", BEYOND);
    for (int i = 0; i < BEYOND_FRAMES; i++)
        flooded_turn(&s, BEYOND, i, &named);
    printf("sent %llu, taken at most %d a frame in %u frames, dropped %u by the plant and %u before it; "
           "FIREs sent %llu, "
           "applied %llu\n",
           (unsigned long long)(n_sent - sent), APP_RECV_BUDGET, app.count[DIAG_RX_BUDGET],
           app.count[DIAG_RX_FLOOD], dropped(), (unsigned long long)s.fires, (unsigned long long)s.applied);
    check("some were dropped", lost() > 0, lost(), "above", 0);
    check("the plant was told of those that it did not see", !dropped() || app.count[DIAG_RX_DROPPED],
          app.count[DIAG_RX_DROPPED], "reports of", dropped());
    check_equal("FIREs applied at another tick than theirs", s.applied - s.in_time, 0);
    drain();
    flood(1); /* with this sender's next packet the kernel tells what it dropped of its packets */
    turn();
    check_equal("received + dropped, of all that was sent",
                (uint64_t)app.count[DIAG_FRAMES_RECEIVED] + lost(), n_sent);
    check("heartbeats that drowned end the session, or they did not",
          app.faults == 0 || app.faults == FAULT_TIMEOUT, app.faults, "0 or", FAULT_TIMEOUT);
    if (!app.enabled)
        open_session();
    check_equal("state: running", app.state, STATE_RUNNING);
    uint64_t before = lost();
    s = (struct seen){0};
    for (int i = 0; i < FRAMES; i++)
        flooded_turn(&s, 30, i, &named);
    check_equal("and FIREs are in time again", s.in_time, s.fires);
    check_equal("nothing more is dropped", lost(), before);
}

/* ---- a flood from another process ---- */

/* Until it is killed: longest packets of a listed peer at PEER_RATE. *sent counts frames. */
static void flood_as_peer(volatile uint64_t *sent)
{
    const double packets_per_s = PEER_RATE / (5.0 + 13.0 * PACKET_FRAMES);
    int64_t start = clock_now_ns();
    for (uint64_t n = 0;; n++) {
        clock_sleep_until_ns(start + (int64_t)(1e9 * (double)n / packets_per_s));
        *sent += flood_packet();
    }
}

/* As flood_as_peer, from the controller's own address:
 * its commands wait in the queue that the flood fills. */
static void flood_as_controller(volatile uint64_t *sent)
{
    flooder = &control_bus;
    flood_as_peer(sent);
}

/* Until it is killed: packets of one frame, from a port
 * that is nobody's, as fast as the kernel takes them. */
static void flood_as_stranger(volatile uint64_t *sent)
{
    static uint8_t packet[18] = {CANNELLONI_VERSION, 0, 0, 0, 1, 0, 0, 2, 1, 8};
    static struct mmsghdr batch[BATCH];
    struct iovec data = {packet, sizeof packet};
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons(plant_bus.udp.port)};
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int fd = socket(AF_INET, SOCK_DGRAM, 0);
    for (int i = 0; i < BATCH; i++)
        batch[i].msg_hdr =
            (struct msghdr){.msg_name = &to, .msg_namelen = sizeof to, .msg_iov = &data, .msg_iovlen = 1};
    for (;;) {
        int n = sendmmsg(fd, batch, BATCH, 0);
        *sent += n > 0 ? (uint64_t)n : 0;
    }
}

static void beat_and_turn(int64_t *due)
{
    clock_sleep_until_ns(*due += 1000000);
    enable();
    turn();
}

/* A STOP amid the flood: the bus frames until it acts, STOP_WAIT where it was lost. *excused: the STOP waits
 * in the queue of the flood, and this process stood still just before. Then a flood of all that time stands
 * before the STOP, or has filled the queue. */
static uint32_t frames_until_stopped(int64_t *due, bool own, bool *excused)
{
    uint32_t n = 0, before;
    for (int k = 0; k < STOP_WAIT && !plant_bus.udp.queue[0].is_empty; k++)
        beat_and_turn(due);
    before = dropped();
    int64_t turn_ns = clock_now_ns();
    client_control(&client, CONTROL_STOP, 0);
    double stood_ms = (double)(clock_now_ns() - turn_ns) * 1e-6;
    for (; app.state != STATE_STOPPED && n < STOP_WAIT; n++) {
        clock_sleep_until_ns(*due += 1000000);
        turn();
    }
    *excused = own && n > STOP_FRAMES && (stood_ms > STOOD_MS || dropped() > before);
    if (*excused)
        printf(
            "note  a STOP took %u bus frames: this process stood still for %.0f ms before it, and the kernel "
            "dropped %u packets\n",
            n, stood_ms, dropped() - before);
    return n;
}

/* Bus frames until a new session runs the plant again. */
static uint32_t frames_until_running(int64_t *due)
{
    uint32_t n = 0;
    while (app.state != STATE_RUNNING && n < DRAIN_FRAMES) {
        if (app.enabled)
            client_control(&client, CONTROL_START, client.latest.frame);
        else
            ask_for_session();
        clock_sleep_until_ns(*due += 1000000);
        turn();
        n++;
    }
    return n;
}

/* STOPs while another process floods, and a new session after each. */
static void check_stops(const char *name, void (*flood_on)(volatile uint64_t *sent))
{
    uint32_t longest = 0, longest_back = 0, excuses = 0;
    uint64_t *sent = mmap(NULL, sizeof *sent, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    printf("--- %s floods\n", name);
    pid_t child = fork();
    if (child == 0)
        flood_on(sent);
    int64_t start = clock_now_ns(), due = start;
    for (uint32_t i = 0; i < STOPS + excuses; i++) {
        bool excused;
        for (int k = 0; k < 100; k++)
            beat_and_turn(&due);
        uint32_t n = frames_until_stopped(&due, flood_on == flood_as_controller, &excused);
        if (excused && excuses < EXCUSES)
            excuses++;
        else
            longest = n > longest ? n : longest;
        uint32_t back = frames_until_running(&due);
        longest_back = back > longest_back ? back : longest_back;
    }
    double seconds = (double)(clock_now_ns() - start) * 1e-9;
    uint64_t frames = *sent;
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    munmap(sent, sizeof *sent);
    printf("%.0f frames a second for %.1f s; dropped %u by the plant and %u before it, %u of strangers\n",
           (double)frames / seconds, seconds, app.count[DIAG_RX_FLOOD], dropped(), plant_bus.udp.foreign);
    printf("%u STOPs count, %u do not\n", STOPS, excuses);
    check("bus frames from a STOP to the standstill, the longest", longest <= STOP_FRAMES, longest, "at most",
          STOP_FRAMES);
    check("bus frames from the standstill to a new session that runs, the longest",
          longest_back <= BACK_FRAMES, longest_back, "at most", BACK_FRAMES);
    check_equal("time-outs", app.count[DIAG_TIMEOUTS], 0);
    drain();
    check_equal("state: running", app.state, STATE_RUNNING);
}

/* STOPs behind a flood of their own sender, in one queue, without a clock: in, one and two bus frames
 * after another flood. */
static void check_own_flood(void)
{
    uint32_t longest = 0, before = dropped();
    printf("--- up to %d packets of flood before a STOP of the same sender\n", OWN_PACKETS);
    flooder = &control_bus;
    for (int i = 0; i <= OWN_PACKETS; i += 10) {
        int64_t due = clock_now_ns();
        for (int k = 0; k < 5; k++)
            (void)flood_packet();
        for (int k = 0; k < i % 3; k++)
            turn();
        for (int k = 0; k < i; k++)
            (void)flood_packet();
        client_control(&client, CONTROL_STOP, 0);
        uint32_t n = 0;
        for (; app.state != STATE_STOPPED && n < STOP_WAIT; n++)
            turn();
        longest = n > longest ? n : longest;
        (void)frames_until_running(&due);
    }
    flooder = &flood_bus;
    check("bus frames from a STOP to the standstill, the longest", longest <= STOP_FRAMES, longest, "at most",
          STOP_FRAMES);
    check_equal("dropped by the kernel", dropped(), before);
    check_equal("state: running", app.state, STATE_RUNNING);
}

/* More packets before the first STOP than a plant frame looks at, or than the queue holds: a STOP in each bus
 * frame, until one acts. */
static void check_long_queue(void)
{
    uint32_t n = 0;
    int64_t due = clock_now_ns();
    printf("--- %d packets of flood before STOPs of the same sender\n", LONG_TURNS * UDP_TURN);
    flooder = &control_bus;
    for (uint32_t i = 0; i < LONG_TURNS * UDP_TURN; i++)
        (void)flood_one(i);
    for (; app.state != STATE_STOPPED && n < STOP_WAIT; n++) {
        client_control(&client, CONTROL_STOP, 0);
        turn();
    }
    flooder = &flood_bus;
    check("bus frames from the first STOP to the standstill", n <= STOP_FRAMES + LONG_TURNS - 1, n, "at most",
          STOP_FRAMES + LONG_TURNS - 1);
    (void)frames_until_running(&due);
    check_equal("state: running", app.state, STATE_RUNNING);
}

static void check_other_process(void)
{
    check_own_flood();
    check_long_queue();
    check_stops("the controller's own address", flood_as_controller);
    check_stops("a listed peer", flood_as_peer);
    check_stops("a stranger", flood_as_stranger);
    check_equal("strangers, remembered", plant_bus.udp.n_strangers, 1);
}

/* Compares with the counts of the interfaces. */
static void check_wire(void)
{
    uint64_t sent = interface_count(&flood_bus, "tx_packets") - others_sent;
    printf("--- the interfaces\n");
    check_equal("sent by the other end", sent, n_sent);
    check_equal("received by the plant's", interface_count(&plant_bus, "rx_packets") - plant_heard, sent);
}

static int run_check(const char *spec, const char *other)
{
    struct app_config c = {
        .model = &hertz_rig, .method = &rk4, .frame_s = 1e-3, .substeps = SUBSTEPS, .dilation = 1.0};
    c.base_id = identity.base_id;
    open_all(spec, other);
    const char *why = app_init(&app, &c, &plant_bus.hal);
    if (why) {
        printf("FAIL  app_init: %s\n", why);
        return 1;
    }
    client_init(&client, &control_bus.hal, &app.scene);
    for (int i = 0; i < 20; i++)
        turn();
    open_session();
    check_flood(0);
    check_flood(20);
    check_flood(200);
    check_beyond();
    if (two_ends)
        check_wire();
    if (plant_bus.kind == BUS_UDP)
        check_other_process();
    printf("%d passed, %d failed\n", n_passed, n_failed);
    return n_failed != 0;
}

/* ---- send ---- */

/* Every millisecond its share. */
static int run_send(const char *spec, const char *peer, double rate, double seconds)
{
    uint64_t taken = 0, refused = 0, due = 0;
    open_or_die(&flood_bus, spec, &peer, peer ? 1 : 0);
    int64_t start = clock_now_ns();
    for (int64_t ms = 1; (double)ms <= seconds * 1e3; ms++) {
        clock_sleep_until_ns(start + ms * 1000000);
        for (; (double)due < rate * (double)ms * 1e-3; due++)
            *(flood_one((uint32_t)due) ? &taken : &refused) += 1;
    }
    printf("flood: %llu frames sent, %llu refused by the kernel, in %.2f s\n", (unsigned long long)taken,
           (unsigned long long)refused, (double)(clock_now_ns() - start) * 1e-9);
    return 0;
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    if (argc >= 3 && argc <= 4 && !strcmp(argv[1], "check"))
        return run_check(argv[2], argc == 4 ? argv[3] : NULL);
    if (argc >= 5 && argc <= 6 && !strcmp(argv[1], "send"))
        return run_send(argv[2], argc == 6 ? argv[3] : NULL, atof(argv[argc - 2]), atof(argv[argc - 1]));
    fprintf(
        stderr,
        "usage: flood check udp|can:IFACE [can:OTHER], or flood send BUS [PEER] FRAMES_PER_SECOND SECONDS\n");
    return 2;
}
