#include "hal/udp.h"

#include <arpa/inet.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>
#include "hal/clock.h"

enum {
    RECEIVE_TRIES = 16 /* packets without a frame, and pending errors, that one recv passes over */
};

/* --- receiving --------------------------------------------------------------------------------------------- */

static bool listed(const struct udp *u, const struct sockaddr_in *from)
{
    for (uint32_t i = 0; i < u->n_peers; i++)
        if (from->sin_addr.s_addr == u->peer[i].sin_addr.s_addr && from->sin_port == u->peer[i].sin_port)
            return true;
    return false;
}

/* Datagrams the kernel dropped since the last packet, from its running count. */
static uint32_t newly_dropped(struct udp *u, struct msghdr *m)
{
    uint32_t seen = u->dropped_seen;
    for (struct cmsghdr *c = CMSG_FIRSTHDR(m); c; c = CMSG_NXTHDR(m, c))
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_RXQ_OVFL)
            memcpy(&seen, CMSG_DATA(c), sizeof seen);
    uint32_t dropped = seen - u->dropped_seen;
    u->dropped_seen = seen;
    return dropped;
}

/* Takes one datagram: its frames are in u->frame. Returns the hal_fault bits it gave, -1 when none waited. */
static int receive_packet(struct udp *u)
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
    ssize_t n = recvmsg(u->socket, &m, MSG_DONTWAIT);
    if (n < 0) {
        bool nothing = errno == EAGAIN || errno == EWOULDBLOCK;
        bool harmless = errno == ECONNREFUSED || errno == EINTR; /* a peer that is not up yet; a signal */
        return nothing ? -1 : harmless ? 0 : HAL_DOWN;
    }
    uint32_t dropped = newly_dropped(u, &m);
    int fault = dropped ? HAL_DROPPED : 0;
    u->dropped += dropped;
    if (!listed(u, &from)) {
        u->foreign++;
        return fault | HAL_FOREIGN;
    }
    u->packets_received++;
    u->i_frame = 0;
    u->n_frames =
        m.msg_flags & MSG_TRUNC ? -1 : cannelloni_parse(packet, (size_t)n, u->frame, CANNELLONI_FRAMES_MAX);
    if (u->n_frames < 0) {
        u->n_frames = 0;
        u->malformed++;
        return fault | HAL_FOREIGN;
    }
    return fault;
}

static int receive(void *context, struct frame *f)
{
    struct udp *u = context;
    for (int i = 0; i < RECEIVE_TRIES && u->i_frame == u->n_frames; i++) {
        int fault = receive_packet(u);
        if (fault)
            return fault < 0 ? 0 : -fault;
    }
    if (u->i_frame == u->n_frames)
        return 0;
    *f = u->frame[u->i_frame++];
    return 1;
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
        int sent = sendmmsg(u->socket, m + u->i_peer, u->n_peers - u->i_peer, MSG_DONTWAIT);
        if (sent > 0) {
            u->i_peer += (uint32_t)sent;
        } else if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
            u->kernel_full++;
            return false;
        } else {
            u->unsent++;
            u->i_peer++;
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

static const char *open_socket(struct udp *u, const struct sockaddr_in *local, const char *text)
{
    int on = 1, bytes = UDP_BUFFER;
    struct sockaddr_in bound;
    socklen_t length = sizeof bound;
    u->socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    /* No SO_REUSEADDR: on UDP it would let a second program take our datagrams. */
    if (u->socket < 0 || bind(u->socket, (const struct sockaddr *)local, sizeof *local) != 0) {
        snprintf(u->reason, sizeof u->reason, "udp: %s %s", text, bind_reason(errno));
        udp_close(u);
        return u->reason;
    }
    getsockname(u->socket, (struct sockaddr *)&bound, &length);
    u->port = ntohs(bound.sin_port);
    setsockopt(u->socket, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
    setsockopt(u->socket, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    setsockopt(u->socket, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
    length = sizeof u->receive_bytes;
    getsockopt(u->socket, SOL_SOCKET, SO_RCVBUF, &u->receive_bytes, &length);
    getsockopt(u->socket, SOL_SOCKET, SO_SNDBUF, &u->send_bytes, &length);
    return NULL;
}

const char *udp_open(struct udp *u, const struct udp_config *c)
{
    struct sockaddr_in local;
    memset(u, 0, sizeof *u);
    u->socket = -1;
    cannelloni_begin(&u->packet, 0);
    u->hal = (struct hal){u, receive, append, flush, clock_now_us, clock_no_watchdog};
    if (!parse_address(c->local, &local)) {
        snprintf(u->reason, sizeof u->reason, "udp: address \"%s\" is not PORT or A.B.C.D:PORT", c->local);
        return u->reason;
    }
    const char *reason = parse_peers(u, c);
    return reason ? reason : open_socket(u, &local, c->local);
}

void udp_close(struct udp *u)
{
    if (u->socket >= 0)
        close(u->socket);
    u->socket = -1;
}
