/* cortex_r.c - the functions of every Cortex-R5: frames by the cycle counter, faults, restart (Arm DDI 0460,
 * DDI 0406). */
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

uint32_t board_count(void)
{
    uint32_t n;
    __asm__ volatile("mrc p15, 0, %0, c9, c13, 0" : "=r"(n));
    return n;
}

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

void reset(void);
void cortex_r_fault(void);

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

/* Start-up runs again; drivers reset their devices. Resetting the core itself takes another processor. */
void board_reset(void)
{
    __asm__ volatile("dsb" ::: "memory");
    reset();
    for (;;) { /* not reached */
    }
}

void board_stand(void)
{
    for (;;)
        __asm__ volatile("wfi");
}

/* Semihosting, SYS_EXIT_EXTENDED: without a debugger or emulator it is a fault, so only test programs
 * stop. */
void board_stop(int status)
{
    const uint32_t block[2] = {0x20026, (uint32_t)status}; /* ADP_Stopped_ApplicationExit */
    register uint32_t operation __asm__("r0") = 0x20;
    register const uint32_t *parameter __asm__("r1") = block;
    __asm__ volatile("svc 0x123456" ::"r"(operation), "r"(parameter) : "memory");
    board_stand();
}
