/* test_net.c - the plant's bus on Ethernet against a wire of arrays: addresses, strangers, batches, a full
 * controller. */
#include "hal/ethernet/net.h"

#include <string.h>
#include "tests/fixture/packet.h"
#include "tests/unit/test.h"

enum { WIRE = 300 };

/* One end of a wire: what has arrived, and where what is sent goes to. */
struct end {
    struct ethernet ethernet;
    struct end *other;
    uint8_t frame[WIRE][ETHERNET_MAX];
    size_t length[WIRE];
    int n, first;
    int room;     /* frames that the controller still takes */
    int fault;    /* reported once by the next receive */
    bool endless; /* the first frame that waits comes again and again */
};

static struct end plant_end, bench_end;
static struct net plant, bench;

/* Two peers at one address, and one that is not there. */
static const struct net_config plant_config = {
    {{0x52, 0x54, 0, 0x12, 0x34, 0x56}, {{192, 0, 2, 15}, {0x4E, 0x20}}},
    3,
    {{{192, 0, 2, 7}, {0x4E, 0x21}}, {{192, 0, 2, 7}, {0x4E, 0x22}}, {{192, 0, 2, 99}, {0x4E, 0x23}}}};
static const struct net_config bench_config = {
    {{0x52, 0x55, 0, 0, 2, 2}, {{192, 0, 2, 7}, {0x4E, 0x21}}}, 1, {{{192, 0, 2, 15}, {0x4E, 0x20}}}};

static int wire_receive(void *context, uint8_t *frame)
{
    struct end *e = context;
    int fault = e->fault;
    e->fault = 0;
    if (fault || e->first == e->n)
        return -fault;
    memcpy(frame, e->frame[e->first], e->length[e->first]);
    int i = e->first;
    e->first += !e->endless;
    return (int)e->length[i];
}

static void put(struct end *e, const uint8_t *frame, size_t n)
{
    if (e->n == WIRE)
        return;
    memcpy(e->frame[e->n], frame, n);
    e->length[e->n++] = n;
}

static bool wire_transmit(void *context, const uint8_t *frame, size_t n)
{
    struct end *e = context;
    if (e->room == 0)
        return false;
    e->room--;
    put(e->other, frame, n);
    return true;
}

static void open_end(struct end *e, struct end *other)
{
    memset(e, 0, sizeof *e);
    e->ethernet = (struct ethernet){e, wire_receive, wire_transmit};
    e->other = other;
    e->room = 1 << 20;
}

static void open_both(void)
{
    open_end(&plant_end, &bench_end);
    open_end(&bench_end, &plant_end);
    check_no_error("both open", net_open(&plant, &plant_config, &plant_end.ethernet));
    check_no_error("both open", net_open(&bench, &bench_config, &bench_end.ethernet));
}

/* Both know each other. */
static void open_resolved(void)
{
    open_both();
    (void)net_resolve(&plant, true);
    (void)net_resolve(&bench, true);
    (void)net_resolve(&plant, false);
    check_true("resolved", net_resolve(&bench, false));
}

static int take_from(struct net *n, struct frame *f)
{
    return n->hal.recv(n->hal.context, f);
}

static void give_to(struct net *n, const struct frame *f, int count)
{
    for (int i = 0; i < count; i++)
        n->hal.send(n->hal.context, &f[i]);
}

static void flush(struct net *n)
{
    n->hal.flush(n->hal.context);
}

TEST(net_config)
{
    struct net_config c = plant_config;
    check_int("a configuration has no gaps", sizeof c, 6 + 6 + 1 + 4 * 6);
    c.n_peers = 0;
    check_error("no peers", net_open(&plant, &c, &plant_end.ethernet));
    c.n_peers = NET_PEERS + 1;
    check_error("too many peers", net_open(&plant, &c, &plant_end.ethernet));
    c.n_peers = 1;
    c.self.mac[0] = 0x53;
    check_error("the Ethernet address of a group", net_open(&plant, &c, &plant_end.ethernet));
}

