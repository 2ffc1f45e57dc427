/* test_udp.c - the socket: exchange, strangers, bad
 * packets, batching, a full kernel, a peer that is not up. */
#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <arpa/inet.h>
#include "hal/posix/udp.h"
#include "tests/fixture/packet.h"
#include "tests/unit/test.h"

enum { FLOOD = 20000, TRIES = 10, FULL_FRAMES = 227 };

/* The kernel never refuses a datagram on loopback: this stands before the C library's function and does. */
static int sends_until_refused = -1; /* -1: never */
static int send_error = EAGAIN;

int sendmmsg(int fd, struct mmsghdr *m, unsigned n, int flags)
{
    if (sends_until_refused == 0) {
        errno = send_error;
        return -1;
    }
    if (sends_until_refused > 0 && n > (unsigned)sends_until_refused)
        n = (unsigned)sends_until_refused;
    int sent = (int)syscall(SYS_sendmmsg, fd, m, n, flags);
    if (sends_until_refused > 0)
        sends_until_refused -= sent;
    return sent;
}

/* Nor does its receive fail: this does, once, with the error that is asked for. */
static int receive_error; /* errno, 0: none */

ssize_t recvmsg(int fd, struct msghdr *m, int flags)
{
    if (receive_error) {
        errno = receive_error;
        receive_error = 0;
        return -1;
    }
    return syscall(SYS_recvmsg, fd, m, flags);
}

/* And this tells that there is an error to be had, as the kernel would. */
int poll(struct pollfd *p, nfds_t n, int timeout_ms)
{
    const struct timespec t = {timeout_ms / 1000, timeout_ms % 1000 * 1000000L};
    if (receive_error && n > 0) {
        p[0].revents = POLLERR;
        return 1;
    }
    return (int)syscall(SYS_ppoll, p, n, &t, NULL, 0);
}

/* ---- two ends on loopback ---- */

static struct udp plant, bench;

static bool open_end(struct udp *u, const char *local, const char *peer)
{
    struct udp_config c = {.local = local, .peer = {peer}, .n_peers = 1};
    const char *reason = udp_open(u, &c);
    if (reason)
        printf("open: %s\n", reason);
    return reason == NULL;
}

static void close_both(void)
{
    udp_close(&plant);
    udp_close(&bench);
}

/* Finds two free ports: the kernel's choice for one end, then the ends name each other. */
static bool open_both(void)
{
    char plant_port[8], bench_port[8];
    bool open = false;
    for (int i = 0; i < TRIES && !open; i++) { /* another program may take one in between */
        if (!open_end(&plant, "0", "1") || !open_end(&bench, "0", "1"))
            return false;
        snprintf(plant_port, sizeof plant_port, "%u", plant.port);
        snprintf(bench_port, sizeof bench_port, "%u", bench.port);
        udp_close(&plant);
        udp_close(&bench);
        open = open_end(&plant, plant_port, bench_port) && open_end(&bench, bench_port, plant_port);
        if (!open)
            close_both();
    }
    return open;
}

static int take(struct udp *u, struct frame *f)
{
    struct pollfd p[UDP_QUEUES];
    for (int i = 0; i < UDP_QUEUES; i++)
        p[i] = (struct pollfd){.fd = u->queue[i].socket, .events = POLLIN};
    int got = u->hal.recv(u->hal.context, f);
    if (got == 0 && poll(p, UDP_QUEUES, 2000) > 0)
        got = u->hal.recv(u->hal.context, f);
    return got;
}

static void give(struct udp *u, const struct frame *f, int n)
{
    for (int i = 0; i < n; i++)
        u->hal.send(u->hal.context, &f[i]);
}

static void flush(struct udp *u)
{
    u->hal.flush(u->hal.context);
}

