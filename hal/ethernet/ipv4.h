/* ipv4.h - as much of Ethernet, ARP, IPv4 and UDP as a plant on a wire needs, for boards without an operating
 * system. They are pure functions over one Ethernet frame (without its FCS). No state, no clock, no
 * allocation.
 *
 * Ethernet II; ARP (RFC 826); IPv4 (RFC 791) without options and fragments; UDP (RFC 768) with its checksum,
 * which a sender may leave out but a command must have. Everything is checked before anything is used, and
 * lengths are taken from the headers only where they agree with each other and with the bytes that arrived.
 * Addresses and ports are kept as the bytes of the wire.
 *
 * Cost: parsing and building touch each byte of a datagram once for its checksum, building once more to copy
 * it. */
#ifndef HAL_IPV4_H
#define HAL_IPV4_H

#include <stddef.h>
#include <stdint.h>

enum {
    ETHERNET_MAC = 6,
    ETHERNET_MIN = 60, /* shorter frames are padded */
    ETHERNET_MAX = 1514,
    IPV4_UDP_HEADERS = 14 + 20 + 8, /* bytes before the payload */
    IPV4_PAYLOAD_MAX = ETHERNET_MAX - IPV4_UDP_HEADERS
};

/* An address and port, network byte order. */
struct ipv4_end {
    uint8_t address[4];
    uint8_t port[2];
};

/* Who we are. */
struct ipv4_host {
    uint8_t mac[ETHERNET_MAC];
    struct ipv4_end end;
};

/* The kind of a frame. Those from IPV4_BAD_HEADER on are refused: addressed to us, but not to be believed. */
enum ipv4_verdict {
    IPV4_OTHER,            /* not for our addresses and port, or no protocol of ours */
    IPV4_DATAGRAM,         /* UDP for us */
    IPV4_ARP_REQUEST,      /* asks for our address: answer with ipv4_build_arp_reply */
    IPV4_ARP_REPLY,        /* tells the address of another host */
    IPV4_BAD_HEADER,       /* version, a length that disagrees, cut off */
    IPV4_BAD_CHECKSUM,     /* the checksum of the header */
    IPV4_OPTIONS,          /* a header with options */
    IPV4_FRAGMENT,         /* a part of a datagram: never put together */
    IPV4_BAD_LENGTH,       /* the UDP length is not that of the packet */
    IPV4_BAD_UDP_CHECKSUM, /* wrong */
    IPV4_NO_UDP_CHECKSUM,  /* left out */
    IPV4_VERDICTS
};

/* The sender and what it sent. */
struct ipv4_packet {
    uint8_t mac[ETHERNET_MAC]; /* sender of the Ethernet frame; in ARP the address in the message */
    struct ipv4_end from;      /* port 0 in ARP */
    const uint8_t *payload;    /* inside the frame; datagrams only */
    size_t n_payload;
};

/* Reads n bytes at most. *out is filled for datagrams and ARP. */
enum ipv4_verdict ipv4_parse(const struct ipv4_host *self, const uint8_t *frame, size_t n,
                             struct ipv4_packet *out);

/* Writes a frame of a datagram of at most IPV4_PAYLOAD_MAX bytes; `frame` has room for ETHERNET_MAX.
 * Returns its length, padding included. */
size_t ipv4_build(const struct ipv4_host *self, const uint8_t *to_mac, const struct ipv4_end *to,
                  const uint8_t *payload, size_t n, uint8_t *frame);

/* Writes a frame of ETHERNET_MIN bytes that asks everybody for this address, or answers such a request;
 * returns its length. */
size_t ipv4_build_arp_request(const struct ipv4_host *self, const uint8_t *address, uint8_t *frame);
size_t ipv4_build_arp_reply(const struct ipv4_host *self, const struct ipv4_packet *request, uint8_t *frame);

/* The Internet checksum (RFC 1071) of n bytes, on top of a sum so far: the ones' complement sum, not yet
 * inverted. */
uint32_t ipv4_sum(uint32_t sum, const uint8_t *bytes, size_t n);

#endif