TEST(net_resolve)
{
    struct frame got;
    open_both();
    give_to(&plant, packet_frame, 1);
    flush(&plant);
    check_int("a packet for three peers not known", plant.unresolved, 3);
    check_int("makes three requests", bench_end.n, 3);
    give_to(&bench, packet_frame, 1);
    check_int("a peer that is asked answers", take_from(&bench, &got), 0);
    check_int("two requests for its address", bench.verdict[IPV4_ARP_REQUEST], 2);
    check_int("and one for another", bench.verdict[IPV4_OTHER], 1);
    check_true("and has learnt who asked", bench.known[0]);
    check_int("the answers bring no command", take_from(&plant, &got), 0);
    check_int("answers", plant.verdict[IPV4_ARP_REPLY], 2);
    check_true("two peers are known", plant.known[0] && plant.known[1] && !plant.known[2]);
    int before = bench_end.n;
    for (int i = 0; i < NET_ASK_EVERY; i++) {
        give_to(&plant, packet_frame, 1);
        flush(&plant);
    }
    check_int("a packet goes to both, and one request in 100 flushes", bench_end.n - before,
              2 * NET_ASK_EVERY + 1);
    check_int("what the third did not get", plant.unresolved, 3 + NET_ASK_EVERY);
    /* another card at the same address tells so */
    struct ipv4_host moved = bench_config.self;
    uint8_t frame[ETHERNET_MAX];
    moved.mac[5] = 9;
    put(&plant_end, frame, ipv4_build_arp_request(&moved, plant_config.self.end.address, frame));
    check_int("a request from a new card", take_from(&plant, &got), 0);
    check_int("is believed", plant.mac[0][5], 9);
}

TEST(net_exchange)
{
    struct frame got;
    open_resolved();
    check_int("nothing waits", take_from(&plant, &got), 0);
    give_to(&bench, packet_frame, PACKET_FRAMES);
    check_int("nothing goes before flush", take_from(&plant, &got), 0);
    flush(&bench);
    for (int i = 0; i < PACKET_FRAMES; i++)
        check_true("a frame arrives in order",
                   take_from(&plant, &got) == 1 && packet_same(&got, &packet_frame[i]));
    check_int("and no more", take_from(&plant, &got), 0);
    check_int("in one packet", plant.packets_received, 1);
    give_to(&plant, packet_frame, 1);
    flush(&plant);
    check_int("the answer arrives", take_from(&bench, &got), 1);
    check_true("the answer arrives", packet_same(&got, &packet_frame[0]));
    check_int("the packet for the other port is none of ours", take_from(&bench, &got), 0);
    check_int("counted", bench.verdict[IPV4_OTHER], 2); /* the first was the request for 192.0.2.99 */
    flush(&plant);
    check_int("an empty flush sends nothing", plant.packets_sent, 1);
    struct frame f = {.id = 0x100, .length = 8};
    int64_t in_order = 0;
    for (int i = 0; i < 120; i++) {
        f.data[0] = (uint8_t)i;
        give_to(&bench, &f, 1);
    }
    check_int("a full packet goes by itself", bench.packets_sent, 2);
    flush(&bench);
    for (int i = 0; i < 120; i++)
        in_order += take_from(&plant, &got) == 1 && got.data[0] == (uint8_t)i;
    check_int("frames that arrive in order", in_order, 120);
}

static void send_as(const struct ipv4_host *who, const uint8_t *payload, size_t n)
{
    uint8_t frame[ETHERNET_MAX];
    put(&plant_end, frame, ipv4_build(who, plant_config.self.mac, &plant_config.self.end, payload, n, frame));
}