/* A stranger's socket; port 0: any. */
static int open_stranger(const char *address, uint16_t port)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_port = htons(port)};
    int fd = socket(AF_INET, SOCK_DGRAM, 0);
    inet_pton(AF_INET, address, &at.sin_addr);
    check_int("a stranger has a socket", bind(fd, (struct sockaddr *)&at, sizeof at), 0);
    return fd;
}

static void send_raw(int fd, uint16_t port, const void *packet, size_t n)
{
    struct sockaddr_in to = {
        .sin_family = AF_INET, .sin_port = htons(port), .sin_addr = {htonl(INADDR_LOOPBACK)}};
    if (sendto(fd, packet, n, 0, (struct sockaddr *)&to, sizeof to) != (ssize_t)n)
        perror("sendto");
}

/* The socket that is open to all, and sends. */
static int shared_socket(const struct udp *u)
{
    return u->queue[UDP_PEERS].socket;
}

static void refused_address(const char *name, const char *local, const char *peer, const char *part)
{
    static struct udp u;
    struct udp_config c = {.local = local, .peer = {peer}, .n_peers = 1};
    const char *reason = udp_open(&u, &c);
    printf("%s: %s\n", name, reason ? reason : "(opened)");
    check_contains(name, reason, part);
    udp_close(&u);
}

TEST(udp_addresses)
{
    char port[8];
    struct udp_config nobody = {.local = "0"};
    struct sockaddr_in bound;
    socklen_t length = sizeof bound;
    check_true("opens on a free port", open_end(&plant, "0", "127.0.0.1:1"));
    getsockname(shared_socket(&plant), (struct sockaddr *)&bound, &length);
    check_hex("bound to 127.0.0.1 unless told otherwise", ntohl(bound.sin_addr.s_addr), 0x7F000001);
    snprintf(port, sizeof port, "%u", plant.port);
    refused_address("port in use", port, "1", "in use: stop the program");
    udp_close(&plant);
    check_true("a closed port can be had again", open_end(&plant, port, "1"));
    udp_close(&plant);
    refused_address("not an address of this machine", "192.0.2.1:0", "1", "no address of this machine");
    refused_address("local without port", "127.0.0.1:", "1", "is not PORT");
    refused_address("local without host", ":20000", "1", "is not PORT");
    refused_address("local with a name", "rig.example:20000", "1",
                    "is not PORT, A.B.C.D:PORT or localhost:PORT");
    check_true("this machine has a name", open_end(&plant, "localhost:0", "localhost:1"));
    length = sizeof bound;
    getsockname(shared_socket(&plant), (struct sockaddr *)&bound, &length);
    check_hex("localhost is 127.0.0.1", ntohl(bound.sin_addr.s_addr), 0x7F000001);
    check_int("and a peer too", udp_find_peer(&plant, "127.0.0.1:1"), 0);
    udp_close(&plant);
    refused_address("local port above 65535", "65536", "1", "is not PORT");
    refused_address("peer with a sign", "0", "-1", "peer \"-1\" is not PORT");
    refused_address("peer port 0", "0", "127.0.0.1:0", "port 1 to 65535");
    refused_address("peer empty", "0", "", "is not PORT");
    check_error("no peer", udp_open(&bench, &nobody));
}

TEST(udp_exchange)
{
    struct frame got;
    check_true("both ends open", open_both());
    printf("receive buffer granted: %d bytes, send buffer %d bytes\n", plant.receive_bytes, plant.send_bytes);
    check_int("nothing waits", plant.hal.recv(&plant, &got), 0);
    flush(&bench);
    check_int("an empty flush sends nothing", bench.packets_sent, 0);
    give(&bench, packet_frame, 3);
    check_int("nothing goes before flush", plant.hal.recv(&plant, &got), 0);
    flush(&bench);
    for (int i = 0; i < 3; i++)
        check_true("a frame arrives in order",
                   take(&plant, &got) == 1 && packet_same(&got, &packet_frame[i]));
    check_int("and no more", plant.hal.recv(&plant, &got), 0);
    check_int("in one packet", plant.packets_received, 1);
    give(&plant, packet_frame, 1);
    flush(&plant);
    check_int("the answer arrives", take(&bench, &got), 1);
    check_true("the answer arrives", packet_same(&got, &packet_frame[0]));
    send_raw(shared_socket(&bench), plant.port, "\2\0\0\0\0", 5); /* a packet of no frames is valid */
    give(&bench, packet_frame, 1);
    flush(&bench);
    check_int("a packet of no frames is passed over", take(&plant, &got), 1);
    close_both();
}

