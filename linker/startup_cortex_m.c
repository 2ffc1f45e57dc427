/* startup_cortex_m.c - the code before startup() on any Cortex-M with an FPU: vectors, FPU, a fence under the
 * stack. */
#include <stdint.h>
#include "hal/board/cortex_m.h"
#include "linker/startup.h"

/* Word offsets in the system control space. */
enum { CPACR = 0x88 / 4, MPU_CONTROL = 0x94 / 4, MPU_NUMBER, MPU_BASE, MPU_REGION };

enum {
    FPU_ACCESS = 0xF << 20,
    FENCE_LOG2 = 12, /* bytes of the fence in the linker script: more than any one function's stack */
    REGION_NO_ACCESS = 1 << 28,  /* no reading, writing or execution */
    CONTROL_ON = 1 << 0 | 1 << 2 /* everything else as without an MPU */
};

/* From the linker script. */
extern uint32_t stack_fence[], stack_top[];
extern volatile uint32_t system_control[];

void reset(void);

/* A stack that overflows runs into memory that does not exist for it, whatever the board has there. */
static void raise_fence(void)
{
    system_control[MPU_NUMBER] = 0;
    system_control[MPU_BASE] = (uint32_t)(uintptr_t)stack_fence;
    system_control[MPU_REGION] = REGION_NO_ACCESS | (FENCE_LOG2 - 1) << 1 | 1;
    system_control[MPU_CONTROL] = CONTROL_ON;
    __asm__ volatile("dsb\n isb" ::: "memory");
}

/* The FPU before any code that may use it. */
void reset(void)
{
    system_control[CPACR] |= FPU_ACCESS;
    __asm__ volatile("dsb\n isb" ::: "memory");
    raise_fence();
    startup();
}

struct vectors {
    uint32_t *stack;
    void (*exception[15])(void); /* number 1 is reset */
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {
    stack_top,
    {reset, cortex_m_fault, cortex_m_fault, cortex_m_fault, cortex_m_fault, cortex_m_fault, cortex_m_fault,
     cortex_m_fault, cortex_m_fault, cortex_m_fault, cortex_m_fault, cortex_m_fault, cortex_m_fault,
     cortex_m_fault, cortex_m_tick}};
