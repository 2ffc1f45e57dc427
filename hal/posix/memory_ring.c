/* memory_ring.c - a ring of packets between two processes; see memory_ring.h. */
#include "hal/posix/memory_ring.h"

#include <linux/futex.h>
#include <sched.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>
#include "hal/posix/clock.h"

enum {
    LOOKS = 16,        /* from one look at the clock to the next */
    AT_ONCE_MOST = 63, /* waits that sleep at once after looks in vain: 2^n - 1 */
    UNKNOWN_NS = 20000,
    APART_NS = 400000
};

static uint32_t load(const uint32_t *at)
{
    return __atomic_load_n(at, __ATOMIC_SEQ_CST);
}

static void store(uint32_t *at, uint32_t value)
{
    __atomic_store_n(at, value, __ATOMIC_SEQ_CST);
}

static void pause_a_look(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

/* The caller's processor, plus 1; 0: not known. */
static uint32_t processor_now(void)
{
    return (uint32_t)(sched_getcpu() + 1);
}

bool memory_ring_put(struct memory_ring *r, const void *bytes, uint32_t n)
{
    uint32_t written = load(&r->written);
    if (written - load(&r->taken) >= MEMORY_SLOTS)
        return false;
    r->slot[written % MEMORY_SLOTS].n = n;
    memcpy(r->slot[written % MEMORY_SLOTS].bytes, bytes, n);
    store(&r->processor, processor_now());
    store(&r->written, written + 1);
    if (load(&r->asleep))
        (void)syscall(SYS_futex, &r->written, FUTEX_WAKE, 1, NULL, NULL, 0);
    return true;
}

static bool has_packet(const struct memory_ring *r)
{
    return load(&r->written) != load(&r->taken);
}

int64_t memory_ring_patience_ns(uint32_t there, uint32_t here)
{
    if (!there || !here)
        return UNKNOWN_NS;
    return there == here ? 0 : APART_NS;
}

static bool look(const struct memory_ring *r, int64_t patience_ns)
{
    int64_t end_ns = clock_ns() + patience_ns;
    do {
        for (int i = 0; i < LOOKS; i++, pause_a_look())
            if (has_packet(r))
                return true;
    } while (clock_ns() < end_ns);
    return false;
}

static bool comes_soon(const struct memory_ring *r, struct memory_wait *w)
{
    int64_t patience_ns = memory_ring_patience_ns(load(&r->processor), processor_now());
    bool here = has_packet(r);
    if (here || patience_ns == 0)
        return here;
    if (w->at_once > 0) {
        w->at_once--;
        return false;
    }
    bool came = look(r, patience_ns);
    w->at_once = w->in_vain = came ? 0 : (2 * w->in_vain + 1) & AT_ONCE_MOST;
    return came;
}

/* Until the ring has a packet, `ms` are over, or a signal comes. */
static void sleep_for_packet(struct memory_ring *r, struct memory_wait *w, int ms)
{
    struct timespec most = {ms / 1000, ms % 1000 * 1000000L};
    uint32_t seen = load(&r->written);
    store(&r->asleep, 1);
    if (seen == load(&r->taken) && seen == load(&r->written)) {
        w->sleeps++;
        (void)syscall(SYS_futex, &r->written, FUTEX_WAIT, seen, &most, NULL, 0);
    }
    store(&r->asleep, 0);
}

bool memory_ring_await(struct memory_ring *r, struct memory_wait *w, int ms)
{
    if (!comes_soon(r, w))
        sleep_for_packet(r, w, ms);
    return has_packet(r);
}

int memory_ring_take(struct memory_ring *r, uint8_t *bytes)
{
    uint32_t taken = load(&r->taken), written = load(&r->written), n = load(&r->slot[taken % MEMORY_SLOTS].n);
    bool sound = written - taken <= MEMORY_SLOTS;
    bool fits = n <= MEMORY_BYTES;
    if (sound && fits)
        memcpy(bytes, r->slot[taken % MEMORY_SLOTS].bytes, n);
    store(&r->taken, sound ? taken + 1 : written);
    return sound && fits ? (int)n : -1;
}
