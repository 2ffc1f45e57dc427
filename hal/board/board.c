/* board.c - the functions that every board shares: the stack's paint, a stopped clock, the record of a fault,
 * a failed assertion. */
#include "hal/board/board.h"

#include <string.h>
#include "models/check.h"

enum { GUARD_WORDS = 32 };

static const uint32_t paint = 0xA5C35A3Cu, mark = 0xFA017EC0u, watched = 0xD06D06E5u;

/* From the linker script; the stack grows down. */
extern uint32_t stack_bottom[], stack_top[];

/* Valid while both marks stand: what memory holds at power-on has them with a chance of 2^-64. With
 * `watched` in their place a watchdog runs and nothing has failed yet. */
static struct {
    uint32_t begin;
    struct board_fault fault;
    uint32_t starts; /* since the fault */
    uint32_t asleep; /* the program, until a period begins: nothing but the clock is waited for */
    uint32_t end;
} fault_record __attribute__((section(".noinit")));

static bool watching;

void board_stack_paint(const uint32_t *sp)
{
    for (uint32_t *p = stack_bottom; p < sp; p++)
        *p = paint;
}

bool board_stack_intact(void)
{
    bool intact = true;
    for (int i = 0; i < GUARD_WORDS; i++)
        intact = intact && stack_bottom[i] == paint;
    return intact;
}

uint32_t board_stack_bytes(void)
{
    return (uint32_t)((uintptr_t)stack_top - (uintptr_t)stack_bottom);
}

uint32_t board_stack_used(void)
{
    const uint32_t *p = stack_bottom;
    while (p < stack_top && *p == paint)
        p++;
    return (uint32_t)((uintptr_t)stack_top - (uintptr_t)p);
}

/* ---- the clock ---- */

uint32_t board_look(void)
{
    static uint32_t last, still;
    uint32_t count = board_count();
    still = count == last ? still + 1 : 0;
    last = count;
    if (still >= BOARD_STILL_LOOKS)
        board_fail(&(struct board_fault){.kind = BOARD_CLOCK});
    return count;
}

bool board_clock_runs(void)
{
    uint32_t first = board_count();
    for (uint32_t i = 0; i < BOARD_STILL_LOOKS; i++)
        if (board_count() != first)
            return true;
    return false;
}

/* ---- faults ---- */

static bool marked(uint32_t with)
{
    return fault_record.begin == with && fault_record.end == with;
}

static void keep(const struct board_fault *f)
{
    fault_record.fault = *f;
    fault_record.starts = 0;
    fault_record.begin = fault_record.end = mark;
}

void board_fail(const struct board_fault *f)
{
    if (!marked(mark))
        keep(f);
    board_reset();
}

void board_fail_exception(const uint32_t *sp, uint32_t address, uint32_t cause)
{
    struct board_fault f = {.kind = BOARD_EXCEPTION, .address = address, .cause = cause};
    if (sp < stack_bottom || sp > stack_top)
        f.kind = BOARD_STACK;
    board_fail(&f);
}

void board_sleeps(bool asleep)
{
    fault_record.asleep = asleep;
}

uint32_t board_starved(void)
{
    return fault_record.asleep ? BOARD_CLOCK : BOARD_WATCHDOG;
}

bool board_take_fault(struct board_fault *f, uint32_t *starts)
{
    if (marked(watched))
        keep(&(struct board_fault){.kind = board_starved()});
    if (!marked(mark))
        return false;
    *f = fault_record.fault;
    *starts = ++fault_record.starts;
    return true;
}

void board_forget_fault(void)
{
    fault_record.begin = fault_record.end = watching ? watched : 0;
}

void board_watched(void)
{
    watching = true;
    board_sleeps(false);
    if (!marked(mark))
        board_forget_fault();
}

void check_failed(const char *file, int line)
{
    struct board_fault f = {.kind = BOARD_ASSERT, .line = (uint32_t)line};
    const char *from = file;
    for (const char *c = file; *c != '\0'; c++)
        if (c - from >= BOARD_FILE - 1)
            from++;
    for (int i = 0; from[i] != '\0'; i++)
        f.file[i] = from[i];
    board_fail(&f);
}
