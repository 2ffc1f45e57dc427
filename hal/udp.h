/* udp.h - CAN frames in UDP packets of the cannelloni format (hal/cannelloni.h) by a POSIX socket. A malformed packet is
 * refused whole and counted.
 *
 * Who may speak: datagrams of the listed peers, address and port both equal. Any other is dropped, reported as
 * HAL_FOREIGN and never answered. Everything sent goes to all peers.
 *
 * Cost: recv makes one system call when nothing waits and one per packet otherwise; send makes none until the packet
 * is full; flush makes one, whatever the number of peers. No call blocks. */
#ifndef HAL_UDP_H
#define HAL_UDP_H

#include <netinet/in.h>
#include <stdint.h>
#include "hal/cannelloni.h"
#include "hal/hal.h"

enum {
    UDP_PEERS = 4,
    UDP_BUFFER = 1 << 20 /* socket buffers asked for: a second of full telemetry; the kernel may grant less */
};

struct udp_config {
    const char *local;           /* "20000" (on 127.0.0.1) or "192.0.2.7:20000"; port 0: the kernel chooses */
    const char *peer[UDP_PEERS]; /* the same forms, port not 0 */
    uint32_t n_peers;            /* 1..UDP_PEERS */
};

/* Counters run since udp_open. Read them freely; only the hal writes. */
struct udp {
    struct hal hal; /* give this to an app or a client */
    int socket;
    uint16_t port;                 /* bound to, host order */
    int receive_bytes, send_bytes; /* socket buffers granted */
    struct sockaddr_in peer[UDP_PEERS];
    uint32_t n_peers;

    struct frame frame[CANNELLONI_FRAMES_MAX]; /* the packet being handed out */
    int n_frames, i_frame;

    struct cannelloni packet; /* being filled */
    uint32_t i_peer;          /* first peer that still has to get it; > 0 only after a refused send */

    uint32_t packets_received, packets_sent;
    uint32_t foreign;   /* datagrams of senders that are not listed */
    uint32_t malformed; /* datagrams of peers that were refused; reported as HAL_FOREIGN too */
    uint32_t dropped;   /* datagrams lost in the kernel's receive queue (SO_RXQ_OVFL): HAL_DROPPED */
    uint32_t
        kernel_full; /* sends refused with EAGAIN or ENOBUFS: the packet is kept, send returns 0 meanwhile */
    uint32_t unsent; /* packets a peer did not get for another reason, e.g. no route: not repeated */
    uint32_t dropped_seen; /* the kernel's count at the last packet */
    char reason[160];      /* text returned by udp_open */
};

/* NULL, or the reason with what to do about it (then nothing is open). *u must stay where it is. */
const char *udp_open(struct udp *u, const struct udp_config *c);

void udp_close(struct udp *u);

#endif
