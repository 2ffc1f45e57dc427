/* cortex_r.c - the functions of every Cortex-R5: frames by the cycle counter, faults, restart (Arm DDI 0460,
 * DDI 0406). */
#include "hal/board/cortex_r.h"

#include "hal/board/board.h"

enum {
    COUNTERS_ON = 1 << 0 | 1 << 2, /* PMCR: enable, cycle counter from 0 */
    CYCLES_PER_US = BOARD_CLOCK_HZ / 1000000,
    FAULT_STACK_WORDS = 128
};
#define PERIOD_MAX 1e9 /* cycles: the counter must not pass it between two looks */

static uint32_t cycles; /* in a period */
static uint32_t begun_at, last;
static uint64_t passed; /* cycles until `last` */

/* ---- time ---- */

bool board_pace(double frame_s)
{
    double exact = frame_s * BOARD_CLOCK_HZ + 0.5;
    if (!(exact >= 1.0 && exact <= PERIOD_MAX))
        return false;
    cycles = (uint32_t)exact;
    __asm__ volatile("mcr p15, 0, %0, c9, c12, 0" ::"r"(COUNTERS_ON));
    __asm__ volatile("mcr p15, 0, %0, c9, c12, 1" ::"r"(1u << 31)); /* PMCNTENSET: the cycle counter */
    begun_at = last = board_count();
    passed = 0;
    return board_clock_runs();
}

/* Looks at the counter: no interrupt is needed, and none is missed. */
uint32_t board_wait(void)
{
    uint32_t since;
    do
        since = board_look() - begun_at; /* bounded by board_look */
    while (since < cycles);
    uint32_t periods = since / cycles;
    begun_at += periods * cycles;
    return periods;
}

uint32_t board_late_us(void)
{
    return (board_look() - begun_at) / CYCLES_PER_US;
}

uint32_t board_now_us(void)
{
    uint32_t now = board_look();
    passed += now - last;
    last = now;
    return (uint32_t)(passed / CYCLES_PER_US);
}

/* ---- faults ---- */

static uint32_t fault_stack[FAULT_STACK_WORDS] __attribute__((used, aligned(8)));

/* The stack pointer of the program and, within 8 bytes, the address of its instruction. */
static __attribute__((noreturn, used)) void fail(const uint32_t *sp, uint32_t address)
{
    uint32_t cause;
    __asm__ volatile("mrc p15, 0, %0, c5, c0, 0" : "=r"(cause)); /* DFSR */
    board_fail_exception(sp, address - 8, cause);
    for (;;) { /* not reached */
    }
}

/* The exception's mode has no stack of its own, and the program's may be what is broken. */
__attribute__((naked)) void cortex_r_fault(void)
{
    __asm__ volatile("mov r1, lr\n"
                     "cps #0x13\n"
                     "mov r0, sp\n"
                     "ldr sp, =fault_stack + %c0\n"
                     "b fail\n"
                     ".ltorg\n" ::"i"(4 * FAULT_STACK_WORDS));
}
