/* test_ipv4.c - a frame written by hand and published checksums; every way to spoil a frame; bytes that mean
 * nothing. */
#include "hal/ethernet/ipv4.h"

#include <stdlib.h>
#include <string.h>
#include "tests/unit/test.h"

/* Where the fields of an IPv4 datagram stand. */
enum { AT_IP = 14, AT_SUM = 24, AT_UDP = 34, AT_PAYLOAD = 42, DATAGRAM = 54 };

/* A datagram of 12 bytes from 192.0.2.7:20001 to 192.0.2.15:20000; both checksums worked out as numbers
 * modulo 65535. The last 6 bytes are padding. */
static const uint8_t golden[ETHERNET_MIN] = {
    0x52, 0x54, 0x00, 0x12, 0x34, 0x56, 0x52, 0x55, 0x00, 0x00, 0x02, 0x02, 0x08, 0x00, /* Ethernet */
    0x45, 0x00, 0x00, 0x28, 0x00, 0x00, 0x40, 0x00, 0x40, 0x11, 0xB6, 0xAE,             /* IPv4 */
    0xC0, 0x00, 0x02, 0x07, 0xC0, 0x00, 0x02, 0x0F,                                     /* from, to */
    0x4E, 0x21, 0x4E, 0x20, 0x00, 0x14, 0xE8, 0x9B,                                     /* UDP */
    0x02, 0x00, 0x07, 0x00, 0x01, 0x00, 0x00, 0x02, 0x41, 0x02, 0xAB, 0xCD};
static const struct ipv4_host plant_host = {{0x52, 0x54, 0x00, 0x12, 0x34, 0x56},
                                            {{192, 0, 2, 15}, {0x4E, 0x20}}};
static const struct ipv4_host bench_host = {{0x52, 0x55, 0x00, 0x00, 0x02, 0x02},
                                            {{192, 0, 2, 7}, {0x4E, 0x21}}};

/* Parses a copy that ends where the frame ends: an address sanitizer sees any read beyond. */
static enum ipv4_verdict parse_frame(const uint8_t *frame, size_t n, struct ipv4_packet *out)
{
    uint8_t *copy = malloc(n ? n : 1);
    memcpy(copy, frame, n);
    enum ipv4_verdict verdict = ipv4_parse(&plant_host, copy, n, out);
    if (verdict == IPV4_DATAGRAM) /* the payload lies inside what arrived; show the caller's bytes */
        out->payload = out->payload + out->n_payload <= copy + n ? frame + (out->payload - copy) : NULL;
    free(copy);
    return verdict;
}

static void put_sum(uint8_t *at, uint32_t sum)
{
    at[0] = (uint8_t)(~sum >> 8);
    at[1] = (uint8_t)~sum;
}

/* Makes the header's checksum right again, so that the next check is reached. */
static void mend(uint8_t *frame)
{
    memset(frame + AT_SUM, 0, 2);
    put_sum(frame + AT_SUM, ipv4_sum(0, frame + AT_IP, 4 * (size_t)(frame[AT_IP] & 15)));
}

/* RFC 1071, section 3, and a widely published header whose checksum is b861. */
TEST(ipv4_checksum)
{
    const uint8_t rfc1071[] = {0x00, 0x01, 0xF2, 0x03, 0xF4, 0xF5, 0xF6, 0xF7};
    const uint8_t header[] = {0x45, 0x00, 0x00, 0x73, 0x00, 0x00, 0x40, 0x00, 0x40, 0x11,
                              0x00, 0x00, 0xC0, 0xA8, 0x00, 0x01, 0xC0, 0xA8, 0x00, 0xC7};
    uint8_t ones[1480];
    memset(ones, 0xFF, sizeof ones);
    check_hex("RFC 1071's example", ipv4_sum(0, rfc1071, sizeof rfc1071), 0xDDF2);
    check_hex("an IPv4 header", ~ipv4_sum(0, header, sizeof header) & 0xFFFF, 0xB861);
    check_hex("an odd byte is the high one", ipv4_sum(0, rfc1071 + 2, 3), 0xF203 + 0xF400 - 0xFFFF);
    check_hex("in two parts", ipv4_sum(ipv4_sum(0, rfc1071, 4), rfc1071 + 4, 4), 0xDDF2);
    check_hex("the largest datagram of ones", ipv4_sum(0xFFFF, ones, sizeof ones), 0xFFFF);
    check_hex("nothing", ipv4_sum(0, ones, 0), 0);
}