/* A packet of exactly the greatest length, 5 + 227 * 9 bytes, and one too many behind it. */
static void fill_packet(uint8_t big[CANNELLONI_PACKET_MAX + 1])
{
    memset(big, 0, CANNELLONI_PACKET_MAX + 1);
    big[0] = CANNELLONI_VERSION;
    big[4] = FULL_FRAMES;
    for (int i = 0; i < FULL_FRAMES; i++)
        big[CANNELLONI_HEADER + 9 * i + 4] = 4; /* length */
}

TEST(udp_strangers)
{
    struct frame got;
    uint8_t big[CANNELLONI_PACKET_MAX + 1];
    check_true("both ends open", open_both());
    int stranger = open_stranger("127.0.0.1", 0), namesake = open_stranger("127.0.0.2", bench.port);
    send_raw(stranger, plant.port, packet_golden, sizeof packet_golden);
    check_int("a stranger's packet is foreign", take(&plant, &got), -HAL_FOREIGN);
    check_int("counted", plant.foreign, 1);
    check_int("and gives no frame", plant.hal.recv(&plant, &got), 0);
    check_int("nor an answer", recv(stranger, big, sizeof big, MSG_DONTWAIT), -1);
    send_raw(namesake, plant.port, packet_golden, sizeof packet_golden);
    check_int("a peer's port at another address is foreign", take(&plant, &got), -HAL_FOREIGN);
    check_int("counted", plant.foreign, 2);
    check_int("and gives no frame", plant.hal.recv(&plant, &got), 0);
    give(&plant, packet_frame, 1);
    flush(&plant);
    check_int("nor is anything sent there", recv(namesake, big, sizeof big, MSG_DONTWAIT), -1);
    send_raw(shared_socket(&bench), plant.port, packet_golden, sizeof packet_golden - 1);
    check_int("a peer's bad packet is refused", take(&plant, &got), -HAL_FOREIGN);
    check_int("counted on its own", plant.malformed, 1);
    send_raw(shared_socket(&bench), plant.port, packet_beside, sizeof packet_beside);
    check_int("frames of other kinds are told", take(&plant, &got), -HAL_FOREIGN);
    check_int("and counted", plant.passed_over, 2);
    check_int("the command beside them is taken", take(&plant, &got), 1);
    check_true("as it is", packet_same(&got, &packet_frame[0]));
    check_int("its packet is not malformed", plant.malformed, 1);
    fill_packet(big);
    send_raw(shared_socket(&bench), plant.port, big, CANNELLONI_PACKET_MAX);
    int n = 0;
    while (n < FULL_FRAMES && take(&plant, &got) == 1)
        n++;
    check_int("frames of the longest packet", n, FULL_FRAMES);
    send_raw(shared_socket(&bench), plant.port, big, sizeof big);
    check_int("a packet that is too long is refused", take(&plant, &got), -HAL_FOREIGN);
    check_int("counted too", plant.malformed, 2);
    send_raw(shared_socket(&bench), plant.port, "", 0);
    check_int("an empty datagram is refused", take(&plant, &got), -HAL_FOREIGN);
    give(&bench, packet_frame, 1);
    flush(&bench);
    check_int("a good one is taken after all that", take(&plant, &got), 1);
    close(stranger);
    close(namesake);
    close_both();
}

