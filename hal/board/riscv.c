/* riscv.c - the functions of every RISC-V hart with a machine timer: frames by that timer and WFI, faults,
 * restart (The RISC-V Instruction Set Manual, volume II, 3.1 and 3.2). */
#include "hal/board/riscv.h"

#include "hal/board/board.h"

enum {
    COUNTS_PER_US = BOARD_CLOCK_HZ / 1000000,
    TIMER_INTERRUPT = 1 << 7, /* bit of mie and mip */
    EXTERNAL_INTERRUPT = 1 << 11,
    FAULT_STACK_BYTES = 1024
};
#define PERIOD_MAX 1e9 /* counts */

/* From the linker script. */
extern volatile uint64_t machine_timer[], machine_timer_compare[];

static uint64_t counts; /* in a period */
static uint64_t started, begun_at;
static void (*serve_devices)(void);

/* ---- time ---- */

/* All 64 bits of what board_look looks at. */
static uint64_t look(void)
{
    (void)board_look();
    return machine_timer[0];
}

bool board_pace(double frame_s)
{
    double exact = frame_s * BOARD_CLOCK_HZ + 0.5;
    if (!(exact >= 1.0 && exact <= PERIOD_MAX))
        return false;
    counts = (uint64_t)exact;
    started = begun_at = machine_timer[0];
    __asm__ volatile("csrs mie, %0" ::"r"(TIMER_INTERRUPT | EXTERNAL_INTERRUPT));
    return board_clock_runs();
}

/* WFI ends with an interrupt that is pending, though none is taken: no look at the timer is too early. */
uint32_t board_wait(void)
{
    machine_timer_compare[0] = begun_at + counts;
    uint64_t since;
    while ((since = look() - begun_at) < counts) { /* bounded by board_look, a sleep by the watchdog */
        uintptr_t pending;
        board_sleeps(true);
        __asm__ volatile("wfi\n csrr %0, mip" : "=r"(pending)::"memory");
        board_sleeps(false);
        if ((pending & EXTERNAL_INTERRUPT) && serve_devices)
            serve_devices();
    }
    uint64_t periods = since / counts;
    begun_at += periods * counts;
    return (uint32_t)periods;
}

uint32_t board_late_us(void)
{
    return (uint32_t)((look() - begun_at) / COUNTS_PER_US);
}

uint32_t board_now_us(void)
{
    return (uint32_t)((look() - started) / COUNTS_PER_US);
}

void riscv_serve_by(void (*serve)(void))
{
    serve_devices = serve;
}

/* ---- faults ---- */

static uint8_t fault_stack[FAULT_STACK_BYTES] __attribute__((used, aligned(16)));

static __attribute__((noreturn, used)) void fail(const uint32_t *sp)
{
    uintptr_t address, cause;
    __asm__ volatile("csrr %0, mepc\n csrr %1, mcause" : "=r"(address), "=r"(cause));
    board_fail_exception(sp, (uint32_t)address, (uint32_t)cause);
    for (;;) { /* not reached */
    }
}

/* The stack may be what is broken: the handler has one of its own. */
__attribute__((naked, aligned(4))) void riscv_trap(void)
{
    __asm__ volatile("mv a0, sp\n"
                     "la sp, fault_stack + %0\n"
                     "j fail\n" ::"i"(FAULT_STACK_BYTES));
}
