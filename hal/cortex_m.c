/* cortex_m.c - what every Cortex-M does alike: frames by SysTick and WFI, faults, restart (Armv7-M ARM, part B). */
#include "hal/board.h"

#include "firmware/check.h"

/* The private peripheral bus; the linker script places them. */
extern volatile uint32_t systick[], system_control[];

/* Word offsets. */
enum { SYSTICK_CONTROL, SYSTICK_RELOAD, SYSTICK_VALUE };
enum { CONTROL_ENABLE = 1, CONTROL_INTERRUPT = 2, CONTROL_CORE_CLOCK = 4, RELOAD_MAX = 0xFFFFFF };
enum {
    SCB_RESET = 0x0C / 4,        /* AIRCR */
    SCB_FAULT_STATUS = 0x28 / 4, /* CFSR */
    RESET_REQUEST = 0x05FA0004,
    READ_TRIES = 4,
    FAULT_STACK_WORDS = 128
};

enum { CYCLES_PER_US = BOARD_CLOCK_HZ / 1000000 };

static volatile uint32_t begun; /* periods; the interrupt counts */
static uint32_t waited_for, cycles;

void cortex_m_tick(void);
void cortex_m_fault(void);

void cortex_m_tick(void)
{
    begun++;
}

/* ---- time ---- */

bool board_pace(double frame_s)
{
    double exact = frame_s * BOARD_CLOCK_HZ + 0.5;
    if (!(exact >= 1.0 && exact <= RELOAD_MAX))
        return false;
    cycles = (uint32_t)exact;
    begun = waited_for = 0;
    systick[SYSTICK_RELOAD] = cycles - 1;
    systick[SYSTICK_VALUE] = 0;
    systick[SYSTICK_CONTROL] = CONTROL_ENABLE | CONTROL_INTERRUPT | CONTROL_CORE_CLOCK;
    return true;
}

/* WFI also wakes for an interrupt that is masked, so none can slip in between the look and the sleep. */
uint32_t board_wait(void)
{
    while (begun == waited_for) { /* bounded by the timer */
        __asm__ volatile("cpsid i" ::: "memory");
        if (begun == waited_for)
            __asm__ volatile("dsb\n wfi" ::: "memory");
        __asm__ volatile("cpsie i\n isb" ::: "memory");
    }
    uint32_t periods = begun - waited_for;
    waited_for += periods;
    return periods;
}

uint32_t board_late_us(void)
{
    return (cycles - 1 - systick[SYSTICK_VALUE]) / CYCLES_PER_US;
}

/* A period may begin between the two readings: then read again. */
uint32_t board_now_us(void)
{
    uint32_t periods = begun, late_us = board_late_us();
    for (int i = 0; i < READ_TRIES && periods != begun; i++) {
        periods = begun;
        late_us = board_late_us();
    }
    return (uint32_t)((uint64_t)periods * cycles / CYCLES_PER_US) + late_us;
}

/* ---- faults ---- */

static uint32_t fault_stack[FAULT_STACK_WORDS] __attribute__((used, aligned(8)));
extern uint32_t stack_bottom[], stack_top[];

/* `frame` is the stack at the exception, if it is one: r0-r3, r12, lr, pc, psr. */
static __attribute__((noreturn, used)) void fail(const uint32_t *frame)
{
    struct board_fault f = {.kind = BOARD_EXCEPTION, .cause = system_control[SCB_FAULT_STATUS]};
    if (frame >= stack_bottom && frame + 8 <= stack_top)
        f.address = frame[6];
    else
        f.kind = BOARD_STACK; /* it ran over its end into nothing */
    board_fail(&f);
    for (;;) { /* not reached */
    }
}

/* The stack may be what is broken: the handler has one of its own. */
__attribute__((naked)) void cortex_m_fault(void)
{
    __asm__ volatile("mov r0, sp\n"
                     "ldr r1, =fault_stack + %c0\n"
                     "mov sp, r1\n"
                     "b fail\n" ::"i"(4 * FAULT_STACK_WORDS));
}

void board_reset(void)
{
    __asm__ volatile("dsb" ::: "memory");
    system_control[SCB_RESET] = RESET_REQUEST;
    for (;;)
        __asm__ volatile("wfi");
}

/* Semihosting, SYS_EXIT_EXTENDED: without a debugger or emulator it is a fault, so only test programs stop. */
void board_stop(int status)
{
    const uint32_t block[2] = {0x20026, (uint32_t)status}; /* ADP_Stopped_ApplicationExit */
    register uint32_t operation __asm__("r0") = 0x20;
    register const uint32_t *parameter __asm__("r1") = block;
    __asm__ volatile("bkpt 0xab" ::"r"(operation), "r"(parameter) : "memory");
    for (;;)
        __asm__ volatile("wfi");
}