/* Frames of 13 bytes in packets of 1400 with a header of 5: 107 fit. */
TEST(udp_batching)
{
    struct frame f = {.id = 0x100, .length = 8}, got;
    int64_t in_order = 0;
    check_true("both ends open", open_both());
    for (uint32_t i = 0; i < 250; i++) {
        f.data[0] = (uint8_t)i;
        give(&plant, &f, 1);
    }
    check_int("full packets go by themselves", plant.packets_sent, 2);
    flush(&plant);
    check_int("flush sends the rest", plant.packets_sent, 3);
    for (uint32_t i = 0; i < 250; i++)
        in_order += take(&bench, &got) == 1 && got.data[0] == (uint8_t)i;
    check_int("frames that arrive in order", in_order, 250);
    check_int("in packets", bench.packets_received, 3);
    close_both();
}

TEST(udp_kernel_full)
{
    struct frame f = {.id = 0x100, .length = 8}, got;
    int64_t taken = 0, in_order = 0;
    check_true("both ends open", open_both());
    sends_until_refused = 0;
    for (uint32_t i = 0; i < 200; i++) {
        f.data[0] = (uint8_t)i;
        taken += plant.hal.send(&plant, &f);
        flush(&plant);
    }
    check_int("taken while the kernel refuses: one packet", taken, 107);
    check_int("every refused send is counted", plant.kernel_full, 200 + 200 - 107);
    sends_until_refused = -1;
    flush(&plant);
    for (uint32_t i = 0; i < 107; i++)
        in_order += take(&bench, &got) == 1 && got.data[0] == (uint8_t)i;
    check_int("what was taken arrives", in_order, 107);
    close_both();

    /* two peers, of which only the first gets the packet at
     * once: none gets it twice, and it does not grow between */
    char peer[2][8];
    check_true("both ends open", open_both());
    snprintf(peer[0], sizeof peer[0], "%u", plant.port);
    snprintf(peer[1], sizeof peer[1], "%u", bench.port);
    struct udp_config c = {.local = "0", .peer = {peer[0], peer[1]}, .n_peers = 2};
    static struct udp u;
    uint8_t bytes[64];
    check_no_error("third end opens", udp_open(&u, &c));
    sends_until_refused = 1;
    give(&u, packet_frame, 1);
    flush(&u);
    check_int("no room while a peer waits", u.hal.send(&u, &packet_frame[1]), 0);
    check_int("the first peer has it", recv(shared_socket(&plant), bytes, sizeof bytes, MSG_DONTWAIT), 12);
    sends_until_refused = -1;
    give(&u, &packet_frame[1], 1);
    flush(&u);
    check_int("the second peer gets the same", recv(shared_socket(&bench), bytes, sizeof bytes, MSG_DONTWAIT),
              12);
    check_int("sequence 0", bytes[2], 0);
    check_int("then the next", recv(shared_socket(&bench), bytes, sizeof bytes, MSG_DONTWAIT), 18);
    check_int("sequence 1", bytes[2], 1);
    check_int("the first peer too, once", recv(shared_socket(&plant), bytes, sizeof bytes, MSG_DONTWAIT), 18);
    check_int("and no more", recv(shared_socket(&plant), bytes, sizeof bytes, MSG_DONTWAIT), -1);
    udp_close(&u);
    close_both();
}

/* Reads until a whole turn brings nothing. */
static void read_all(int64_t *received, int64_t *reported)
{
    struct frame got;
    int n, more = 1;
    while (more) {
        for (more = 0; (n = plant.hal.recv(&plant, &got)) != 0; more = 1) {
            *received += n > 0;
            *reported += n == -HAL_DROPPED;
        }
    }
}

/* Every frame sent is either received or counted as dropped. */
TEST(udp_overflow)
{
    const struct frame f = {.id = 0x100, .length = 8};
    int64_t received = 0, reported = 0;
    check_true("both ends open", open_both());
    for (int i = 0; i < FLOOD; i++) {
        give(&bench, &f, 1);
        flush(&bench);
    }
    read_all(&received, &reported);
    give(&bench, &f, 1); /* the kernel tells its count with the next packet */
    flush(&bench);
    read_all(&received, &reported);
    check_int("received + dropped", received + plant.dropped, FLOOD + 1);
    check_above("dropped", plant.dropped, 1);
    check_above("HAL_DROPPED reports", (double)reported, 1);
    close_both();
}

