/* test_i6300esb.c - the watchdog's driver on memory in the place of a PCI bus and of the card's registers
 * (Intel 300641, chapter 16). */
#include <string.h>
#include "hal/device/i6300esb.h"
#include "tests/unit/test.h"

enum { SLOT_WORDS = 1 << 13, SLOTS = 32 }; /* ECAM: 32 kB a slot */
static uint32_t pci_config[SLOTS][SLOT_WORDS], card_registers[4];

TEST(i6300esb)
{
    enum { AT = 5 };
    memset(pci_config, 0xFF, sizeof pci_config); /* empty slots */
    memset(card_registers, 0, sizeof card_registers);
    check_true("none on the bus", !i6300esb_open((uintptr_t)pci_config, (uintptr_t)card_registers, 3000));
    check_hex("  and nothing is written", pci_config[AT][1], 0xFFFFFFFF);
    check_hex("  nothing there either", card_registers[3], 0);
    memset(pci_config[AT], 0, sizeof pci_config[AT]);
    pci_config[AT][0] = 0x25AB8086;
    check_true("in slot 5", i6300esb_open((uintptr_t)pci_config, (uintptr_t)card_registers, 3000));
    check_hex("base address", pci_config[AT][4], (uint32_t)(uintptr_t)card_registers);
    check_hex("it answers to memory accesses", pci_config[AT][1] & 2, 2);
    check_hex("WDT configuration: no interrupt (1:0), 1 kHz (2), the reset is let through (5)",
              pci_config[AT][0x60 / 4] & 0x27, 3);
    check_hex("WDT lock: on (1), to be stopped again (0)", pci_config[AT][0x68 / 4] & 3, 2);
    check_int("both stages together, ms", card_registers[0] + card_registers[1], 3000);
    check_hex("the last write unlocked a preload", card_registers[3] & 0xFF, 0x86);
    i6300esb_feed((uintptr_t)card_registers);
    check_hex("reload (8)", card_registers[3] & 0x100, 0x100);
    check_int("the stages stay, ms", card_registers[0] + card_registers[1], 3000);
}
