/* board_mps2.c - Arm MPS2 and MPS2+ boards: console on UART0, bus on the LAN9118, frames by the counter of
 * the FPGA's I/O block (Arm DAI 0386 and 0500), watchdog of the CMSDK. The linker script has the
 * addresses. */
#include "hal/board/board.h"

#include "hal/device/cmsdk_watchdog.h"
#include "hal/ethernet/lan9118.h"
#include "hal/ethernet/network.h"
#include "hal/device/uart_cmsdk.h"

enum { BAUD = 115200 };

extern volatile uint32_t uart0[];
extern uint32_t watchdog[], ethernet0[];

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

bool board_watch(void)
{
    cmsdk_watchdog_open(registers_words((uintptr_t)watchdog), (uint32_t)BOARD_WATCHDOG_S * BOARD_CLOCK_HZ);
    board_watched();
    return true;
}

/* Before board_watch it feeds a watchdog that does not run. */
static void healthy(void *context)
{
    (void)context;
    cmsdk_watchdog_feed(registers_words((uintptr_t)watchdog));
}

const struct hal *board_bus(const char **why)
{
    *why = lan9118_open(&controller, registers_words((uintptr_t)ethernet0), network.self.mac);
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