/* A plant with two peers, the bench and a third end. */
static void open_three(struct udp *third)
{
    char local[8], peer[2][8];
    check_true("both ends open", open_both());
    check_true("a third end", open_end(third, "0", "1"));
    uint16_t port[] = {bench.port, third->port};
    snprintf(local, sizeof local, "%u", plant.port);
    for (int i = 0; i < 2; i++)
        snprintf(peer[i], sizeof peer[i], "%u", port[i]);
    udp_close(&plant), udp_close(third);
    const struct udp_config c = {.local = local, .peer = {peer[0], peer[1]}, .n_peers = 2};
    check_no_error("the plant has two peers", udp_open(&plant, &c));
    check_true("the plant has two peers", plant.all_connected);
    check_true("the third end speaks with it", open_end(third, peer[1], local));
}

/* Three peers and a plant: the first floods, the second sends
 * one frame behind all that, and so does a stranger before. */
TEST(udp_flood)
{
    static struct udp third;
    struct frame f = {.id = 0x100, .length = 8}, got;
    open_three(&third);
    int stranger = open_stranger("127.0.0.1", 0), at = -1, n, foreign = 0, taken = 0;
    for (int i = 0; i < FLOOD; i++) {
        give(&bench, &f, 1);
        flush(&bench);
        send_raw(stranger, plant.port, packet_golden, sizeof packet_golden);
    }
    f.id = 0x101;
    give(&third, &f, 1);
    flush(&third);
    while ((n = plant.hal.recv(&plant, &got)) != 0) {
        foreign += n == -HAL_FOREIGN;
        taken += n > 0;
        at = n > 0 && got.id == 0x101 ? taken : at;
    }
    check_below("the second peer's frame is among the first", at, 2);
    check_int("frames of the first in one turn", taken - 1, UDP_TURN);
    check_int("datagrams of strangers in one turn", foreign, UDP_TURN_STRANGERS);
    check_int("remembered strangers", plant.n_strangers, 1);
    for (int turn = 0; turn < FLOOD; turn++)
        while ((n = plant.hal.recv(&plant, &got)) != 0)
            ;
    send_raw(stranger, plant.port, packet_golden, sizeof packet_golden);
    (void)take(&plant, &got);
    check_int("all that the stranger sent counts as foreign", plant.foreign, FLOOD + 1);
    f.id = 0x102;
    give(&third, &f, 1);
    flush(&third);
    flush(&plant);
    check_int("and the link is as before", take(&plant, &got), 1);
    check_is("and the link is as before", got.id, ==, 0x102);
    close(stranger);
    udp_close(&third);
    close_both();
}

/* Packets of no frames before a command: UDP_TURN of them in a turn, so the command behind up to that many
 * comes in this turn. */
TEST(udp_flood_empty)
{
    struct frame got;
    check_true("both ends open", open_both());
    for (int n = UDP_TURN - 1; n <= UDP_TURN; n++) {
        for (int i = 0; i < n; i++)
            send_raw(shared_socket(&bench), plant.port, "\2\0\0\0\0", 5);
        give(&bench, packet_frame, 1);
        flush(&bench);
        flush(&plant);
        check_int("the command, in this turn", plant.hal.recv(&plant, &got), n < UDP_TURN);
        check_int("and no more", plant.hal.recv(&plant, &got), n == UDP_TURN);
    }
    check_int("packets of the peer", plant.packets_received, 2 * UDP_TURN + 1);
    close_both();
}

