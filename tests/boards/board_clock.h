/* board_clock.h - stops the counter that paces a board's frames, where it can be stopped, or the interrupt of
 * the timer that ends its sleeps. */
#ifndef TESTS_BOARD_CLOCK_H
#define TESTS_BOARD_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

#if defined(__ARM_ARCH) && __ARM_ARCH_PROFILE == 'M'
/* MPS2: the prescaler, word 7, makes one count last 86 s. */
extern volatile uint32_t fpga_io[], systick[];
static inline bool board_clock_stop(void)
{
    fpga_io[7] = 0x7FFFFFFF;
    return true;
}
/* SysTick's control, bit TICKINT. */
static inline void board_clock_mute(void)
{
    systick[0] &= ~(uint32_t)2;
}
#elif defined(__ARM_ARCH)
/* Cortex-R5: PMCNTENCLR, the cycle counter. */
static inline bool board_clock_stop(void)
{
    __asm__ volatile("mcr p15, 0, %0, c9, c12, 2" ::"r"(1u << 31));
    return true;
}
#else
/* RISC-V: nothing stops the machine timer. */
static inline bool board_clock_stop(void)
{
    return false;
}
/* mie, bit MTIE. */
static inline void board_clock_mute(void)
{
    __asm__ volatile("csrc mie, %0" ::"r"(1 << 7));
}
#endif

#endif
