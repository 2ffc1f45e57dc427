/* udp.h - CAN frames in UDP packets of the cannelloni format (hal/link/cannelloni.h) by a POSIX socket. A
 * malformed packet is refused whole and counted. Frames in a packet that are no classic data frames are
 * passed over and counted; each packet with such is reported as HAL_FOREIGN once, and its other frames are
 * taken.
 *
 * Who may speak: datagrams of the listed peers, address and port both equal. Any other is dropped,
 * reported as HAL_FOREIGN and never answered; the first few strangers are remembered. Everything sent goes
 * to all peers.
 *
 * FLOODS. Each peer has a socket of its own, connected to it. So the kernel keeps its datagrams in a queue
 * of their own, and datagrams of others take none of their room. Frames are handed out in turn, one of
 * each peer, in each peer's own order. Datagrams that belong to no peer's socket come to the socket that
 * is open to all, whose queue is short. Where a peer cannot be connected to (no route to it yet), its
 * datagrams come there too, and the queue is long. A turn ends when recv says that nothing waits, or with
 * a flush. It takes at most UDP_TURN datagrams of a peer, and UDP_TURN_STRANGERS of strangers; those of
 * strangers that the kernel drops count as foreign.
 *
 * LOCKSTEP. After udp_begin_lockstep time is what the datagrams say:
 * - A turn takes one datagram of each peer that is awaited: its word, which udp_await has read. A malformed
 *   one is no word.
 * - Each flush sends a packet, an empty one too. It ends with a packet below CANNELLONI_MORE bytes; a
 *   longer one says that more follows. So a peer knows where a bus frame ends, and this end counts what it
 *   was not yet answered to.
 * - udp_await asks for a word some 64 times (20 us) before it sleeps: a peer on another processor answers
 *   sooner than a sleeper wakes. Where that was in vain, as on one processor, it sleeps at once in the next
 *   64 waits. While words come so soon, strangers are looked at in each 16th turn.
 * - Where one peer gets all that is sent, its own socket sends it, which knows the route.
 * - send waits while the kernel has no room, and now_us stands. A peer that is not awaited and has its port
 *   closed gets one packet of 64.
 *
 * Cost: recv makes one system call when nothing waits, and one per packet and one per peer that has sent
 * otherwise. send makes none until the packet is full. flush makes one, whatever the number of peers. No
 * call blocks but udp_await, udp_wait, and send in lockstep. */
#ifndef HAL_UDP_H
#define HAL_UDP_H

#include <netinet/in.h>
#include <stdbool.h>
#include <stdint.h>
#include "hal/link/cannelloni.h"
#include "hal/hal.h"

enum {
    UDP_PEERS = 4,
    UDP_QUEUES = UDP_PEERS + 1, /* one of each peer, and the one that is open to all */
    UDP_BUFFER = 4 << 20, /* socket buffers asked for: seconds of full telemetry; the kernel may grant less */
    UDP_BUFFER_STRANGERS = 1 << 14,
    UDP_TURN = 512,
    UDP_TURN_STRANGERS = 16,
    UDP_STRANGERS = 4 /* that are remembered */
};

struct udp_config {
    const char *local;           /* "20000" (on 127.0.0.1) or "192.0.2.7:20000"; port 0: the kernel chooses */
    const char *peer[UDP_PEERS]; /* in the forms of `local`, port not 0 */
    uint32_t n_peers;            /* 1..UDP_PEERS */
};

/* Datagrams that wait in one socket. */
struct udp_queue {
    int socket;                                /* -1: none */
    struct frame frame[CANNELLONI_FRAMES_MAX]; /* the packet being handed out */
    int n_frames, i_frame;
    uint32_t taken;        /* datagrams in this turn, and looks at an empty queue */
    bool is_empty;         /* nothing waited any more in this turn */
    uint32_t dropped_seen; /* the kernel's count at the last packet */
    int sender;            /* peer of the packet; -1: a stranger's, or malformed */
    bool refused;          /* the last news of the peer: its port is closed */
    bool said;             /* in lockstep: its word of this turn is here */
};

/* Counters run since udp_open. Read them freely; only the hal writes. */
struct udp {
    struct hal hal;                /* give this to an app or a client */
    uint16_t port;                 /* bound to, host order */
    int receive_bytes, send_bytes; /* socket buffers granted: of a peer, of all that is sent */
    struct sockaddr_in peer[UDP_PEERS];
    uint32_t n_peers;

    struct udp_queue queue[UDP_QUEUES]; /* one per peer; the last one is open to all, and sends */
    bool all_connected;                 /* each peer has a socket of its own */
    bool turn_begins;
    uint32_t i_queue; /* whose turn it is to hand out a frame */

    struct sockaddr_in stranger[UDP_STRANGERS]; /* the first that are not listed */
    uint32_t n_strangers;

    bool lockstep;
    uint32_t awaited;    /* bit i: peer i has a word to say before each turn */
    uint32_t unanswered; /* packets sent, less the peers' flushes that were heard whole */
    uint32_t answers;    /* those flushes, since udp_open */
    uint32_t turns;      /* that began without a sleep */
    uint32_t rest;       /* waits to come that sleep at once */

    struct cannelloni packet; /* being filled */
    uint8_t to[UDP_PEERS];    /* the peers that get it */
    uint32_t n_to,
        i_peer; /* how many, and the first that still has to get it; > 0 only after a refused send */

    uint32_t packets_received, packets_sent;
    uint32_t foreign;          /* datagrams of senders that are not listed */
    uint32_t malformed;        /* datagrams of peers that were refused; reported as HAL_FOREIGN too */
    uint32_t passed_over;      /* frames of peers that are no classic data frames */
    uint32_t dropped;          /* datagrams lost in the kernel's receive queue (SO_RXQ_OVFL): HAL_DROPPED */
    uint32_t kernel_full;      /* sends refused with EAGAIN or ENOBUFS: the packet is kept, send returns 0 */
    uint32_t unsent;           /* packets a peer did not get for another reason, e.g. no route: HAL_UNSENT */
    int peer_error[UDP_PEERS]; /* that reason, an errno; 0: none so far */
    bool peer_malformed[UDP_PEERS];   /* it sent a datagram that was refused */
    bool peer_passed_over[UDP_PEERS]; /* it sent a frame that was passed over */
    int fault;                        /* hal_fault bits met outside of recv, for the next recv */
    char reason[160];                 /* text returned by udp_open */
};

/* Opens the sockets. Returns NULL, or the reason and what to do about it; then nothing is open. *u must
 * stay where it is until udp_close. */
const char *udp_open(struct udp *u, const struct udp_config *c);

void udp_close(struct udp *u);

/* "PORT" on this machine, "A.B.C.D:PORT" or "localhost:PORT", PORT 0 to 65535. False: none of them. */
bool udp_address(const char *text, struct sockaddr_in *out);

/* The peer with this address, written as in udp_config; -1: none. */
int udp_find_peer(const struct udp *u, const char *text);

/* Goes over to lockstep. Bit i of `awaited`: wait for peer i before each turn; 0: this end is the one that
 * is awaited. Returns NULL, or the reason. */
const char *udp_begin_lockstep(struct udp *u, uint32_t awaited);

/* Waits for words for at most `ms` milliseconds, and less when something else comes. Returns the peers
 * whose word is missing, as bits; 0: the turn may begin. */
uint32_t udp_await(struct udp *u, int ms);

/* Waits until recv may have something to take, for at most `ms` milliseconds. */
void udp_wait(struct udp *u, int ms);

#endif