/* While a plant has its address, nobody else may take it, however it asks. */
TEST(udp_address_kept)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    check_true("both ends open", open_both());
    at.sin_port = htons(plant.port);
    int option[] = {SO_REUSEADDR, SO_REUSEPORT}, on = 1;
    for (int i = 0; i < 2; i++) {
        int fd = socket(AF_INET, SOCK_DGRAM, 0);
        setsockopt(fd, SOL_SOCKET, option[i], &on, sizeof on);
        check_int("a second program is not let in", bind(fd, (struct sockaddr *)&at, sizeof at), -1);
        close(fd);
    }
    close_both();
}

TEST(udp_peer_not_up)
{
    struct frame got;
    char port[8];
    check_true("both ends open", open_both());
    snprintf(port, sizeof port, "%u", bench.port);
    udp_close(&bench);
    for (int i = 0; i < 5; i++) {
        give(&plant, packet_frame, 1);
        flush(&plant);
        check_int("sending to nobody is harmless", plant.hal.recv(&plant, &got), 0);
    }
    check_int("and counted as sent", plant.packets_sent, 5);
    check_true("the peer comes up", open_end(&bench, port, "1"));
    give(&plant, packet_frame, 1);
    flush(&plant);
    uint8_t bytes[64];
    check_int("and hears the plant", recv(shared_socket(&bench), bytes, sizeof bytes, 0), 12);
    udp_close(&plant);
    /* a socket on 127.0.0.1 has no way to 192.0.2.1: the kernel refuses that packet at once */
    struct udp_config c = {.local = "0", .peer = {"192.0.2.1:9", port}, .n_peers = 2};
    check_no_error("opens with a peer that cannot be reached", udp_open(&plant, &c));
    give(&plant, packet_frame, 1);
    flush(&plant);
    check_int("that peer is passed over and counted", plant.unsent, 1);
    check_is("with the reason", plant.peer_error[0], !=, 0);
    check_int("with the reason", plant.peer_error[1], 0);
    struct frame none;
    check_int("the plant is told", plant.hal.recv(&plant, &none), -HAL_UNSENT);
    check_int("once a packet", plant.hal.recv(&plant, &none), 0);
    check_int("the other gets its packet", recv(shared_socket(&bench), bytes, sizeof bytes, MSG_DONTWAIT),
              12);
    close_both();
}

TEST(udp_receive_errors)
{
    struct frame got;
    check_true("both ends open", open_both());
    const int harmless[] = {EINTR, ECONNREFUSED};
    for (int i = 0; i < 2; i++) {
        give(&bench, packet_frame, 1);
        flush(&bench);
        receive_error = harmless[i];
        check_int("a signal, or a peer that is not up: the packet behind it is taken", take(&plant, &got), 1);
    }
    receive_error = ENETDOWN;
    check_int("another error of the socket is reported", plant.hal.recv(&plant, &got), -HAL_DOWN);
    check_int("once", plant.hal.recv(&plant, &got), 0);
    sends_until_refused = 0;
    send_error = ENOBUFS;
    give(&plant, packet_frame, 1);
    flush(&plant);
    check_int("a device without buffers: the packet is kept and counted", plant.kernel_full, 1);
    check_int("not given up", plant.unsent, 0);
    sends_until_refused = -1;
    send_error = EAGAIN;
    flush(&plant);
    check_int("and goes later", take(&bench, &got), 1);
    close_both();
}

/* ---- lockstep ---- */

/* Both ends on loopback; the plant awaits the bench. */
static void open_lockstep(void)
{
    check_true("both ends open", open_both());
    check_no_error("the plant awaits the bench", udp_begin_lockstep(&plant, 1));
    check_no_error("which awaits nobody", udp_begin_lockstep(&bench, 0));
}

static void say(const struct frame *f, int n)
{
    give(&bench, f, n);
    flush(&bench);
}

/* The frames that one turn of the plant takes; the turn ends with its flush. */
static int take_turn(void)
{
    struct frame got;
    int n = 0, more;
    check_int("the turn begins", udp_await(&plant, 2000), 0);
    while ((more = plant.hal.recv(&plant, &got)) != 0)
        n += more > 0;
    flush(&plant);
    return n;
}

