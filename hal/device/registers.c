/* registers.c - a device's registers as memory; see registers.h. */
#include "hal/device/registers.h"

static uint32_t read_word(uintptr_t context, uint32_t offset)
{
    return *(volatile uint32_t *)(context + offset);
}

static void write_word(uintptr_t context, uint32_t offset, uint32_t value)
{
    *(volatile uint32_t *)(context + offset) = value;
}

static uint32_t read_halfword(uintptr_t context, uint32_t offset)
{
    return *(volatile uint16_t *)(context + offset);
}

static void write_halfword(uintptr_t context, uint32_t offset, uint32_t value)
{
    *(volatile uint16_t *)(context + offset) = (uint16_t)value;
}

static uint32_t read_byte(uintptr_t context, uint32_t offset)
{
    return *(volatile uint8_t *)(context + offset);
}

static void write_byte(uintptr_t context, uint32_t offset, uint32_t value)
{
    *(volatile uint8_t *)(context + offset) = (uint8_t)value;
}

struct registers registers_words(uintptr_t address)
{
    return (struct registers){address, read_word, write_word};
}

struct registers registers_halfwords(uintptr_t address)
{
    return (struct registers){address, read_halfword, write_halfword};
}

struct registers registers_bytes(uintptr_t address)
{
    return (struct registers){address, read_byte, write_byte};
}
