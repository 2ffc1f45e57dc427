/* startup_riscv.c - the code before startup() on a 64-bit RISC-V hart in machine mode: FPU, trap vector, a
 * fence under the stack (The RISC-V Instruction Set Manual, volume II: 3.1.6, 3.1.7, 3.7). Interrupts stay
 * off: they only end a sleep. */
#include <stdint.h>
#include "hal/board/riscv.h"
#include "linker/startup.h"

enum {
    FLOAT_ON = 1 << 13, /* mstatus.FS: initial */
    FENCE_BYTES = 4096,
    FENCE = 1 << 7 | 3 << 3 /* locked, power of two, no reading, writing or execution; for machine mode too */
};

/* From the linker script. */
extern uint32_t stack_fence[];

void reset(void);
void riscv_start(void);

/* The first word of the image. One hart runs, any other sleeps. */
__attribute__((naked, section(".vectors"), used)) void reset(void)
{
    __asm__ volatile("csrr t0, mhartid\n"
                     "1: beqz t0, 2f\n"
                     "wfi\n"
                     "j 1b\n"
                     "2: li t0, %0\n"
                     "csrs mstatus, t0\n"
                     "csrw fcsr, zero\n"
                     "la t0, riscv_trap\n"
                     "csrw mtvec, t0\n"
                     "la sp, stack_top\n"
                     "j riscv_start\n" ::"i"(FLOAT_ON));
}

__attribute__((noinline)) void riscv_start(void)
{
    uintptr_t region = (uintptr_t)stack_fence >> 2 | (FENCE_BYTES / 8 - 1);
    __asm__ volatile("csrw pmpaddr0, %0\n csrw pmpcfg0, %1" ::"r"(region), "r"((uintptr_t)FENCE));
    startup();
}
