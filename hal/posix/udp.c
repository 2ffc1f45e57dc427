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

enum {
    UDP_ALL = (1 << UDP_QUEUES) - 1, /* every queue */
    REFUSED_PACKETS = 64,            /* in lockstep, one of so many goes to a peer whose port is closed */
    SEND_TRIES = 100,                /* waits for room, in lockstep */
    SEND_WAIT_MS = 100,
    WORD_TRIES = 64,     /* looks for a word before a wait sleeps */
    WORD_REST = 64,      /* waits that sleep at once, after looks in vain */
    STRANGER_TURNS = 16, /* turns without a sleep, from one look for strangers to the next */
};

/* The queue of the socket that is open to all. */
static struct udp_queue *shared(struct udp *u)
{
    return &u->queue[UDP_PEERS];
}

/* ---- receiving ---- */

static bool same_address(const struct sockaddr_in *a, const struct sockaddr_in *b)
{
    return a->sin_addr.s_addr == b->sin_addr.s_addr && a->sin_port == b->sin_port;
}

/* Where it is in the list; -1: nowhere. */
static int find(const struct sockaddr_in *list, uint32_t n, const struct sockaddr_in *from)
{
    for (uint32_t i = 0; i < n; i++)
        if (same_address(&list[i], from))
            return (int)i;
    return -1;
}

static int take_stranger(struct udp *u, const struct sockaddr_in *from)
{
    u->foreign++;
    if (u->n_strangers < UDP_STRANGERS && find(u->stranger, u->n_strangers, from) < 0)
        u->stranger[u->n_strangers++] = *from;
    return HAL_FOREIGN;
}

/* Datagrams the kernel dropped since the last packet of this queue, from its running count. Returns the
 * fault bits. */
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
    q->sender = -1;
    q->taken++;
    ssize_t n = recvmsg(q->socket, &m, MSG_DONTWAIT);
    if (n < 0) {
        bool nothing = errno == EAGAIN || errno == EWOULDBLOCK;
        bool harmless = errno == ECONNREFUSED || errno == EINTR; /* a peer that is not up yet; a signal */
        q->refused = q->refused || errno == ECONNREFUSED;
        return nothing ? -1 : harmless ? 0 : HAL_DOWN;
    }
    int fault = note_dropped(u, q, &m), peer = find(u->peer, u->n_peers, &from);
    if (peer < 0)
        return fault | take_stranger(u, &from);
    u->packets_received++;
    q->refused = false;
    q->i_frame = 0;
    uint32_t before = u->passed_over;
    q->n_frames = m.msg_flags & MSG_TRUNC
                      ? -1
                      : cannelloni_parse(packet, (size_t)n, q->frame, CANNELLONI_FRAMES_MAX, &u->passed_over);
    if (q->n_frames < 0) {
        q->n_frames = 0;
        u->malformed++;
        u->peer_malformed[peer] = true;
        return fault | HAL_FOREIGN;
    }
    if (u->passed_over != before) {
        u->peer_passed_over[peer] = true;
        fault |= HAL_FOREIGN;
    }
    q->sender = peer;
    if (n < CANNELLONI_MORE) {
        u->answers++;
        u->unanswered -= u->unanswered > 0;
        q->is_empty = u->lockstep && !u->awaited && !u->unanswered; /* the plant has no more to say */
    }
    return fault;
}

/* In lockstep: the queue of a peer whose words begin the turns. */
static bool is_awaited(const struct udp *u, const struct udp_queue *q)
{
    return u->awaited >> (q - u->queue) & 1u;
}

