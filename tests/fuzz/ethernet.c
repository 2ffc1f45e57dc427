/* ethernet.c - a board's own Ethernet: ARP, IPv4 and UDP from the wire up to frames for the plant. */
#include "hal/ethernet/net.h"
#include "tests/fuzz/fuzz.h"

#include <string.h>

static const struct net_config config = {{{0x52, 0x54, 0, 0x12, 0x34, 0x56}, {{192, 0, 2, 15}, {0x4E, 0x20}}},
                                         2,
                                         {{{192, 0, 2, 7}, {0x4E, 0x21}}, {{192, 0, 2, 99}, {0x4E, 0x23}}}};

struct wire {
    const uint8_t *data;
    size_t size;
};

static void put_16(uint8_t *at, uint32_t value)
{
    at[0] = (uint8_t)(value >> 8);
    at[1] = (uint8_t)value;
}

static uint32_t folded(uint32_t sum)
{
    while (sum >> 16)
        sum = (sum & 0xFFFF) + (sum >> 16);
    return ~sum & 0xFFFF;
}

/* Addresses, lengths and checksums as a good sender's, so that what follows them is reached too. */
static void make_good(uint8_t *f, size_t n)
{
    if (n < IPV4_UDP_HEADERS)
        return;
    memcpy(f, config.self.mac, ETHERNET_MAC);
    memcpy(f + 12, "\x08\x00\x45\x00", 4);
    put_16(f + 16, (uint32_t)n - 14);
    put_16(f + 20, 0x4000);
    f[23] = 17;
    memcpy(f + 26, config.peer[0].address, 4);
    memcpy(f + 30, config.self.end.address, 4);
    memcpy(f + 34, config.peer[0].port, 2);
    memcpy(f + 36, config.self.end.port, 2);
    put_16(f + 38, (uint32_t)n - 34);
    put_16(f + 24, 0);
    put_16(f + 24, folded(ipv4_sum(0, f + 14, 20)));
    put_16(f + 40, 0);
    uint32_t sum = ipv4_sum(ipv4_sum(17 + (uint32_t)n - 34, f + 26, 8), f + 34, n - 34);
    sum = folded(sum);
    put_16(f + 40, sum ? sum : 0xFFFF);
}

/* The next frame: a byte of flags, two of length, the bytes. */
static int receive(void *context, uint8_t *frame)
{
    struct wire *w = context;
    if (w->size < 3)
        return 0;
    uint8_t flags = w->data[0];
    size_t n = (size_t)(w->data[1] << 8 | w->data[2]) % (ETHERNET_MAX + 1);
    w->data += 3;
    w->size -= 3;
    if (flags & 0x80)
        return -(1 + flags % 31);
    n = n < w->size ? n : w->size;
    memcpy(frame, w->data, n);
    w->data += n;
    w->size -= n;
    if (flags & 1)
        make_good(frame, n);
    return (int)n;
}

static bool transmit(void *context, const uint8_t *frame, size_t n)
{
    (void)context;
    MUST(n >= ETHERNET_MIN && n <= ETHERNET_MAX && frame);
    return n % 3 != 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct net net;
    struct wire wire = {data, size};
    const struct ethernet e = {&wire, receive, transmit};
    struct frame f;
    MUST(!net_open(&net, &config, &e));
    (void)net_resolve(&net, true);
    for (size_t calls = 0; wire.size >= 3 || net.i_frame < net.n_frames; calls++) {
        int got = net.hal.recv(net.hal.context, &f);
        MUST(calls < size * 2 + 16);
        MUST(got <= 1 && got >= -31);
        if (got == 1) {
            MUST(f.length <= FRAME_DATA && f.id <= 0x1FFFFFFFu);
            (void)net.hal.send(net.hal.context, &f);
        }
        if (calls % 8 == 7)
            net.hal.flush(net.hal.context);
    }
    return 0;
}