TEST(ipv4_datagram)
{
    struct ipv4_packet p;
    uint8_t frame[ETHERNET_MAX], payload[IPV4_PAYLOAD_MAX];
    memset(frame, 0xEE, sizeof frame);
    check_int("the frame is a datagram", parse_frame(golden, sizeof golden, &p), IPV4_DATAGRAM);
    check_int("without its padding too", parse_frame(golden, DATAGRAM, &p), IPV4_DATAGRAM);
    check_int("sender's Ethernet address differs", memcmp(p.mac, bench_host.mac, sizeof p.mac), 0);
    check_int("sender's end differs", memcmp(&p.from, &bench_host.end, sizeof p.from), 0);
    check_int("payload begins at", p.payload - golden, AT_PAYLOAD);
    check_int("payload bytes", (int64_t)p.n_payload, DATAGRAM - AT_PAYLOAD);
    size_t n = ipv4_build(&bench_host, plant_host.mac, &plant_host.end, golden + AT_PAYLOAD,
                          DATAGRAM - AT_PAYLOAD, frame);
    check_int("bytes built", (int64_t)n, sizeof golden);
    check_int("bytes that differ", memcmp(frame, golden, sizeof golden), 0);
    for (size_t i = 0; i < sizeof payload; i++)
        payload[i] = (uint8_t)(37 * i + i / 256);
    int64_t lost = 0, longest = 0;
    for (size_t i = 0; i <= sizeof payload; i++) {
        n = ipv4_build(&bench_host, plant_host.mac, &plant_host.end, payload, i, frame);
        longest = (int64_t)n;
        lost += parse_frame(frame, n, &p) != IPV4_DATAGRAM || p.n_payload != i ||
                memcmp(p.payload, payload, i) != 0;
    }
    check_int("datagrams of 0 to 1472 bytes that do not come through", lost, 0);
    check_int("the longest frame", longest, ETHERNET_MAX);
    /* a checksum that comes out as 0 is sent as ffff: 0 would mean that there is none */
    n = ipv4_build(&bench_host, plant_host.mac, &plant_host.end, golden + AT_UDP + 6, 2, frame);
    uint32_t sum = (uint32_t)frame[AT_UDP + 6] << 8 | frame[AT_UDP + 7];
    uint32_t word = ((uint32_t)golden[AT_UDP + 6] << 8 | golden[AT_UDP + 7]) + sum;
    word = (word & 0xFFFF) + (word >> 16);
    const uint8_t zero[] = {(uint8_t)(word >> 8), (uint8_t)word};
    n = ipv4_build(&bench_host, plant_host.mac, &plant_host.end, zero, 2, frame);
    check_hex("a checksum of zero", (uint64_t)frame[AT_UDP + 6] << 8 | frame[AT_UDP + 7], 0xFFFF);
    check_int("is accepted", parse_frame(frame, n, &p), IPV4_DATAGRAM);
}

static void spoiled(const char *name, size_t at, uint8_t value, enum ipv4_verdict verdict)
{
    uint8_t frame[2 * sizeof golden] = {0}; /* a header may claim 60 bytes */
    struct ipv4_packet p;
    memcpy(frame, golden, sizeof golden);
    frame[at] = value;
    if (verdict != IPV4_BAD_CHECKSUM)
        mend(frame);
    check_int(name, parse_frame(frame, sizeof golden, &p), verdict);
}