/* All that the bench has been told. */
static void hear(void)
{
    struct frame got;
    for (int i = 0; i < 2; i++) /* a turn of the bench ends with nothing */
        while (bench.hal.recv(&bench, &got) != 0)
            ;
}

TEST(udp_lockstep_turns)
{
    struct frame got;
    open_lockstep();
    check_int("nobody has spoken", udp_await(&plant, 0), 1);
    say(NULL, 0);
    check_int("an empty packet is sent", bench.packets_sent, 1);
    check_int("and not answered", bench.unanswered, 1);
    check_int("it is a word, without frames", take_turn(), 0);
    check_int("which is taken once", udp_await(&plant, 0), 1);
    hear();
    check_int("the plant's own empty packet answers it", bench.unanswered, 0);
    check_int("the plant's own empty packet answers it", bench.answers, 1);
    for (int i = 1; i <= 3; i++)
        say(packet_frame, i);
    for (int i = 1; i <= 3; i++)
        check_int("each turn takes one of the words that wait", take_turn(), i);
    hear();
    check_int("each is answered", bench.unanswered, 0);
    send_raw(shared_socket(&bench), plant.port, packet_golden, sizeof packet_golden - 1);
    check_int("a malformed packet is no word", udp_await(&plant, 2000), 1);
    check_true("whose it was is known", plant.peer_malformed[0]);
    send_raw(shared_socket(&bench), plant.port, packet_beside, sizeof packet_beside);
    check_int("one with frames of other kinds is", udp_await(&plant, 2000), 0);
    check_int("they are told", plant.hal.recv(&plant, &got), -HAL_FOREIGN);
    check_int("the command beside them is taken", plant.hal.recv(&plant, &got), 1);
    check_true("as it is", packet_same(&got, &packet_frame[0]));
    flush(&plant);
    hear();
    int stranger = open_stranger("127.0.0.1", 0);
    send_raw(stranger, plant.port, packet_golden, sizeof packet_golden);
    check_int("nor is a stranger's", udp_await(&plant, 2000), 1);
    check_int("who is known before the turn", plant.n_strangers, 1);
    check_int("the next recv reports them", plant.hal.recv(&plant, &got), -HAL_FOREIGN);
    close(stranger);
    check_int("no clock", plant.hal.now_us(&plant), 0);
    check_int("peer by its address", udp_find_peer(&plant, "127.0.0.1:1"), -1);
    char at[24];
    snprintf(at, sizeof at, "127.0.0.1:%u", bench.port);
    check_int("peer by its address", udp_find_peer(&plant, at), 0);
    udp_close(&bench);
    flush(&plant);
    check_int("a peer that has ended says nothing", udp_await(&plant, 2000), 1);
    check_true("and is known to have ended", plant.queue[0].refused);
    udp_close(&plant);
    struct udp_config c = {.local = "0", .peer = {"192.0.2.1:9"}, .n_peers = 1};
    check_no_error("opens without a route", udp_open(&plant, &c));
    check_contains("and has no lockstep", udp_begin_lockstep(&plant, 1), "route");
    udp_close(&plant);
}

