/* cortex_m.c - the functions of every Cortex-M: frames by a counter of the board, sleep until SysTick,
 * faults (Armv7-M ARM, part B).
 *
 * SysTick only ends a sleep. An interrupt that waits while another one comes is one interrupt, so counting
 * them would lose periods in silence; the counter loses none in 2^32 counts. The watchdog's interrupt is the
 * NMI. */
#include "hal/board/cortex_m.h"

#include "hal/board/board.h"
#include "models/check.h"

/* The private peripheral bus; the linker script places them. */
extern volatile uint32_t systick[], system_control[];

/* Word offsets. */
enum { SYSTICK_CONTROL, SYSTICK_RELOAD, SYSTICK_VALUE };
enum { CONTROL_ENABLE = 1, CONTROL_INTERRUPT = 2, CONTROL_CORE_CLOCK = 4, RELOAD_MAX = 0xFFFFFF };
enum {
    SCB_FAULT_STATUS = 0x28 / 4, /* CFSR */
    NMI = 2,                     /* number of the exception */
    FAULT_STACK_WORDS = 128
};

enum { CYCLES_PER_US = BOARD_CLOCK_HZ / 1000000 };

static uint32_t cycles; /* in a period */
static uint32_t begun_at, last;
static uint64_t passed; /* cycles until `last` */

/* The end of a sleep is all that it is for. */
void cortex_m_tick(void)
{
}

/* ---- time ---- */

/* The counter's periods begin a few cycles before SysTick's, so a sleep never ends too early. */
bool board_pace(double frame_s)
{
    double exact = frame_s * BOARD_CLOCK_HZ + 0.5;
    if (!(exact >= 1.0 && exact <= RELOAD_MAX) || !board_clock_runs())
        return false;
    cycles = (uint32_t)exact;
    passed = 0;
    systick[SYSTICK_RELOAD] = cycles - 1;
    begun_at = last = board_count();
    systick[SYSTICK_VALUE] = 0;
    systick[SYSTICK_CONTROL] = CONTROL_ENABLE | CONTROL_INTERRUPT | CONTROL_CORE_CLOCK;
    return true;
}

/* In an emulator a sleep lasts until the host has time, and the board rightly counts the periods that it
 * missed. Tests that need every frame in its period have images that spin a while instead (make firmware
 * WAIT=spin). */
static void sleep_or_spin(void)
{
#ifdef BOARD_SPIN
    for (volatile int i = 0; i < BOARD_SPIN; i++) {
    }
#else
    __asm__ volatile("dsb\n wfi" ::: "memory");
#endif
}

/* WFI also wakes for an interrupt that is masked, so none can slip in between the look and the sleep. */
uint32_t board_wait(void)
{
    uint32_t since;
    while ((since = board_look() - begun_at) < cycles) { /* bounded by board_look, a sleep by the watchdog */
        __asm__ volatile("cpsid i" ::: "memory");
        board_sleeps(true);
        if (board_count() - begun_at < cycles)
            sleep_or_spin();
        board_sleeps(false);
        __asm__ volatile("cpsie i\n isb" ::: "memory");
    }
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
extern uint32_t stack_bottom[], stack_top[];

/* `frame` is the stack at the exception, if it is one: r0-r3, r12, lr, pc, psr. */
static __attribute__((noreturn, used)) void fail(const uint32_t *frame)
{
    uint32_t exception;
    __asm__ volatile("mrs %0, ipsr" : "=r"(exception));
    struct board_fault f = {.kind = exception == NMI ? board_starved() : BOARD_EXCEPTION,
                            .cause = system_control[SCB_FAULT_STATUS]};
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