TEST(ipv4_refused)
{
    spoiled("to another station", 5, 0x57, IPV4_OTHER);
    spoiled("another protocol than IPv4", 12, 0x86, IPV4_OTHER);
    spoiled("version 6", AT_IP, 0x65, IPV4_BAD_HEADER);
    spoiled("a header of 16 bytes", AT_IP, 0x44, IPV4_BAD_HEADER);
    spoiled("a header beyond the packet", AT_IP, 0x4F, IPV4_BAD_HEADER);
    spoiled("longer than the frame", AT_IP + 3, 0x2F, IPV4_BAD_HEADER);
    spoiled("longer than any frame", AT_IP + 2, 0xFF, IPV4_BAD_HEADER);
    spoiled("shorter than its header", AT_IP + 3, 0x13, IPV4_BAD_HEADER);
    spoiled("header checksum", AT_SUM, 0, IPV4_BAD_CHECKSUM);
    spoiled("one bit of the source address", AT_IP + 12, 0xC1, IPV4_BAD_CHECKSUM);
    spoiled("to another address", AT_IP + 19, 0x10, IPV4_OTHER);
    spoiled("TCP", AT_IP + 9, 6, IPV4_OTHER);
    spoiled("options", AT_IP, 0x46, IPV4_OPTIONS);
    spoiled("more fragments follow", AT_IP + 6, 0x20, IPV4_FRAGMENT);
    spoiled("a later fragment", AT_IP + 7, 1, IPV4_FRAGMENT);
    spoiled("the reserved bit", AT_IP + 6, 0xC0, IPV4_FRAGMENT);
    spoiled("fragmenting allowed, but whole", AT_IP + 6, 0, IPV4_DATAGRAM);
    spoiled("UDP longer than the packet", AT_UDP + 5, 0x15, IPV4_BAD_LENGTH);
    spoiled("UDP shorter than the packet", AT_UDP + 5, 0x13, IPV4_BAD_LENGTH);
    spoiled("UDP shorter than its header", AT_UDP + 5, 7, IPV4_BAD_LENGTH);
    spoiled("a packet that ends inside the UDP header", AT_IP + 3, 27, IPV4_BAD_LENGTH);
    spoiled("another port", AT_UDP + 3, 0x21, IPV4_OTHER);
    spoiled("one bit of the payload", AT_PAYLOAD, 0x03, IPV4_BAD_UDP_CHECKSUM);
    spoiled("UDP checksum", AT_UDP + 7, 0x9A, IPV4_BAD_UDP_CHECKSUM);
    spoiled("a source address that the header agrees with", AT_IP + 15, 8, IPV4_BAD_UDP_CHECKSUM);
    spoiled("padding does not count", DATAGRAM, 0xFF, IPV4_DATAGRAM);
    uint8_t frame[sizeof golden];
    struct ipv4_packet p;
    memcpy(frame, golden, sizeof golden);
    memset(frame + AT_UDP + 6, 0, 2);
    check_int("no UDP checksum", parse_frame(frame, sizeof frame, &p), IPV4_NO_UDP_CHECKSUM);
}

TEST(ipv4_truncated)
{
    struct ipv4_packet p;
    int64_t taken = 0;
    for (size_t n = 0; n < DATAGRAM; n++)
        taken += parse_frame(golden, n, &p) == IPV4_DATAGRAM;
    check_int("truncated frames taken", taken, 0);
    check_int("cut inside the Ethernet header", parse_frame(golden, 13, &p), IPV4_OTHER);
    check_int("cut inside the IPv4 header", parse_frame(golden, 33, &p), IPV4_BAD_HEADER);
    check_int("cut inside the payload", parse_frame(golden, DATAGRAM - 1, &p), IPV4_BAD_HEADER);
}

/* A frame with three bytes spoilt is refused, or says what the good one said: the checksums let one error in
 * 65535 through, and those that are mended here all. Nothing is ever read or pointed at outside the frame. */
