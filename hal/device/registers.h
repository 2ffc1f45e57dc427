/* registers.h - a device's registers behind two functions, so that a driver runs on memory and in a test
 * on a model of the device. Offsets are in bytes, as data sheets list them. Cost: one indirect call an
 * access, a fraction of a bus cycle to a peripheral. */
#ifndef HAL_REGISTERS_H
#define HAL_REGISTERS_H

#include <stdint.h>

struct registers {
    uintptr_t context; /* an address, or the model */
    uint32_t (*read)(uintptr_t context, uint32_t offset);
    void (*write)(uintptr_t context, uint32_t offset, uint32_t value);
};

/* Memory-mapped registers of 32 bits, of 16 bits, and of 8 bits side by side. */
struct registers registers_words(uintptr_t address);
struct registers registers_halfwords(uintptr_t address);
struct registers registers_bytes(uintptr_t address);

#endif