TEST(net_strangers)
{
    struct frame got;
    struct ipv4_host stranger = bench_config.self;
    open_resolved();
    int answers = bench_end.n;
    stranger.end.port[1] = 0x99;
    send_as(&stranger, packet_golden, sizeof packet_golden);
    check_int("a stranger's port is foreign", take_from(&plant, &got), -HAL_FOREIGN);
    stranger = bench_config.self;
    stranger.end.address[3] = 8;
    send_as(&stranger, packet_golden, sizeof packet_golden);
    check_int("a stranger's address is foreign", take_from(&plant, &got), -HAL_FOREIGN);
    check_int("counted", plant.foreign, 2);
    send_as(&bench_config.self, packet_golden, sizeof packet_golden - 1);
    check_int("a peer's bad packet is refused", take_from(&plant, &got), -HAL_FOREIGN);
    send_as(&bench_config.self, packet_golden, 0);
    check_int("an empty datagram is refused", take_from(&plant, &got), -HAL_FOREIGN);
    check_int("counted on their own", plant.malformed, 2);
    send_as(&bench_config.self, packet_beside, sizeof packet_beside);
    check_int("frames of other kinds are told", take_from(&plant, &got), -HAL_FOREIGN);
    check_int("and counted", plant.passed_over, 2);
    check_int("the command beside them is taken", take_from(&plant, &got), 1);
    check_true("as it is", packet_same(&got, &packet_frame[0]));
    check_int("its packet is not malformed", plant.malformed, 2);
    send_as(&bench_config.self, packet_golden, sizeof packet_golden);
    plant_end.frame[plant_end.n - 1][50] ^= 1;
    check_int("a damaged datagram is refused", take_from(&plant, &got), -HAL_FOREIGN);
    check_int("counted by its verdict", plant.verdict[IPV4_BAD_UDP_CHECKSUM], 1);
    plant_end.fault = HAL_DROPPED;
    send_as(&bench_config.self, packet_golden, sizeof packet_golden);
    check_int("the controller's faults are passed on", take_from(&plant, &got), -HAL_DROPPED);
    check_int("a good one is taken after all that", take_from(&plant, &got), 1);
    check_int("nobody got an answer", bench_end.n - answers, 0);
}

/* A controller that takes the packet for the first peer
 * only: none gets it twice, and it does not grow between. */
TEST(net_full)
{
    open_resolved();
    int before = bench_end.n;
    plant_end.room = 1;
    give_to(&plant, packet_frame, 1);
    flush(&plant);
    check_int("the first peer has it", bench_end.n - before, 1);
    check_int("no room while a peer waits", plant.hal.send(&plant, &packet_frame[1]), 0);
    check_int("refused", plant.refused, 2);
    plant_end.room = 1 << 20;
    give_to(&plant, &packet_frame[1], 1);
    flush(&plant);
    check_int("then the second gets it, and both the next", bench_end.n - before, 4);
    check_int("packets", plant.packets_sent, 2);
    check_int("the first as it was", bench_end.frame[before][47], bench_end.frame[before + 1][47]);
    check_int("bytes of the first for both", (int64_t)bench_end.length[before],
              (int64_t)bench_end.length[before + 1]);
}

/* A turn passes over all frames that are no commands, up to NET_TURN. */
TEST(net_flood)
{
    struct frame got;
    uint8_t frame[ETHERNET_MAX];
    open_resolved();
    plant_end.first = plant_end.n = 0;
    size_t n = ipv4_build_arp_request(&bench_config.self, bench_config.self.end.address, frame);
    for (int i = 0; i < NET_TURN; i++)
        put(&plant_end, frame, n);
    send_as(&bench_config.self, packet_golden, sizeof packet_golden);
    flush(&plant);
    check_int("a storm of requests brings no command", take_from(&plant, &got), 0);
    check_int("frames passed over in one turn", plant_end.first, NET_TURN);
    check_int("the command behind it is found by the next", take_from(&plant, &got), 1);
    while (take_from(&plant, &got) == 1)
        ; /* the rest of its packet */
    struct ipv4_host stranger = bench_config.self;
    stranger.end.port[1] = 0x99;
    plant_end.first = plant_end.n = 0;
    send_as(&stranger, packet_golden, sizeof packet_golden);
    plant_end.endless = true;
    for (int turn = 0; turn < 2; turn++) {
        int calls = 0;
        flush(&plant);
        while (take_from(&plant, &got) == -HAL_FOREIGN && calls < 10 * NET_TURN)
            calls++;
        check_int("datagrams of a stranger without end, in one turn", calls, NET_TURN);
    }
}
