/* startup_cortex_r.c - the code before startup() on a Cortex-R5F: vectors, FPU, a fence under the stack (Arm
 * DDI 0460; DDI 0406, part B). Interrupts stay off: the firmware polls. Caches stay as the loader left
 * them. */
#include <stdint.h>
#include "hal/board/cortex_r.h"
#include "linker/startup.h"

enum {
    VECTORS = 16, /* words: eight instructions, and addresses that they load */
    FENCE_LOG2 = 12,
    REGION_ON = (FENCE_LOG2 - 1) << 1 | 1,
    REGION_NO_ACCESS = 1 << 12, /* nor execution */
    CONTROL_MPU = 1 << 0,
    CONTROL_BACKGROUND = 1 << 17, /* everything else as without an MPU */
    CONTROL_VECTORS_HIGH = 1 << 13,
    FPU_ACCESS = 0xF << 20,
    FPU_ON = 1 << 30
};

/* From the linker script. */
extern uint32_t stack_fence[];
extern volatile uint32_t exception_vectors[];

void reset(void);
void cortex_r_start(void);

/* The first word of the image, and again at the address where the processor looks for vectors. */
__attribute__((naked, section(".vectors"), used)) void reset(void)
{
    __asm__ volatile("ldr pc, 1f\n"
                     "ldr pc, 2f\n ldr pc, 2f\n ldr pc, 2f\n ldr pc, 2f\n"
                     "ldr pc, 2f\n ldr pc, 2f\n ldr pc, 2f\n"
                     "1: .word cortex_r_entry\n"
                     "2: .word cortex_r_fault\n");
}

/* Also where a restart begins. Supervisor mode, interrupts off, MPU off. */
__attribute__((naked, used)) static void cortex_r_entry(void)
{
    __asm__ volatile("cpsid if, #0x13\n"
                     "mrc p15, 0, r0, c1, c0, 0\n"
                     "bic r0, r0, %0\n"
                     "mcr p15, 0, r0, c1, c0, 0\n"
                     "mrc p15, 0, r0, c1, c0, 2\n"
                     "orr r0, r0, %1\n"
                     "mcr p15, 0, r0, c1, c0, 2\n"
                     "isb\n"
                     "mov r0, %2\n"
                     "vmsr fpexc, r0\n"
                     "ldr sp, =stack_top\n"
                     "b cortex_r_start\n"
                     ".ltorg\n" ::"i"(CONTROL_MPU),
                     "i"(FPU_ACCESS), "i"(FPU_ON));
}

static void raise_fence(void)
{
    uint32_t control;
    __asm__ volatile("mcr p15, 0, %0, c6, c2, 0" ::"r"(0)); /* region 0: base, access, size */
    __asm__ volatile("mcr p15, 0, %0, c6, c1, 0" ::"r"(stack_fence));
    __asm__ volatile("mcr p15, 0, %0, c6, c1, 4" ::"r"(REGION_NO_ACCESS));
    __asm__ volatile("mcr p15, 0, %0, c6, c1, 2" ::"r"(REGION_ON));
    __asm__ volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(control));
    control = (control & ~(uint32_t)CONTROL_VECTORS_HIGH) | CONTROL_MPU | CONTROL_BACKGROUND;
    __asm__ volatile("dsb\n mcr p15, 0, %0, c1, c0, 0\n isb" ::"r"(control) : "memory");
}

__attribute__((noinline)) void cortex_r_start(void)
{
    const uint32_t *from = (const uint32_t *)(uintptr_t)reset;
    for (int i = 0; i < VECTORS; i++)
        exception_vectors[i] = from[i];
    raise_fence();
    startup();
}
