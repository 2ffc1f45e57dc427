/* ipv4.c - Ethernet, ARP, IPv4 and UDP over one frame; see ipv4.h. */
#include "hal/ethernet/ipv4.h"

#include <stdbool.h>
#include <string.h>

/* Where fields stand. */
enum {
    TO_MAC = 0,
    FROM_MAC = 6,
    TYPE = 12,
    ARP = 14,
    IP = 14,
    UDP = 34,
    IP_HEADER = 20,
    UDP_HEADER = 8,
    ARP_BYTES = 28
};

enum { TYPE_IPV4 = 0x0800, TYPE_ARP = 0x0806, PROTOCOL_UDP = 17, HOPS = 64, DO_NOT_FRAGMENT = 0x4000 };
enum { OPERATION_REQUEST = 1, OPERATION_REPLY = 2, ARP_SENDER = 8, ARP_TARGET = 18, ARP_ADDRESS = 6 };

/* ARP for IPv4 over Ethernet: hardware 1, protocol 0x0800, lengths 6 and 4. */
static const uint8_t arp_kind[6] = {0, 1, 8, 0, 6, 4};
static const uint8_t everybody[ETHERNET_MAC] = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};

static unsigned get_u16(const uint8_t *b)
{
    return (unsigned)b[0] << 8 | b[1];
}

static void put_u16(uint8_t *b, unsigned v)
{
    b[0] = (uint8_t)(v >> 8);
    b[1] = (uint8_t)v;
}

static bool equal(const uint8_t *a, const uint8_t *b, size_t n)
{
    unsigned differ = 0;
    for (size_t i = 0; i < n; i++)
        differ |= (unsigned)(a[i] ^ b[i]);
    return differ == 0;
}

/* At most 64 KB, so that 32 bits do not overflow before the fold. */
uint32_t ipv4_sum(uint32_t sum, const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i + 1 < n; i += 2)
        sum += get_u16(bytes + i);
    if (n % 2)
        sum += (uint32_t)bytes[n - 1] << 8;
    sum = (sum & 0xFFFF) + (sum >> 16);
    return (sum & 0xFFFF) + (sum >> 16);
}

/* Over the pseudo header (addresses, protocol, length) and the datagram at UDP. */
static uint32_t udp_sum(const uint8_t *frame, size_t n)
{
    return ipv4_sum(ipv4_sum(PROTOCOL_UDP + (uint32_t)n, frame + IP + 12, 8), frame + UDP, n);
}

/* ---- reading ---- */

static enum ipv4_verdict parse_arp(const struct ipv4_host *self, const uint8_t *frame, size_t n,
                                   struct ipv4_packet *out)
{
    const uint8_t *a = frame + ARP;
    if (n < ARP + ARP_BYTES || !equal(a, arp_kind, sizeof arp_kind))
        return IPV4_OTHER;
    unsigned operation = get_u16(a + 6);
    bool asks_us = equal(a + ARP_TARGET + ARP_ADDRESS, self->end.address, sizeof self->end.address);
    memset(out, 0, sizeof *out);
    memcpy(out->mac, a + ARP_SENDER, sizeof out->mac);
    memcpy(out->from.address, a + ARP_SENDER + ARP_ADDRESS, sizeof out->from.address);
    if (out->mac[0] & 1) /* a group cannot be answered */
        return IPV4_OTHER;
    if (operation == OPERATION_REPLY)
        return IPV4_ARP_REPLY;
    return operation == OPERATION_REQUEST && asks_us ? IPV4_ARP_REQUEST : IPV4_OTHER;
}

static enum ipv4_verdict parse_udp(const struct ipv4_host *self, const uint8_t *frame, size_t n,
                                   struct ipv4_packet *out)
{
    const uint8_t *udp = frame + UDP;
    if (n < UDP_HEADER || get_u16(udp + 4) != n)
        return IPV4_BAD_LENGTH;
    if (!equal(udp + 2, self->end.port, sizeof self->end.port))
        return IPV4_OTHER;
    if (get_u16(udp + 6) == 0)
        return IPV4_NO_UDP_CHECKSUM;
    if (udp_sum(frame, n) != 0xFFFF)
        return IPV4_BAD_UDP_CHECKSUM;
    memcpy(out->mac, frame + FROM_MAC, sizeof out->mac);
    memcpy(out->from.address, frame + IP + 12, sizeof out->from.address);
    memcpy(out->from.port, udp, sizeof out->from.port);
    out->payload = udp + UDP_HEADER;
    out->n_payload = n - UDP_HEADER;
    return IPV4_DATAGRAM;
}

