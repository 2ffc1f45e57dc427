/* board_hostile.c - hostile Ethernet frames for a board; see board_hostile.h. */
#include "tests/boards/board_hostile.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>
#include <arpa/inet.h>
#include "hal/posix/clock.h"
#include "hal/ethernet/net.h"
#include "tests/boards/board_bench.h"
#include "tests/fixture/packet.h"

enum { GARBAGE = 3000, AT_TYPE = 12, AT_IP = 14, AT_SUM = 24, AT_UDP = 34, AT_PAYLOAD = 42 };

/* The first peer and the plant of hal/ethernet/network.c. */
static const struct net_config config = {
    {{0x52, 0x55, 0x0A, 0x00, 0x02, 0x02}, {{10, 0, 2, 2}, {0x4E, 0x21}}},
    1,
    {{{10, 0, 2, 15}, {0x4E, 0x20}}}};

static int wire = -1;
static struct net net;

/* ---- the wire ---- */

static int wire_receive(void *context, uint8_t *frame)
{
    (void)context;
    ssize_t n = recv(wire, frame, ETHERNET_MAX, MSG_DONTWAIT);
    return n > 0 ? (int)n : 0;
}

static bool wire_transmit(void *context, const uint8_t *frame, size_t n)
{
    (void)context;
    return send(wire, frame, n, 0) == (ssize_t)n;
}

static const struct ethernet ethernet = {NULL, wire_receive, wire_transmit};

static bool open_wire(const char *board, const char *ours)
{
    struct sockaddr_in end = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    struct sockaddr_in here = end, there = end;
    here.sin_port = htons((uint16_t)atoi(ours));
    there.sin_port = htons((uint16_t)atoi(board));
    wire = socket(AF_INET, SOCK_DGRAM, 0);
    bench_roomy(wire);
    return wire >= 0 && !bind(wire, (const struct sockaddr *)&here, sizeof here) &&
           !connect(wire, (const struct sockaddr *)&there, sizeof there) &&
           !net_open(&net, &config, &ethernet);
}

/* ---- frames of no good peer ---- */

/* A STOP as a good peer would send it, header checksum included: taken, it would stop the plant. */
static size_t good(uint8_t *frame, const struct ipv4_host *who)
{
    const struct client *c = &bench.client;
    struct message m = {.kind = WIRE_CONTROL, .value = {c->session, CONTROL_STOP, 0xFF ^ CONTROL_STOP, 0}};
    struct cannelloni p;
    struct frame f;
    wire_encode(&c->scene, &m, &f);
    cannelloni_begin(&p, 0);
    cannelloni_add(&p, &f);
    return ipv4_build(who, net.mac[0], &config.peer[0], p.bytes, p.n_bytes, frame);
}

static void spoil(size_t at, uint8_t bits, bool mend)
{
    uint8_t frame[ETHERNET_MAX];
    size_t n = good(frame, &config.self);
    frame[at] ^= bits;
    if (mend) {
        memset(frame + AT_SUM, 0, 2);
        uint32_t sum = ~ipv4_sum(0, frame + AT_IP, 4 * (size_t)(frame[AT_IP] & 15));
        frame[AT_SUM] = (uint8_t)(sum >> 8);
        frame[AT_SUM + 1] = (uint8_t)sum;
    }
    wire_transmit(NULL, frame, n);
}

/* Returns how many of them the board must report as foreign. */
static int send_hostile(void)
{
    uint8_t frame[ETHERNET_MAX];
    struct ipv4_host stranger = config.self;
    int n = 0;
    spoil(AT_IP, 0x20, false), n++;     /* version 6 */
    spoil(AT_IP, 0x03, true), n++;      /* options */
    spoil(AT_IP + 2, 0x40, true), n++;  /* longer than the frame */
    spoil(AT_SUM, 0x01, false), n++;    /* header checksum */
    spoil(AT_IP + 6, 0x20, true), n++;  /* more fragments follow */
    spoil(AT_IP + 7, 0x10, true), n++;  /* a later fragment */
    spoil(AT_UDP + 5, 0x01, true), n++; /* UDP length */
    spoil(AT_UDP + 7, 0x01, true), n++; /* UDP checksum */
    spoil(AT_PAYLOAD, 0x01, true), n++; /* payload */
    stranger.end.port[1] = 0x99;
    wire_transmit(NULL, frame, good(frame, &stranger)), n++;
    stranger = config.self;
    stranger.end.address[3] = 77;
    wire_transmit(NULL, frame, good(frame, &stranger)), n++;
    size_t length = ipv4_build(&config.self, net.mac[0], &config.peer[0], packet_golden, 11, frame);
    wire_transmit(NULL, frame, length), n++; /* half a cannelloni packet */
    spoil(AT_TYPE, 0x80, false);             /* another protocol: nobody's fault */
    spoil(AT_UDP + 3, 0x40, true);           /* another port */
    return n;
}

/* Bytes that mean nothing, of every length, to the board's address. */
static void send_garbage(void)
{
    uint8_t frame[ETHERNET_MAX];
    uint32_t random = 1;
    for (int i = 0; i < GARBAGE; i++) {
        for (size_t k = 0; k < sizeof frame; k++) {
            random = random * 1664525u + 1013904223u;
            frame[k] = (uint8_t)(random >> 24);
        }
        memcpy(frame, net.mac[0], ETHERNET_MAC);
        frame[AT_TYPE] = 0x08;
        frame[AT_TYPE + 1] = i % 3 ? 0x00 : 0x06; /* IPv4 and ARP */
        frame[AT_IP] = i % 2 ? 0x45 : frame[AT_IP];
        wire_transmit(NULL, frame, AT_IP + random % (sizeof frame - AT_IP));
        if (i % 20 == 19)
            bench_pass(1, false);
    }
}

static void suffer(void)
{
    const struct latest *latest = &bench.client.latest;
    bench_open_session();
    bench_check("the board asked for our address", net.verdict[IPV4_ARP_REQUEST] > 0, true);
    bench_control("start", CONTROL_START, CAUSE_OK);
    int n = send_hostile();
    bench_pass(BENCH_HEALTH_ROUND + BENCH_HEARTBEAT, true);
    bench_check("hostile frames refused and reported", latest->health[DIAG_RX_FOREIGN], n);
    bench_check("none of them stopped the plant", latest->state, STATE_RUNNING);
    send_garbage();
    bench_pass(BENCH_HEALTH_ROUND + BENCH_HEARTBEAT, true);
    bench_check("garbage was refused", latest->health[DIAG_RX_FOREIGN] > n, true);
    bench_check("none of it stopped the plant", latest->state, STATE_RUNNING);
    bench_check("or was taken for a command", latest->health[DIAG_CRC] + latest->health[DIAG_LENGTH], 0);
    bench_check("frames missed", latest->health[DIAG_FRAMES_MISSED], 0);
    uint8_t frame[ETHERNET_MAX];
    wire_transmit(NULL, frame, good(frame, &config.self));
    bench_check("the good STOP is taken", client_wait_state(&bench.client, STATE_STOPPED, bench_limit_s()),
                true);
}

int board_hostile(const char *board, const char *ours, const char *console, char **emulator)
{
    if (!open_wire(board, ours)) {
        printf("FAIL  no wire between ports %s and %s\n", board, ours);
        return 1;
    }
    net.hal.now_us = clock_now_us;
    net.hal.healthy = clock_no_watchdog;
    bench_connect(&net.hal);
    pid_t child = bench_boot(console, emulator);
    suffer();
    close(wire);
    return bench_close(child);
}
