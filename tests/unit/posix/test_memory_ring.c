/* test_memory_ring.c - how a reader waits for a writer on its own processor, on another one, and on one that
 * is not told. A look at a ring of these tests ends in vain: no time is judged. */
#include <sched.h>
#include <string.h>
#include "hal/posix/memory_ring.h"
#include "tests/unit/test.h"

static struct memory_ring ring;
static struct memory_wait waits;
static cpu_set_t allowed;

/* A new ring, and this process stays on the processor where it is: that one, plus 1. */
static uint32_t open_on_one(void)
{
    cpu_set_t one;
    int processor = sched_getcpu();
    memset(&ring, 0, sizeof ring);
    memset(&waits, 0, sizeof waits);
    CPU_ZERO(&one);
    CPU_SET(processor, &one);
    check_int("the processors that are allowed", sched_getaffinity(0, sizeof allowed, &allowed), 0);
    check_int("one of them from now on", sched_setaffinity(0, sizeof one, &one), 0);
    return (uint32_t)processor + 1;
}

static void close_on_one(void)
{
    check_int("all of them again", sched_setaffinity(0, sizeof allowed, &allowed), 0);
}

static void await(bool comes)
{
    check_int("a packet", memory_ring_await(&ring, &waits, 0), comes);
}

TEST(memory_ring_patience)
{
    check_int("on one processor, ns", memory_ring_patience_ns(2, 2), 0);
    check_int("on two", memory_ring_patience_ns(1, 2), 400000);
    check_int("a writer that tells no processor", memory_ring_patience_ns(0, 2), 20000);
    check_int("a system that tells none", memory_ring_patience_ns(1, 0), 20000);
}

TEST(memory_ring_tells_processor)
{
    uint32_t own = open_on_one();
    check_int("before the first packet, none is told", ring.processor, 0);
    check_int("a packet", memory_ring_put(&ring, "", 0), true);
    check_int("the processor of its writer, plus 1", ring.processor, own);
    check_int("the line of the cache of its reader has nothing of it", ring.taken + ring.asleep, 0);
    close_on_one();
}

/* On one processor no look can find anything: none was in vain. */
TEST(memory_ring_same_processor)
{
    ring.processor = open_on_one();
    for (uint32_t i = 0; i < 200; i++)
        await(false);
    check_int("sleeps", waits.sleeps, 200);
    check_int("looks in vain", waits.in_vain, 0);
    check_int("waits that would not look on another processor", waits.at_once, 0);
    close_on_one();
}

/* On another one, a wait after a look in vain sleeps at once, then 3, 7, 15, 31 and 63 do; not for ever,
 * since two that sleep for each other stay so. A packet ends it. */
TEST(memory_ring_other_processor)
{
    ring.processor = open_on_one() + 1;
    for (uint32_t rest = 1; rest <= 63; rest = 2 * rest + 1) {
        await(false);
        check_int("waits to come that sleep at once", waits.at_once, rest);
        for (uint32_t i = 0; i < rest; i++)
            await(false);
        check_int("all of them did", waits.at_once, 0);
    }
    await(false);
    check_int("63 are the most", waits.at_once, 63);
    check_int("sleeps", waits.sleeps, 6 + 120 + 1);
    memory_ring_put(&ring, "", 0);
    await(true);
    check_int("a packet that is there costs no sleep", waits.sleeps, 127);
    close_on_one();
}