/* 107 frames fill a packet; a packet that is full is never the last one of a bus frame. */
TEST(udp_lockstep_more)
{
    const struct frame f = {.id = 0x100, .length = 8};
    uint8_t big[CANNELLONI_PACKET_MAX + 1];
    open_lockstep();
    const struct {
        int frames;
        unsigned packets;
    } sent[] = {{0, 1}, {106, 1}, {107, 2}, {108, 2}, {250, 3}};
    for (size_t i = 0; i < sizeof sent / sizeof sent[0]; i++) {
        uint32_t before = plant.packets_sent;
        for (int k = 0; k < sent[i].frames; k++)
            give(&plant, &f, 1);
        flush(&plant);
        check_int("packets of a bus frame", plant.packets_sent - before, sent[i].packets);
        for (int k = 0; k < 10 && bench.packets_received < plant.packets_sent; k++)
            hear();
        check_int("heard as one", bench.answers, (int64_t)i + 1);
    }
    fill_packet(big); /* more than an app takes in a bus frame */
    send_raw(shared_socket(&bench), plant.port, big, CANNELLONI_PACKET_MAX);
    check_int("a word", udp_await(&plant, 2000), 0);
    struct frame got;
    int taken = 0;
    while (taken < 100 && plant.hal.recv(&plant, &got) == 1)
        taken++;
    check_int("an app takes some of its frames", taken, 100);
    flush(&plant);
    check_int("what is left of it is the next turn's", take_turn(), FULL_FRAMES - 100);
    check_int("and no other's", udp_await(&plant, 0), 1);
    sends_until_refused = 0;
    uint32_t before = plant.packets_sent;
    flush(&plant);
    check_above("a full kernel is waited for, but not for ever", plant.kernel_full, 100);
    sends_until_refused = -1;
    flush(&plant);
    check_int("then the packet goes", plant.packets_sent - before, 1);
    close_both();
}

/* Words that come before a wait sleeps: strangers are looked at now and then. */
TEST(udp_lockstep_soon)
{
    open_lockstep();
    int stranger = open_stranger("127.0.0.1", 0);
    for (int i = 0; i < 16; i++)
        say(packet_frame, 1);
    check_int("a first turn", take_turn(), 1);
    send_raw(stranger, plant.port, packet_golden, sizeof packet_golden);
    for (int i = 1; i < 16; i++)
        check_int("a turn", take_turn(), 1);
    check_int("none of them slept", plant.turns, 16);
    check_int("a stranger is not looked at in each", plant.n_strangers, 0);
    say(packet_frame, 1);
    check_int("but in the next", take_turn(), 1);
    check_int("and is known then", plant.n_strangers, 1);
    close(stranger);
    check_int("a look for a word in vain", udp_await(&plant, 1), 1);
    check_int("is not repeated for 64 waits", plant.rest, 64);
    say(packet_frame, 2);
    check_int("in which a word is heard, too", take_turn(), 2);
    check_int("of which this was one", plant.rest, 63);
    hear();
    uint16_t port = bench.port;
    udp_close(&bench);
    flush(&plant); /* refused: the next packet is told */
    char at[24], to[24];
    snprintf(at, sizeof at, "%u", port);
    snprintf(to, sizeof to, "127.0.0.1:%u", plant.port);
    struct udp_config c = {.local = at, .peer = {to}, .n_peers = 1};
    check_no_error("the bench begins anew", udp_open(&bench, &c));
    flush(&plant);
    struct frame got;
    (void)bench.hal.recv(&bench, &got);
    check_int("and gets the next packet", bench.packets_received, 1);
    check_int("none is unsent", plant.unsent, 0);
    close_both();
}

/* Two peers are awaited. Datagrams that the second sent before its own socket stood came to the open one. */
TEST(udp_lockstep_two)
{
    static struct udp third;
    open_three(&third);
    check_no_error("the plant awaits both", udp_begin_lockstep(&plant, 3));
    say(packet_frame, 1);
    check_int("one has spoken", udp_await(&plant, 2000), 2);
    close(plant.queue[1].socket);
    plant.queue[1].socket = -1;
    give(&third, packet_frame, 3);
    flush(&third);
    check_int("both have", udp_await(&plant, 2000), 0);
    check_int("the frames of both", take_turn(), 4);
    give(&third, packet_frame, 1);
    flush(&third);
    (void)udp_await(&plant, 2000);
    give(&third, packet_frame, 1);
    flush(&third);
    (void)udp_await(&plant, 2000);
    check_int("a second word there is not kept but counted", plant.dropped, 1);
    udp_close(&third);
    close_both();
}