TEST(ipv4_random)
{
    uint32_t random = 1;
    int64_t outside = 0, datagrams = 0;
    for (int i = 0; i < 200000; i++) {
        uint8_t frame[sizeof golden];
        struct ipv4_packet p;
        memcpy(frame, golden, sizeof golden);
        for (int k = 0; k < 3; k++) {
            random = random * 1664525u + 1013904223u;
            frame[(random >> 8) % sizeof golden] = (uint8_t)(random >> 24);
        }
        size_t n = (random >> 4) % (sizeof golden + 1);
        if (n >= AT_UDP && i % 2)
            put_sum(frame + AT_SUM, ipv4_sum(0, frame + AT_IP, 10) + ipv4_sum(0, frame + AT_SUM + 2, 8));
        if (parse_frame(frame, n, &p) == IPV4_DATAGRAM) {
            datagrams++;
            outside += !p.payload || p.payload < frame + AT_PAYLOAD || p.payload + p.n_payload > frame + n;
        }
    }
    check_int("payloads outside their frame", outside, 0);
    check_above("frames that were still good", (double)datagrams, 1);
}

/* RFC 826: who has 192.0.2.15, tell 192.0.2.7. */
static const uint8_t request[ETHERNET_MIN] = {
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x52, 0x55, 0x00, 0x00, 0x02, 0x02, 0x08, 0x06, /* Ethernet */
    0x00, 0x01, 0x08, 0x00, 0x06, 0x04, 0x00, 0x01,                                     /* request */
    0x52, 0x55, 0x00, 0x00, 0x02, 0x02, 0xC0, 0x00, 0x02, 0x07,                         /* sender */
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xC0, 0x00, 0x02, 0x0F};                        /* target */
static const uint8_t reply[ETHERNET_MIN] = {
    0x52, 0x55, 0x00, 0x00, 0x02, 0x02, 0x52, 0x54, 0x00, 0x12, 0x34, 0x56, 0x08, 0x06, /* Ethernet */
    0x00, 0x01, 0x08, 0x00, 0x06, 0x04, 0x00, 0x02,                                     /* reply */
    0x52, 0x54, 0x00, 0x12, 0x34, 0x56, 0xC0, 0x00, 0x02, 0x0F,                         /* sender */
    0x52, 0x55, 0x00, 0x00, 0x02, 0x02, 0xC0, 0x00, 0x02, 0x07};                        /* target */

static void spoiled_arp(const char *name, size_t at, uint8_t value)
{
    uint8_t frame[sizeof request];
    struct ipv4_packet p;
    memcpy(frame, request, sizeof request);
    frame[at] = value;
    check_int(name, parse_frame(frame, sizeof frame, &p), IPV4_OTHER);
}

TEST(ipv4_arp)
{
    struct ipv4_packet p;
    uint8_t frame[ETHERNET_MAX];
    memset(frame, 0xEE, sizeof frame);
    check_int("a request for us", parse_frame(request, sizeof request, &p), IPV4_ARP_REQUEST);
    check_int("bytes of the answer", (int64_t)ipv4_build_arp_reply(&plant_host, &p, frame), ETHERNET_MIN);
    check_int("that differ from RFC 826", memcmp(frame, reply, sizeof reply), 0);
    memset(frame, 0xEE, sizeof frame);
    check_int("bytes of a request",
              (int64_t)ipv4_build_arp_request(&bench_host, plant_host.end.address, frame), ETHERNET_MIN);
    check_int("that differ from RFC 826", memcmp(frame, request, sizeof request), 0);
    check_int("an answer", ipv4_parse(&bench_host, reply, sizeof reply, &p), IPV4_ARP_REPLY);
    check_int("tells the Ethernet address", memcmp(p.mac, plant_host.mac, sizeof p.mac), 0);
    check_int("of the address", memcmp(p.from.address, plant_host.end.address, sizeof p.from.address), 0);
    spoiled_arp("for somebody else", 41, 16);
    spoiled_arp("of another network", 15, 6);
    spoiled_arp("of another protocol", 16, 0x86);
    spoiled_arp("with long addresses", 18, 8);
    spoiled_arp("neither request nor reply", 21, 3);
    spoiled_arp("from a group of stations", 22, 0x53);
    int64_t taken = 0;
    for (size_t n = 0; n < 42; n++)
        taken += parse_frame(request, n, &p) != IPV4_OTHER;
    check_int("truncated requests taken", taken, 0);
}
