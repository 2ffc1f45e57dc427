/* loopback.c - a bus inside the process; see loopback.h. */
#include "hal/link/loopback.h"

#include <assert.h>
#include <string.h>

static void put(struct loopback_port *p, const struct frame *f)
{
    if (p->n == p->bus->depth) {
        p->dropped++;
        return;
    }
    p->ring[(p->first + p->n++) % LOOPBACK_RING] = *f;
}

static int receive(void *context, struct frame *f)
{
    struct loopback_port *p = context;
    int fault = p->fault;
    if (fault) {
        p->fault = 0;
        return -fault;
    }
    if (p->n) {
        *f = p->ring[p->first];
        p->first = (p->first + 1) % LOOPBACK_RING;
        p->n--;
        return 1;
    }
    fault = p->dropped ? HAL_DROPPED : 0;
    p->dropped = 0;
    return -fault;
}

static int transmit(void *context, const struct frame *f)
{
    struct loopback_port *p = context;
    if (p->tx_taken >= p->tx_limit)
        return 0;
    p->tx_taken++;
    for (uint32_t i = 0; i < p->bus->n_ports; i++)
        if (&p->bus->port[i] != p)
            put(&p->bus->port[i], f);
    return 1;
}

static void flush(void *context)
{
    struct loopback_port *p = context;
    p->tx_taken = 0;
}

static uint32_t now_us(void *context)
{
    const struct loopback_port *p = context;
    return p->bus->now_us;
}

static void healthy(void *context)
{
    struct loopback_port *p = context;
    p->healthy++;
}

void loopback_init(struct loopback_bus *bus, uint32_t n_ports, uint32_t depth)
{
    assert(n_ports >= 1 && n_ports <= LOOPBACK_PORTS && depth >= 1 && depth <= LOOPBACK_RING);
    memset(bus, 0, sizeof *bus);
    bus->n_ports = n_ports;
    bus->depth = depth;
    for (uint32_t i = 0; i < n_ports; i++) {
        struct loopback_port *p = &bus->port[i];
        p->bus = bus;
        p->tx_limit = UINT32_MAX;
        p->hal = (struct hal){p, receive, transmit, flush, now_us, healthy};
    }
}
