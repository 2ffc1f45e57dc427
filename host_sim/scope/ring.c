/* ring.c - see ring.h. */
#include "host_sim/scope/ring.h"

#include <stddef.h>
#include <sys/mman.h>

struct ring *ring_share(void)
{
    void *m = mmap(NULL, sizeof(struct ring), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return m == MAP_FAILED ? NULL : m;
}

void ring_unshare(struct ring *m)
{
    (void)munmap(m, sizeof *m);
}

/* ---- the plant's side ---- */

/* A reader that comes while the record changes sees a number that it does not expect. */
static void write_record(struct ring *m, const struct ring_record *what)
{
    uint64_t number = m->written + 1;
    struct ring_record *r = &m->record[m->written % RING_RECORDS];
    __atomic_store_n(&r->number, 0, __ATOMIC_RELAXED);
    __atomic_thread_fence(__ATOMIC_RELEASE);
    r->kind = what->kind;
    r->bin = what->bin;
    r->count = what->count;
    r->frame = what->frame;
    __atomic_store_n(&r->number, number, __ATOMIC_RELEASE);
    __atomic_store_n(&m->written, number, __ATOMIC_RELEASE);
}

static void write_frame(struct ring *m, const struct frame *f)
{
    write_record(m, &(struct ring_record){.kind = RING_FRAME, .frame = *f});
}

static void write_histogram(struct ring *m, uint8_t kind, const struct histogram *h)
{
    for (uint8_t i = 0; i < TIMING_BINS; i++)
        write_record(m, &(struct ring_record){.kind = kind, .bin = i, .count = h->bin[i]});
}

static int receive(void *context, struct frame *f)
{
    const struct ring_writer *t = context;
    int got = t->inner.recv(t->inner.context, f);
    if (got > 0)
        write_frame(t->memory, f);
    return got;
}

static int transmit(void *context, const struct frame *f)
{
    const struct ring_writer *t = context;
    int taken = t->inner.send(t->inner.context, f);
    if (taken)
        write_frame(t->memory, f);
    return taken;
}

static void flush(void *context)
{
    struct ring_writer *t = context;
    t->inner.flush(t->inner.context);
    if (t->frames++ % RING_TIMING_FRAMES)
        return;
    write_histogram(t->memory, RING_LATENESS, &t->timing->lateness);
    write_histogram(t->memory, RING_COMPUTE, &t->timing->compute);
}

static uint32_t now_us(void *context)
{
    const struct ring_writer *t = context;
    return t->inner.now_us(t->inner.context);
}

static void healthy(void *context)
{
    const struct ring_writer *t = context;
    t->inner.healthy(t->inner.context);
}

void ring_writer_open(struct ring_writer *t, struct ring *m, const struct hal *inner,
                      const struct timing *timing)
{
    *t = (struct ring_writer){.inner = *inner, .memory = m, .timing = timing};
    t->hal = (struct hal){t, receive, transmit, flush, now_us, healthy};
}

void ring_end(struct ring *m)
{
    __atomic_store_n(&m->over, true, __ATOMIC_RELEASE);
}

/* ---- the reader's side ---- */

/* The record with this number; false when it has been overwritten. */
static bool copy_record(const struct ring *m, uint64_t number, struct ring_record *to)
{
    const struct ring_record *r = &m->record[(number - 1) % RING_RECORDS];
    bool before = __atomic_load_n(&r->number, __ATOMIC_ACQUIRE) == number;
    *to = *r;
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
    return before && __atomic_load_n(&r->number, __ATOMIC_RELAXED) == number;
}

static void take_bin(struct ring_reader *r, const struct ring_record *record)
{
    struct histogram *h = record->kind == RING_LATENESS ? &r->timing.lateness : &r->timing.compute;
    if (record->bin < TIMING_BINS)
        h->bin[record->bin] = record->count;
}

static int give_record(void *context, struct frame *f)
{
    struct ring_reader *r = context;
    struct ring_record record;
    while (r->read < __atomic_load_n(&r->memory->written, __ATOMIC_ACQUIRE)) {
        if (!copy_record(r->memory, r->read + 1, &record)) {
            uint64_t written = __atomic_load_n(&r->memory->written, __ATOMIC_ACQUIRE);
            r->lost += written - r->read;
            r->read = written;
            return -HAL_DROPPED;
        }
        r->read++;
        if (record.kind == RING_FRAME) {
            *f = record.frame;
            return 1;
        }
        take_bin(r, &record);
    }
    return 0;
}

void ring_reader_open(struct ring_reader *r, const struct ring *m)
{
    *r = (struct ring_reader){.memory = m};
    r->hal = (struct hal){.context = r, .recv = give_record};
}

bool ring_is_over(const struct ring_reader *r)
{
    return __atomic_load_n(&r->memory->over, __ATOMIC_ACQUIRE);
}
