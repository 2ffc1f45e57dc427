/* net.h - the plant's bus on a board's own Ethernet: cannelloni packets in UDP over IPv4, without an
 * operating system.
 *
 * The rules are those of hal/posix/udp.h. Only datagrams of listed peers, address and port both equal, are
 * taken. Any other is dropped, reported as HAL_FOREIGN and never answered. A malformed packet is refused
 * whole; frames in a packet that no plant takes are passed over, counted and reported as HAL_FOREIGN.
 * Everything sent goes to all peers. Peers stand on the same wire: there is no gateway.
 *
 * The plant asks for a peer's Ethernet address by ARP, and takes over each new one that the peer tells.
 * Packets for a peer before that are counted as unresolved. Refused frames are counted by the verdict of
 * hal/ethernet/ipv4.h. Wrong checksums, fragments and the like are reported as HAL_FOREIGN, too.
 *
 * Cost: flush builds one Ethernet frame a peer; recv reads at most NET_TURN frames from one flush to the
 * next, whatever their sender. No call blocks. */
#ifndef HAL_NET_H
#define HAL_NET_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/link/cannelloni.h"
#include "hal/hal.h"
#include "hal/ethernet/ipv4.h"

enum {
    NET_PEERS = 4,
    NET_ASK_EVERY = 100, /* flushes from one ARP request for a silent peer to the next */
    NET_TURN = 256       /* Ethernet frames: more than 100 Mbit/s bring in a millisecond */
};

/* An Ethernet controller. */
struct ethernet {
    void *context;
    /* Bytes of the next frame (no FCS) copied to `frame`, which has room for ETHERNET_MAX; 0 when there is
     * none, < 0 the negated hal_fault bits. Frames that are longer or damaged are dropped by the
     * controller's driver. */
    int (*receive)(void *context, uint8_t *frame);
    /* True when the frame was taken. */
    bool (*transmit)(void *context, const uint8_t *frame, size_t n);
};

/* The addresses of a site: bytes without gaps, so that a tool can write them into an image. */
struct net_config {
    struct ipv4_host self;
    uint8_t n_peers; /* 1..NET_PEERS */
    struct ipv4_end peer[NET_PEERS];
};

/* Counters run since net_open. Read them freely; only the hal writes. */
struct net {
    struct hal hal; /* give this to the app; its owner sets now_us and healthy */
    const struct net_config *config;
    const struct ethernet *ethernet;
    bool known[NET_PEERS];
    uint8_t mac[NET_PEERS][ETHERNET_MAC];

    struct frame frame[CANNELLONI_FRAMES_MAX]; /* the packet being handed out */
    int n_frames, i_frame;
    uint32_t taken; /* Ethernet frames in this turn */

    struct cannelloni packet; /* being filled */
    uint32_t i_peer;          /* first peer that still has to get it; > 0 only after a refused send */
    uint32_t until_ask;       /* flushes until peers that are not known are asked again */
    uint8_t bytes[ETHERNET_MAX];

    uint32_t packets_received, packets_sent;
    uint32_t verdict[IPV4_VERDICTS]; /* Ethernet frames, by what they were */
    uint32_t foreign;                /* datagrams of senders that are not listed */
    uint32_t malformed;              /* datagrams of peers that were no cannelloni packets */
    uint32_t passed_over;            /* frames of peers that are no classic data frames */
    uint32_t unresolved; /* packets that a peer did not get because its address is not known yet */
    uint32_t refused;    /* frames that the controller had no room for: the packet is kept */
};

/* NULL, or what is wrong with the addresses. All pointers must stay valid; *n must stay where it is. */
const char *net_open(struct net *n, const struct net_config *c, const struct ethernet *e);

/* Before the first frame: asks the peers for their Ethernet addresses when `ask`, and takes the answers
 * that have arrived. True when all are known. Commands that arrive meanwhile are dropped: there is no
 * plant yet. */
bool net_resolve(struct net *n, bool ask);

#endif
