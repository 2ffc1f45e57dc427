/* udp.c - CAN frames in UDP packets by POSIX sockets; see udp.h. */
#include "hal/posix/udp.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>
#include "hal/posix/clock.h"

/* The queue of the socket that is open to all. */
static struct udp_queue *shared(struct udp *u)
{
    return &u->queue[UDP_PEERS];
}

/* --- receiving --------------------------------------------------------------------------------------------- */

static bool same_address(const struct sockaddr_in *a, const struct sockaddr_in *b)
{
    return a->sin_addr.s_addr == b->sin_addr.s_addr && a->sin_port == b->sin_port;
}

static bool among(const struct sockaddr_in *list, uint32_t n, const struct sockaddr_in *from)
{
    for (uint32_t i = 0; i < n; i++)
        if (same_address(&list[i], from))
            return true;
    return false;
}

static int take_stranger(struct udp *u, const struct sockaddr_in *from)
{
    u->foreign++;
    if (u->n_strangers < UDP_STRANGERS && !among(u->stranger, u->n_strangers, from))
        u->stranger[u->n_strangers++] = *from;
    return HAL_FOREIGN;
}

/* Datagrams the kernel dropped since the last packet of this queue, from its running count. Returns the fault bits. */
static int note_dropped(struct udp *u, struct udp_queue *q, struct msghdr *m)
{
    uint32_t seen = q->dropped_seen;
    for (struct cmsghdr *c = CMSG_FIRSTHDR(m); c; c = CMSG_NXTHDR(m, c))
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL)
            memcpy(&seen, CMSG_DATA(c), sizeof seen);
    uint32_t dropped = seen - q->dropped_seen;
    q->dropped_seen = seen;
    if (q == shared(u) && u->all_connected) { /* then these were nobody's */
        u->foreign += dropped;
        return 0;
    }
    u->dropped += dropped;
    return dropped ? HAL_DROPPED : 0;
}

/* Takes one datagram: its frames are in q->frame. Returns the hal_fault bits it gave, -1 when none waited. */
static int receive_packet(struct udp *u, struct udp_queue *q)
{
    uint8_t packet[CANNELLONI_PACKET_MAX];
    union {
        struct cmsghdr align;
        char bytes[CMSG_SPACE(sizeof(uint32_t))];
    } control;
    struct sockaddr_in from = {0};
    struct iovec data = {packet, sizeof packet};
    struct msghdr m = {.msg_name = &from, .msg_namelen = sizeof from, .msg_iov = &data, .msg_iovlen = 1};
    m.msg_control = &control;
    m.msg_controllen = sizeof control;
    q->taken++;
    ssize_t n = recvmsg(q->socket, &m, MSG_DONTWAIT);
    if (n < 0) {
        bool nothing = errno == EAGAIN || errno == EWOULDBLOCK;
        bool harmless = errno == ECONNREFUSED || errno == EINTR; /* a peer that is not up yet; a signal */
        return nothing ? -1 : harmless ? 0 : HAL_DOWN;
    }
    int fault = note_dropped(u, q, &m);
    if (!among(u->peer, u->n_peers, &from))
        return fault | take_stranger(u, &from);
    u->packets_received++;
    q->i_frame = 0;
    q->n_frames =
        m.msg_flags & MSG_TRUNC ? -1 : cannelloni_parse(packet, (size_t)n, q->frame, CANNELLONI_FRAMES_MAX);
    if (q->n_frames < 0) {
        q->n_frames = 0;
        u->malformed++;
        return fault | HAL_FOREIGN;
    }
    return fault;
}

static bool may_read(const struct udp *u, const struct udp_queue *q)
{
    bool strangers = q == &u->queue[UDP_PEERS] && u->all_connected;
    return !q->is_empty && q->taken < (strangers ? UDP_TURN_STRANGERS : UDP_TURN);
}

/* Reads until the queue has a frame to hand out, or no more in this turn. Returns the fault bits. */
static int refill(struct udp *u, struct udp_queue *q)
{
    int fault = 0;
    while (fault == 0 && q->i_frame == q->n_frames && may_read(u, q))
        fault = receive_packet(u, q);
    q->is_empty = q->is_empty || fault < 0;
    return fault > 0 ? fault : 0;
}

