/* board_riscv_virt.c - QEMU's RISC-V machine `virt` with Kvaser PCIcan cards: console on its UART, bus on
 * the first card. The linker script has the addresses. */
#include <stddef.h>
#include "hal/board/board.h"
#include "hal/board/board_can.h"
#include "hal/device/i6300esb.h"
#include "hal/can/kvaser_pci.h"
#include "hal/board/riscv.h"
#include "hal/can/sja1000.h"
#include "hal/device/uart_16550.h"

enum { UART_DIVIDER = 2 }; /* 115200 baud from 3.6864 MHz */

/* The interrupt controller (PLIC), hart 0 in machine mode. PCI has four of its sources. */
enum { PRIORITY = 0, ENABLED = 0x2000, CLAIM = 0x200004, PCI_FIRST = 32, PCI_SOURCES = 4 };

extern uint32_t uart0[], interrupts[], pci_io[], pci_config[], pci_memory[];

static struct sja1000 controller[BOARD_CANS];
static int n_open;
static bool watching;

bool board_put(char c)
{
    static bool open;
    struct registers r = registers_bytes((uintptr_t)uart0);
    if (!open)
        uart_16550_open(r, UART_DIVIDER);
    open = true;
    return uart_16550_put(r, c);
}

static void serve(void)
{
    struct registers plic = registers_words((uintptr_t)interrupts);
    uint32_t source = plic.read(plic.context, CLAIM);
    for (int i = 0; i < n_open; i++)
        sja1000_service(&controller[i]);
    plic.write(plic.context, CLAIM, source);
}

static void enable_interrupts(void)
{
    struct registers plic = registers_words((uintptr_t)interrupts);
    for (uint32_t i = 0; i < PCI_SOURCES; i++)
        plic.write(plic.context, PRIORITY + 4 * (PCI_FIRST + i), 1);
    plic.write(plic.context, ENABLED + 4 * (PCI_FIRST / 32), (1u << PCI_SOURCES) - 1);
    riscv_serve_by(serve);
}

const struct hal *board_can(int i, const char **why)
{
    const struct sja1000_config c = {.can = {.timing = {2, 5, 2, 1}, /* 8 quanta of 125 ns, sampled after 6 */
                                             .base_id = BOARD_CAN_BASE,
                                             .restart_us = BOARD_CAN_RESTART_US,
                                             .now_us = board_hal_now_us},
                                     .output = KVASER_PCI_OUTPUT};
    struct registers r;
    *why = "no Kvaser PCIcan card";
    if (!kvaser_pci_open(i, (uintptr_t)pci_config, (uintptr_t)pci_io, &r))
        return NULL;
    *why = sja1000_open(&controller[i], r, &c);
    if (*why)
        return NULL;
    n_open = i + 1;
    enable_interrupts();
    return &controller[i].hal;
}

const struct can *board_can_counts(int i)
{
    return &controller[i].can;
}

/* The machine has a watchdog if a 6300ESB is plugged in. */
bool board_watch(void)
{
    watching = i6300esb_open((uintptr_t)pci_config, (uintptr_t)pci_memory, 1000 * BOARD_WATCHDOG_S);
    if (watching)
        board_watched();
    return watching;
}

static void healthy(void *context)
{
    (void)context;
    if (watching)
        i6300esb_feed((uintptr_t)pci_memory);
}

const struct hal *board_bus(const char **why)
{
    static struct hal bus;
    const struct hal *can = board_can(0, why);
    if (!can)
        return NULL;
    bus = *can;
    bus.healthy = healthy;
    return &bus;
}