static bool may_read(const struct udp *u, const struct udp_queue *q)
{
    bool strangers = q == &u->queue[UDP_PEERS] && u->all_connected;
    return q->socket >= 0 && !q->is_empty && !is_awaited(u, q) &&
           q->taken < (strangers ? UDP_TURN_STRANGERS : UDP_TURN);
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

/* Which sockets have something, an error included, after a wait of `ms` at most for one of those in
 * `heard` (bits). The others are as they were. A turn begins. */
static void look(struct udp *u, uint32_t heard, int ms)
{
    struct pollfd p[UDP_QUEUES];
    for (int i = 0; i < UDP_QUEUES; i++)
        p[i] = (struct pollfd){.fd = heard >> i & 1u ? u->queue[i].socket : -1, .events = POLLIN};
    bool known = poll(p, UDP_QUEUES, ms) >= 0;
    for (int i = 0; i < UDP_QUEUES; i++) {
        u->queue[i].taken = 0;
        if (heard >> i & 1u)
            u->queue[i].is_empty = known && !p[i].revents;
    }
    u->turn_begins = false;
}

static int receive(void *context, struct frame *f)
{
    struct udp *u = context;
    int fault = u->fault;
    u->fault = 0;
    if (u->turn_begins)
        look(u, UDP_ALL, 0);
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

/* ---- sending ---- */

/* The queue whose socket sends: in lockstep that of a sole peer, which is connected. */
static struct udp_queue *sender(struct udp *u)
{
    return u->lockstep && u->n_to == 1 ? &u->queue[u->to[0]] : shared(u);
}

/* True when the kernel has room again; outside of lockstep nobody waits for it. */
static bool wait_for_room(struct udp *u, int *tries)
{
    struct pollfd p = {.fd = sender(u)->socket, .events = POLLOUT};
    u->kernel_full++;
    return u->lockstep && (*tries)++ < SEND_TRIES && poll(&p, 1, SEND_WAIT_MS) >= 0;
}

/* Who gets the packet that begins to be sent. A closed port costs as much as three open ones, so a plant
 * in lockstep tries it now and then. */
static void choose_peers(struct udp *u)
{
    u->n_to = 0;
    for (uint32_t i = 0; i < u->n_peers; i++) {
        struct udp_queue *q = &u->queue[i];
        bool closed = u->awaited && q->refused; /* the word of one that is awaited has opened it again */
        if (closed && u->packets_sent % REFUSED_PACKETS)
            continue;
        q->refused = q->refused && !closed;
        u->to[u->n_to++] = (uint8_t)i;
    }
}

/* Sends the packet to the peers that still have to get it; true when it is gone. */
static bool transmit_packet(struct udp *u)
{
    struct iovec data = {u->packet.bytes, u->packet.n_bytes};
    struct mmsghdr m[UDP_PEERS] = {{{0}, 0}};
    if (u->i_peer == 0)
        choose_peers(u);
    struct udp_queue *q = sender(u);
    for (uint32_t i = 0; i < u->n_to; i++) {
        m[i].msg_hdr.msg_name = q == shared(u) ? &u->peer[u->to[i]] : NULL;
        m[i].msg_hdr.msg_namelen = q == shared(u) ? sizeof u->peer[0] : 0;
        m[i].msg_hdr.msg_iov = &data;
        m[i].msg_hdr.msg_iovlen = 1;
    }
    int tries = 0;
    while (u->i_peer < u->n_to) { /* every turn but an EAGAIN, which leaves in the end, gets past a peer */
        int sent = sendmmsg(q->socket, m + u->i_peer, u->n_to - u->i_peer, MSG_DONTWAIT);
        if (sent > 0) {
            u->i_peer += (uint32_t)sent;
        } else if (errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) {
            if (!wait_for_room(u, &tries))
                return false;
        } else if (errno == ECONNREFUSED && q != shared(u) && tries++ < SEND_TRIES) {
            q->refused = true; /* news of a packet before this one */
        } else {
            u->unsent++;
            u->fault |= HAL_UNSENT;
            u->peer_error[u->to[u->i_peer++]] = errno;
        }
    }
    u->packets_sent++;
    u->unanswered += u->lockstep;
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
    if (u->packet.n_frames || u->lockstep)
        (void)transmit_packet(u); /* refused: the packet stays, the next send or flush tries again */
}

/* ---- lockstep ---- */

/* A packet that says that more follows is followed by one more, an empty one. An app takes so many frames
 * at a time only: the rest of a word is the next turn's. */
static void flush_in_lockstep(void *context)
{
    struct udp *u = context;
    if (u->packet.n_bytes >= CANNELLONI_MORE)
        (void)transmit_packet(u);
    flush(u);
    for (uint32_t i = 0; i < u->n_peers; i++)
        u->queue[i].said = u->queue[i].i_frame < u->queue[i].n_frames;
    u->i_queue = 0;
}

static uint32_t stand(void *context)
{
    (void)context;
    return 0;
}

const char *udp_begin_lockstep(struct udp *u, uint32_t awaited)
{
    if (!u->all_connected) {
        snprintf(u->reason, sizeof u->reason,
                 "udp: lockstep needs a route to each peer; see their addresses");
        return u->reason;
    }
    u->lockstep = true;
    u->awaited = awaited;
    u->hal.flush = flush_in_lockstep;
    u->hal.now_us = stand;
    return NULL;
}

/* One datagram of this queue. Datagrams that a peer sent before its own socket stood came to another one. */
static void take_word(struct udp *u, struct udp_queue *q)
{
    int fault = receive_packet(u, q);
    u->fault |= fault > 0 ? fault : 0;
    if (fault < 0 || q->sender < 0)
        return;
    struct udp_queue *own = &u->queue[q->sender];
    if (own != q) {
        bool lost = own->said || own->i_frame < own->n_frames; /* there is room for one */
        u->dropped += lost;
        u->fault |= lost ? HAL_DROPPED : 0;
        memcpy(own->frame, q->frame, sizeof own->frame);
        own->n_frames = q->n_frames;
        own->i_frame = q->i_frame = q->n_frames = 0;
    }
    own->said = true;
}

static uint32_t owing(const struct udp *u)
{
    uint32_t bits = 0;
    for (uint32_t i = 0; i < u->n_peers; i++)
        bits |= u->awaited & (uint32_t)!u->queue[i].said << i;
    return bits;
}

/* True: every word has come before a sleep. */
static bool come_soon(struct udp *u)
{
    uint32_t tries = u->rest ? 0 : WORD_TRIES, words = owing(u);
    for (; words && tries; tries--, words = owing(u))
        for (uint32_t i = 0; i < u->n_peers; i++)
            if (words >> i & 1u)
                take_word(u, &u->queue[i]);
    u->rest = u->rest ? u->rest - 1 : words ? WORD_REST : 0;
    return !words;
}

/* A turn whose words are here: looks at the other peers, and at strangers now and then. */
static void begin_turn(struct udp *u, uint32_t others)
{
    if (u->turns++ % STRANGER_TURNS == 0)
        others |= 1u << UDP_PEERS;
    else
        u->queue[UDP_PEERS].is_empty = true;
    if (others) {
        look(u, others, 0);
        return;
    }
    for (int i = 0; i < UDP_QUEUES; i++)
        u->queue[i].taken = 0;
    u->turn_begins = false;
}

/* Those that are not awaited are left to recv, but looked at once a turn, which saves recv a look of its
 * own. */
uint32_t udp_await(struct udp *u, int ms)
{
    uint32_t words = owing(u), others = 0;
    if (!words)
        return 0;
    for (uint32_t i = 0; i < u->n_peers; i++)
        others |= (uint32_t)(!is_awaited(u, &u->queue[i]) && (u->turn_begins || u->queue[i].is_empty)) << i;
    words |= 1u << UDP_PEERS; /* strangers are reported while they wait */
    if (ms && come_soon(u)) {
        begin_turn(u, others);
        return 0;
    }
    look(u, words | others, ms);
    for (int i = 0; i < UDP_QUEUES; i++)
        if (words >> i & 1u && !u->queue[i].is_empty)
            take_word(u, &u->queue[i]);
    return owing(u);
}

void udp_wait(struct udp *u, int ms)
{
    look(u, UDP_ALL, ms);
}

/* ---- opening ---- */

bool udp_address(const char *text, struct sockaddr_in *out)
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
    return *port && number <= 65535 &&
           inet_pton(AF_INET, strcmp(host, "localhost") ? host : "127.0.0.1", &out->sin_addr) == 1;
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
        if (!udp_address(text, &u->peer[u->n_peers]) || !u->peer[u->n_peers].sin_port) {
            snprintf(u->reason, sizeof u->reason,
                     "udp: peer \"%s\" is not PORT, A.B.C.D:PORT or localhost:PORT, port 1 to 65535", text);
            return u->reason;
        }
    }
    return NULL;
}

int udp_find_peer(const struct udp *u, const char *text)
{
    struct sockaddr_in at;
    return udp_address(text, &at) ? find(u->peer, u->n_peers, &at) : -1;
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
    int fd = open_socket(), bytes = UDP_BUFFER;
    if (fd < 0)
        return -1;
    set_reuse(fd, 1);
    set_receive_buffer(fd, UDP_BUFFER);
    setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
    if (bind(fd, (const struct sockaddr *)bound, sizeof *bound) == 0 &&
        connect(fd, (const struct sockaddr *)peer, sizeof *peer) == 0)
        return fd;
    close(fd);
    return -1;
}

/* The sockets share an address, which they must allow each other while they are bound. Nobody else is let
 * in: on UDP a second program would take our datagrams. */
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
    if (!udp_address(c->local, &local)) {
        snprintf(u->reason, sizeof u->reason,
                 "udp: address \"%s\" is not PORT, A.B.C.D:PORT or localhost:PORT", c->local);
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