/* Which sockets have something, an error included. */
static void begin_turn(struct udp *u)
{
    struct pollfd p[UDP_QUEUES];
    for (int i = 0; i < UDP_QUEUES; i++)
        p[i] = (struct pollfd){.fd = u->queue[i].socket, .events = POLLIN};
    bool known = poll(p, UDP_QUEUES, 0) >= 0;
    for (int i = 0; i < UDP_QUEUES; i++) {
        u->queue[i].taken = 0;
        u->queue[i].is_empty = u->queue[i].socket < 0 || (known && !p[i].revents);
    }
    u->turn_begins = false;
}

static int receive(void *context, struct frame *f)
{
    struct udp *u = context;
    int fault = u->send_fault;
    u->send_fault = 0;
    if (u->turn_begins)
        begin_turn(u);
    for (int i = 0; i < UDP_QUEUES && !fault; i++) {
        struct udp_queue *q = &u->queue[u->i_queue];
        u->i_queue = (u->i_queue + 1) % UDP_QUEUES;
        fault = refill(u, q);
        if (!fault && q->i_frame < q->n_frames) {
            *f = q->frame[q->i_frame++];
            return 1;
        }
    }
    u->turn_begins = !fault;
    return -fault;
}

/* --- sending ----------------------------------------------------------------------------------------------- */

/* Sends the packet to the peers that still have to get it; true when it is gone. */
static bool transmit_packet(struct udp *u)
{
    struct iovec data = {u->packet.bytes, u->packet.n_bytes};
    struct mmsghdr m[UDP_PEERS] = {{{0}, 0}};
    for (uint32_t i = 0; i < u->n_peers; i++) {
        m[i].msg_hdr.msg_name = &u->peer[i];
        m[i].msg_hdr.msg_namelen = sizeof u->peer[i];
        m[i].msg_hdr.msg_iov = &data;
        m[i].msg_hdr.msg_iovlen = 1;
    }
    while (u->i_peer < u->n_peers) { /* every turn but an EAGAIN, which leaves, gets past a peer */
        int sent = sendmmsg(shared(u)->socket, m + u->i_peer, u->n_peers - u->i_peer, MSG_DONTWAIT);
        if (sent > 0) {
            u->i_peer += (uint32_t)sent;
        } else if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
            u->kernel_full++;
            return false;
        } else {
            u->unsent++;
            u->send_fault |= HAL_UNSENT;
            u->peer_error[u->i_peer++] = errno;
        }
    }
    u->packets_sent++;
    u->i_peer = 0;
    cannelloni_next(&u->packet);
    return true;
}

/* A packet of which some peers have a copy must not grow. */
static int append(void *context, const struct frame *f)
{
    struct udp *u = context;
    bool full = !cannelloni_has_room(&u->packet, f);
    if ((full || u->i_peer) && !transmit_packet(u))
        return 0;
    cannelloni_add(&u->packet, f);
    return 1;
}

static void flush(void *context)
{
    struct udp *u = context;
    u->turn_begins = true;
    if (u->packet.n_frames)
        (void)transmit_packet(u); /* refused: the packet stays, the next send or flush tries again */
}

/* --- opening ----------------------------------------------------------------------------------------------- */

/* "port" on loopback or "a.b.c.d:port". */
static bool parse_address(const char *text, struct sockaddr_in *out)
{
    char host[INET_ADDRSTRLEN] = "127.0.0.1";
    const char *colon = strchr(text, ':');
    const char *port = colon ? colon + 1 : text;
    size_t n_host = colon ? (size_t)(colon - text) : 0;
    if (n_host >= sizeof host || (colon && !n_host) || strspn(port, "0123456789") != strlen(port))
        return false;
    if (colon) {
        memcpy(host, text, n_host);
        host[n_host] = 0;
    }
    unsigned long number = strtoul(port, NULL, 10);
    *out = (struct sockaddr_in){.sin_family = AF_INET, .sin_port = htons((uint16_t)number)};
    return *port && number <= 65535 && inet_pton(AF_INET, host, &out->sin_addr) == 1;
}

static const char *parse_peers(struct udp *u, const struct udp_config *c)
{
    if (c->n_peers < 1 || c->n_peers > UDP_PEERS) {
        snprintf(u->reason, sizeof u->reason, "udp: %u peers given, 1 to %d are possible", c->n_peers,
                 UDP_PEERS);
        return u->reason;
    }
    for (u->n_peers = 0; u->n_peers < c->n_peers; u->n_peers++) {
        const char *text = c->peer[u->n_peers];
        if (!parse_address(text, &u->peer[u->n_peers]) || !u->peer[u->n_peers].sin_port) {
            snprintf(u->reason, sizeof u->reason,
                     "udp: peer \"%s\" is not PORT or A.B.C.D:PORT, port 1 to 65535", text);
            return u->reason;
        }
    }
    return NULL;
}

