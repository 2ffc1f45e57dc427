/* board_cost.c - a program for boards that counts instructions.
 *
 * It counts each piece of tests/bench/cost/work_pieces.h, the longest tick of each motion of
 * tests/bench/cost/worst_cases.h, and the self-test. It prints lines of "NAME instructions", with a tenth
 * at the end. It is for an emulator whose clock takes 1.024 us an instruction (QEMU: -icount shift=10). So
 * the counts are exact but for the timer's interrupt, twice a second. */
#include "firmware/app/selftest.h"
#include "hal/board/board.h"
#include "hal/board/console.h"
#include "models/models.h"
#include "tests/bench/cost/work_pieces.h"
#include "tests/bench/cost/worst_cases.h"

#define INSTRUCTION_US 1.024
#define PERIOD_S       0.5 /* period of the timer: long, within every board's range */

enum { LOOK_EVERY = 25 /* calls */ };

static struct rate_run run;

static void nothing(void)
{
}

/* Microseconds of WORK_CALLS calls. A board's clock may have to be looked at every few seconds. */
static uint32_t calls_us(void (*volatile once)(void))
{
    uint32_t begin_us = board_now_us();
    for (int i = 0; i < WORK_CALLS; i++) {
        if (i % LOOK_EVERY == 0)
            (void)board_now_us();
        once();
    }
    return board_now_us() - begin_us;
}

static void tell(const char *name, double instructions)
{
    uint64_t tenths = (uint64_t)(10.0 * instructions + 0.5);
    console_text(name);
    console_text(" ");
    console_number(tenths / 10);
    console_text(".");
    console_number(tenths % 10);
    console_text("\n");
    console_flush();
}

static void tell_pieces(void)
{
    uint32_t loop_us = calls_us(nothing);
    for (int i = 0; i < WORK_PIECES && !work_fault; i++) {
        work_setup(i);
        double us = calls_us(work_piece[i].once) - loop_us;
        work_check(i);
        tell(work_piece[i].name, us / (INSTRUCTION_US * WORK_CALLS));
    }
}

/* The longest tick, to an instruction or two. */
static void tell_worst(const struct worst_case *w)
{
    uint32_t longest_us = 0;
    if (rate_start(&run, &w->motion, &w->setting, false))
        work_fault = w->motion.name;
    for (int i = 0; i < WORST_PERIODS * w->setting.steps && !work_fault; i++) {
        uint32_t begin_us = board_now_us();
        if (!rate_advance(&run, &w->motion, 1))
            work_fault = w->motion.name;
        uint32_t us = board_now_us() - begin_us;
        longest_us = us > longest_us ? us : longest_us;
    }
    tell(w->motion.name, longest_us / INSTRUCTION_US);
}

/* Check by check: as a whole it takes longer than some board's clock may go unseen. */
static void tell_selftest(void)
{
    static struct plant plant;
    static double scratch[METHOD_SCRATCH];
    const struct selftest_parts parts = {model_table, MODELS,  method_table,  METHODS,
                                         &plant,      scratch, METHOD_SCRATCH};
    uint32_t begin_us = board_now_us();
    for (int i = 0; i < SELFTEST_CHECKS; i++) {
        double value;
        if (!selftest_measure(&selftest_table[i], &parts, &value))
            work_fault = selftest_table[i].name;
        (void)board_now_us();
    }
    tell("self_test", (board_now_us() - begin_us) / INSTRUCTION_US);
}

int main(void)
{
    if (!board_pace(PERIOD_S))
        return 1;
    tell_pieces();
    for (int i = 0; i < WORST_CASES && !work_fault; i++)
        tell_worst(&worst_case[i]);
    if (!work_fault)
        tell_selftest();
    if (work_fault) {
        console_text("not what it should be: ");
        console_text(work_fault);
        console_text("\n");
        console_flush();
    }
    return work_fault != 0;
}
