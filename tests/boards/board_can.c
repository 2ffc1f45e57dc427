/* board_can.c - a program for boards with two CAN controllers on the same wires: the plant's end and a
 * bench's end.
 *
 * It checks filters, overrun, frames that come while the board sleeps, and order both ways. Then it runs
 * the session of tests/can/can_session.h; tests/boards/boards.sh compares its lines with those of the
 * host. */
#include <stddef.h>
#include "hal/board/board.h"
#include "hal/board/board_can.h"
#include "hal/board/console.h"
#include "tests/can/can_session.h"

enum { MANY = 2000, BURST = 4, SLEEPS = 15, FLOOD = 100 };
#define FRAME_S 1e-3

static struct can_session session;
static const struct hal *plant, *bench;
static int failed;

static void line(const char *what, uint64_t value, int digits)
{
    console_text(what);
    console_text(" ");
    if (digits)
        console_hex(value, digits);
    else
        console_number(value);
    console_text("\n");
    console_flush();
}

static void check(const char *what, uint64_t got, uint64_t expected)
{
    console_text(got == expected ? "ok " : "FAIL ");
    failed += got != expected;
    line(what, got, 0);
}

static int put(const struct hal *hal, uint32_t id, uint8_t flags, uint32_t n)
{
    struct frame f = {.id = id, .flags = flags, .length = 8};
    for (int i = 0; i < 4; i++)
        f.data[i] = (uint8_t)(n >> 8 * i);
    f.data[7] = 0xA5;
    return hal->send(hal->context, &f);
}

static uint32_t number(const struct frame *f)
{
    return f->data[0] | (uint32_t)f->data[1] << 8 | (uint32_t)f->data[2] << 16 | (uint32_t)f->data[3] << 24;
}

/* ---- the parts ---- */

/* Frames that are not the plant's, and one that is. */
static void filters(void)
{
    struct frame f;
    uint32_t heard = 0, id = 0;
    put(bench, BOARD_CAN_BASE - 1, 0, 1);
    put(bench, BOARD_CAN_BASE + 0x40, 0, 2);
    put(bench, BOARD_CAN_BASE + 1, FRAME_EXTENDED, 3);
    put(bench, (BOARD_CAN_BASE + 1) << 18, FRAME_EXTENDED, 4);
    put(bench, BOARD_CAN_BASE + 2, 0, 5);
    while (plant->recv(plant->context, &f) == 1) {
        heard++;
        id = f.id;
    }
    check("frames of five that pass the filter", heard, 1);
    check("its identifier", id, BOARD_CAN_BASE + 2);
}

static void all_identifiers(void)
{
    struct frame f;
    uint32_t heard = 0, others = 0;
    for (uint32_t id = 0; id < 0x800; id++) {
        put(bench, id, 0, id);
        while (plant->recv(plant->context, &f) == 1) {
            bool ours = f.id == id && f.id - BOARD_CAN_BASE < WIRE_KINDS;
            heard += ours;
            others += !ours;
        }
    }
    check("identifiers of 2048 that come through", heard, WIRE_KINDS);
    check("others", others, 0);
}

/* Nobody listens: the oldest are kept, the loss is told. */
static void overrun(void)
{
    struct frame f;
    uint32_t kept = 0;
    int said;
    for (uint32_t i = 0; i < FLOOD; i++)
        put(bench, BOARD_CAN_BASE, 0, i);
    while ((said = plant->recv(plant->context, &f)) == 1)
        kept += number(&f) == kept;
    line("note kept of a flood", kept, 0);
    check("a loss is told", (uint64_t)-said, HAL_DROPPED);
    check("and counted", board_can_counts(0)->dropped, 1);
}

/* A burst before each of several sleeps, more in all than a controller keeps: none is lost. */
static void sleeping(void)
{
    struct frame f;
    uint32_t sent = 0, heard = 0;
    (void)board_wait(); /* for what went before */
    for (int i = 0; i < SLEEPS; i++) {
        for (int k = 0; k < BURST; k++)
            put(bench, BOARD_CAN_BASE, 0, sent++);
        (void)board_wait();
    }
    while (plant->recv(plant->context, &f) == 1)
        heard += number(&f) == heard;
    check("frames that came while the board slept", heard, sent);
}

static void both_ways(void)
{
    struct frame f;
    uint32_t good = 0;
    for (uint32_t i = 0; i < MANY; i++) {
        put(bench, BOARD_CAN_BASE + i % 16, 0, i);
        put(plant, BOARD_CAN_BASE + 16 + i % 16, 0, ~i);
        good += plant->recv(plant->context, &f) == 1 && number(&f) == i && f.data[7] == 0xA5;
        good +=
            bench->recv(bench->context, &f) == 1 && number(&f) == ~i && f.id == BOARD_CAN_BASE + 16 + i % 16;
    }
    check("frames both ways", good, 2 * MANY);
    check("refused", board_can_counts(0)->refused + board_can_counts(1)->refused, 0);
}

static const char *run(void)
{
    const char *why;
    if (!board_pace(FRAME_S))
        return "the timer cannot pace these frames";
    plant = board_can(0, &why);
    if (plant)
        bench = board_can(1, &why);
    if (!plant || !bench)
        return why;
    filters();
    all_identifiers();
    overrun();
    sleeping();
    both_ways();
    why = can_session_run(&session, plant, bench);
    can_session_report(&session, line);
    return why;
}

int main(void)
{
    const char *why = run();
    if (why) {
        console_text(why);
        console_text("\n");
        console_flush();
    }
    return failed > 0 || why;
}