static enum ipv4_verdict parse_ipv4(const struct ipv4_host *self, const uint8_t *frame, size_t n,
                                    struct ipv4_packet *out)
{
    const uint8_t *ip = frame + IP;
    if (!equal(frame + TO_MAC, self->mac, sizeof self->mac))
        return IPV4_OTHER;
    if (n < IP + IP_HEADER || ip[0] >> 4 != 4)
        return IPV4_BAD_HEADER;
    size_t header = 4 * (size_t)(ip[0] & 15), total = get_u16(ip + 2);
    if (header < IP_HEADER || total < header || total > n - IP)
        return IPV4_BAD_HEADER;
    if (ipv4_sum(0, ip, header) != 0xFFFF)
        return IPV4_BAD_CHECKSUM;
    if (!equal(ip + 16, self->end.address, sizeof self->end.address) || ip[9] != PROTOCOL_UDP)
        return IPV4_OTHER;
    if (header > IP_HEADER)
        return IPV4_OPTIONS;
    if (get_u16(ip + 6) & ~(unsigned)DO_NOT_FRAGMENT) /* more to come, an offset, or the bit that must be 0 */
        return IPV4_FRAGMENT;
    return parse_udp(self, frame, total - IP_HEADER, out);
}

enum ipv4_verdict ipv4_parse(const struct ipv4_host *self, const uint8_t *frame, size_t n,
                             struct ipv4_packet *out)
{
    if (n < IP)
        return IPV4_OTHER;
    unsigned type = get_u16(frame + TYPE);
    if (type == TYPE_ARP)
        return parse_arp(self, frame, n, out);
    return type == TYPE_IPV4 ? parse_ipv4(self, frame, n, out) : IPV4_OTHER;
}

/* ---- writing ---- */

static void put_ethernet(const struct ipv4_host *self, const uint8_t *to_mac, unsigned type, uint8_t *frame)
{
    memcpy(frame + TO_MAC, to_mac, ETHERNET_MAC);
    memcpy(frame + FROM_MAC, self->mac, ETHERNET_MAC);
    put_u16(frame + TYPE, type);
}

/* Too short a frame gets zeros at its end. */
static size_t pad(uint8_t *frame, size_t n)
{
    if (n < ETHERNET_MIN)
        memset(frame + n, 0, ETHERNET_MIN - n);
    return n < ETHERNET_MIN ? ETHERNET_MIN : n;
}

size_t ipv4_build(const struct ipv4_host *self, const uint8_t *to_mac, const struct ipv4_end *to,
                  const uint8_t *payload, size_t n, uint8_t *frame)
{
    uint8_t *ip = frame + IP, *udp = frame + UDP;
    size_t n_udp = UDP_HEADER + n;
    put_ethernet(self, to_mac, TYPE_IPV4, frame);
    memset(ip, 0, IP_HEADER + UDP_HEADER);
    ip[0] = 0x45;
    put_u16(ip + 2, (unsigned)(IP_HEADER + n_udp));
    put_u16(ip + 6, DO_NOT_FRAGMENT);
    ip[8] = HOPS;
    ip[9] = PROTOCOL_UDP;
    memcpy(ip + 12, self->end.address, sizeof self->end.address);
    memcpy(ip + 16, to->address, sizeof to->address);
    put_u16(ip + 10, ~ipv4_sum(0, ip, IP_HEADER) & 0xFFFF);
    memcpy(udp, self->end.port, sizeof self->end.port);
    memcpy(udp + 2, to->port, sizeof to->port);
    put_u16(udp + 4, (unsigned)n_udp);
    memcpy(udp + UDP_HEADER, payload, n);
    uint32_t sum = ~udp_sum(frame, n_udp) & 0xFFFF;
    put_u16(udp + 6, sum ? sum : 0xFFFF); /* 0 would mean: none */
    return pad(frame, IPV4_UDP_HEADERS + n);
}

static size_t put_arp(const struct ipv4_host *self, unsigned operation, const uint8_t *to_mac,
                      const uint8_t *target_mac, const uint8_t *target_address, uint8_t *frame)
{
    uint8_t *a = frame + ARP;
    put_ethernet(self, to_mac, TYPE_ARP, frame);
    memcpy(a, arp_kind, sizeof arp_kind);
    put_u16(a + 6, operation);
    memcpy(a + ARP_SENDER, self->mac, ETHERNET_MAC);
    memcpy(a + ARP_SENDER + ARP_ADDRESS, self->end.address, sizeof self->end.address);
    memcpy(a + ARP_TARGET, target_mac, ETHERNET_MAC);
    memcpy(a + ARP_TARGET + ARP_ADDRESS, target_address, sizeof self->end.address);
    return pad(frame, ARP + ARP_BYTES);
}

size_t ipv4_build_arp_request(const struct ipv4_host *self, const uint8_t *address, uint8_t *frame)
{
    static const uint8_t nobody[ETHERNET_MAC] = {0};
    return put_arp(self, OPERATION_REQUEST, everybody, nobody, address, frame);
}

size_t ipv4_build_arp_reply(const struct ipv4_host *self, const struct ipv4_packet *request, uint8_t *frame)
{
    return put_arp(self, OPERATION_REPLY, request->mac, request->mac, request->from.address, frame);
}
