/* net.c - the plant's bus on a board's own Ethernet; see net.h. */
#include "hal/ethernet/net.h"

#include <string.h>

static bool same_address(const struct ipv4_end *a, const struct ipv4_end *b)
{
    return memcmp(a->address, b->address, sizeof a->address) == 0;
}

static bool listed(const struct net *n, const struct ipv4_end *from)
{
    for (int i = 0; i < n->config->n_peers; i++)
        if (memcmp(&n->config->peer[i], from, sizeof *from) == 0)
            return true;
    return false;
}

/* ---- addresses ---- */

static void learn(struct net *n, const struct ipv4_packet *p)
{
    for (int i = 0; i < NET_PEERS && i < n->config->n_peers;
         i++) { /* the first bound is for gcc -O3's eyes */
        if (same_address(&n->config->peer[i], &p->from)) {
            memcpy(n->mac[i], p->mac, ETHERNET_MAC);
            n->known[i] = true;
        }
    }
}

static bool all_known(const struct net *n)
{
    bool all = true;
    for (int i = 0; i < n->config->n_peers; i++)
        all = all && n->known[i];
    return all;
}

static void transmit(struct net *n, size_t length)
{
    if (!n->ethernet->transmit(n->ethernet->context, n->bytes, length))
        n->refused++;
}

static void ask(struct net *n)
{
    for (int i = 0; i < n->config->n_peers; i++)
        if (!n->known[i])
            transmit(n, ipv4_build_arp_request(&n->config->self, n->config->peer[i].address, n->bytes));
    n->until_ask = NET_ASK_EVERY;
}

/* ---- receiving ---- */

/* A datagram for us: its frames are in n->frame. Returns the hal_fault bits it gave. */
static int take_datagram(struct net *n, const struct ipv4_packet *p)
{
    if (!listed(n, &p->from)) {
        n->foreign++;
        return HAL_FOREIGN;
    }
    n->packets_received++;
    n->i_frame = 0;
    uint32_t before = n->passed_over;
    n->n_frames =
        cannelloni_parse(p->payload, p->n_payload, n->frame, CANNELLONI_FRAMES_MAX, &n->passed_over);
    if (n->n_frames >= 0)
        return n->passed_over != before ? HAL_FOREIGN : 0;
    n->n_frames = 0;
    n->malformed++;
    return HAL_FOREIGN;
}

/* Takes one Ethernet frame. Returns the hal_fault bits it gave, -1 when none waited. */
static int receive_frame(struct net *n)
{
    struct ipv4_packet p;
    if (n->taken == NET_TURN)
        return -1;
    int got = n->ethernet->receive(n->ethernet->context, n->bytes);
    n->taken += got != 0;
    if (got <= 0)
        return got < 0 ? -got : -1;
    enum ipv4_verdict verdict = ipv4_parse(&n->config->self, n->bytes, (size_t)got, &p);
    n->verdict[verdict]++;
    if (verdict == IPV4_DATAGRAM)
        return take_datagram(n, &p);
    if (verdict == IPV4_ARP_REQUEST || verdict == IPV4_ARP_REPLY)
        learn(n, &p);
    if (verdict == IPV4_ARP_REQUEST)
        transmit(n, ipv4_build_arp_reply(&n->config->self, &p, n->bytes));
    return verdict >= IPV4_BAD_HEADER ? HAL_FOREIGN : 0;
}

static int receive(void *context, struct frame *f)
{
    struct net *n = context;
    while (n->i_frame == n->n_frames) { /* at most NET_TURN */
        int fault = receive_frame(n);
        if (fault < 0)
            n->taken = 0; /* the turn ends */
        if (fault)
            return fault < 0 ? 0 : -fault;
    }
    *f = n->frame[n->i_frame++];
    return 1;
}

/* ---- sending ---- */

/* Sends the packet to the peers that still have to get it; true when it is gone. */
static bool transmit_packet(struct net *n)
{
    const struct net_config *c = n->config;
    for (; n->i_peer < c->n_peers; n->i_peer++) {
        uint32_t i = n->i_peer;
        if (!n->known[i]) {
            n->unresolved++;
            continue;
        }
        size_t length =
            ipv4_build(&c->self, n->mac[i], &c->peer[i], n->packet.bytes, n->packet.n_bytes, n->bytes);
        if (!n->ethernet->transmit(n->ethernet->context, n->bytes, length)) {
            n->refused++;
            return false;
        }
    }
    n->packets_sent++;
    n->i_peer = 0;
    cannelloni_next(&n->packet);
    return true;
}

/* A packet of which some peers have a copy must not grow. */
static int append(void *context, const struct frame *f)
{
    struct net *n = context;
    bool full = !cannelloni_has_room(&n->packet, f);
    if ((full || n->i_peer) && !transmit_packet(n))
        return 0;
    cannelloni_add(&n->packet, f);
    return 1;
}

static void flush(void *context)
{
    struct net *n = context;
    n->taken = 0;
    if (n->until_ask == 0 && !all_known(n))
        ask(n);
    n->until_ask -= n->until_ask > 0;
    if (n->packet.n_frames)
        (void)transmit_packet(n); /* refused: the packet stays, the next send or flush tries again */
}

/* ---- opening ---- */

bool net_resolve(struct net *n, bool again)
{
    if (again)
        ask(n);
    n->taken = 0;
    while (receive_frame(n) >= 0) /* at most NET_TURN */
        n->i_frame = n->n_frames = 0;
    return all_known(n);
}

const char *net_open(struct net *n, const struct net_config *c, const struct ethernet *e)
{
    memset(n, 0, sizeof *n);
    n->config = c;
    n->ethernet = e;
    cannelloni_begin(&n->packet, 0);
    n->hal = (struct hal){.context = n, .recv = receive, .send = append, .flush = flush};
    if (c->n_peers < 1 || c->n_peers > NET_PEERS)
        return "network: 1 to 4 peers are possible";
    if (c->self.mac[0] & 1)
        return "network: our own Ethernet address is that of a group; make its first byte even";
    return NULL;
}
