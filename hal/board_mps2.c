/* board_mps2.c - Arm MPS2 and MPS2+ boards: console on UART0, bus on the LAN9118. The linker script has the
 * addresses. */
#include "hal/board.h"

#include "hal/lan9118.h"
#include "hal/network.h"
#include "hal/uart_cmsdk.h"

enum { BAUD = 115200 };

extern volatile uint32_t uart0[], ethernet0[];

static struct lan9118 controller;
static struct net net;

bool board_put(char c)
{
    static bool open;
    if (!open)
        uart_cmsdk_open(uart0, BOARD_CLOCK_HZ / BAUD);
    open = true;
    return uart_cmsdk_put(uart0, c);
}

/* No watchdog is started on this board. */
static void healthy(void *context)
{
    (void)context;
}

const struct hal *board_bus(const char **why)
{
    *why = lan9118_open(&controller, ethernet0, network.self.mac);
    if (!*why)
        *why = net_open(&net, &network, &controller.ethernet);
    if (*why)
        return NULL;
    net.hal.now_us = board_hal_now_us;
    net.hal.healthy = healthy;
    uint32_t begin_us = board_now_us();
    bool known = net_resolve(&net, true);
    while (!known && board_now_us() - begin_us < BOARD_BUS_WAIT_US)
        known = net_resolve(&net, false);
    return &net.hal;
}