static const char *bind_reason(int error)
{
    switch (error) {
    case EADDRINUSE:
        return "is in use: stop the program that has it, or choose another port";
    case EADDRNOTAVAIL:
        return "is no address of this machine: `ip address` lists those there are";
    case EACCES:
        return "needs privileges: choose a port above 1023";
    default:
        return strerror(error);
    }
}

/* More than the system's limit where we may (root), else as much as it grants. */
static void set_receive_buffer(int socket, int bytes)
{
    if (setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0)
        setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

static void set_reuse(int socket, int on)
{
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
}

static int open_socket(void)
{
    int on = 1, fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd >= 0)
        setsockopt(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
    return fd;
}

/* A socket on our address that hears this peer only; -1 when it cannot be had. */
static int connect_socket(const struct sockaddr_in *bound, const struct sockaddr_in *peer)
{
    int fd = open_socket();
    if (fd < 0)
        return -1;
    set_reuse(fd, 1);
    set_receive_buffer(fd, UDP_BUFFER);
    if (bind(fd, (const struct sockaddr *)bound, sizeof *bound) == 0 &&
        connect(fd, (const struct sockaddr *)peer, sizeof *peer) == 0)
        return fd;
    close(fd);
    return -1;
}

/* The sockets share an address, which they must allow each other while they are bound. Nobody else is let in: on UDP a
 * second program would take our datagrams. */
static void connect_peers(struct udp *u, const struct sockaddr_in *bound)
{
    u->all_connected = true;
    set_reuse(shared(u)->socket, 1);
    for (uint32_t i = 0; i < u->n_peers; i++) {
        u->queue[i].socket = connect_socket(bound, &u->peer[i]);
        u->all_connected = u->all_connected && u->queue[i].socket >= 0;
    }
    for (int i = 0; i < UDP_QUEUES; i++)
        if (u->queue[i].socket >= 0)
            set_reuse(u->queue[i].socket, 0);
}

static const char *open_sockets(struct udp *u, const struct sockaddr_in *local, const char *text)
{
    int bytes = UDP_BUFFER;
    struct sockaddr_in bound;
    socklen_t length = sizeof bound;
    struct udp_queue *q = shared(u);
    q->socket = open_socket();
    if (q->socket < 0 || bind(q->socket, (const struct sockaddr *)local, sizeof *local) != 0) {
        snprintf(u->reason, sizeof u->reason, "udp: %s %s", text, bind_reason(errno));
        udp_close(u);
        return u->reason;
    }
    getsockname(q->socket, (struct sockaddr *)&bound, &length);
    u->port = ntohs(bound.sin_port);
    connect_peers(u, &bound);
    set_receive_buffer(q->socket, u->all_connected ? UDP_BUFFER_STRANGERS : UDP_BUFFER);
    setsockopt(q->socket, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
    length = sizeof u->receive_bytes;
    getsockopt(u->all_connected ? u->queue[0].socket : q->socket, SOL_SOCKET, SO_RCVBUF, &u->receive_bytes,
               &length);
    getsockopt(q->socket, SOL_SOCKET, SO_SNDBUF, &u->send_bytes, &length);
    return NULL;
}

const char *udp_open(struct udp *u, const struct udp_config *c)
{
    struct sockaddr_in local;
    memset(u, 0, sizeof *u);
    for (int i = 0; i < UDP_QUEUES; i++)
        u->queue[i].socket = -1;
    u->turn_begins = true;
    cannelloni_begin(&u->packet, 0);
    u->hal = (struct hal){u, receive, append, flush, clock_now_us, clock_no_watchdog};
    if (!parse_address(c->local, &local)) {
        snprintf(u->reason, sizeof u->reason, "udp: address \"%s\" is not PORT or A.B.C.D:PORT", c->local);
        return u->reason;
    }
    const char *reason = parse_peers(u, c);
    return reason ? reason : open_sockets(u, &local, c->local);
}

void udp_close(struct udp *u)
{
    for (int i = 0; i < UDP_QUEUES; i++) {
        if (u->queue[i].socket >= 0)
            close(u->queue[i].socket);
        u->queue[i].socket = -1;
    }
}
