/* test_ring.c - the memory between a plant and the scope: all frames in order, or the number of those that
 * were lost. */
#include "host_sim/scope/ring.h"
#include "tests/unit/test.h"

#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ACROSS = 1000000 };

static uint32_t given; /* identifiers handed out by the hal below */

static int receive(void *context, struct frame *f)
{
    (void)context;
    *f = (struct frame){.id = given++, .length = 8};
    return 1;
}

static int transmit(void *context, const struct frame *f)
{
    (void)context;

    return f->id != 77;
}

static void nothing(void *context)
{
    (void)context;
}

static const struct hal below = {NULL, receive, transmit, nothing, NULL, nothing};

static struct ring *open_ring(struct ring_writer *t, const struct timing *timing)
{
    struct ring *m = ring_share();
    given = 0;
    ring_writer_open(t, m, &below, timing);
    return m;
}

TEST(ring_copies_both_ways)
{
    static struct ring_reader reader;
    struct timing timing = {.lateness.bin[3] = 7, .compute.bin[TIMING_BINS - 1] = 9};
    struct ring_writer t;
    struct frame f, sent = {.id = 500, .length = 2, .flags = FRAME_EXTENDED, .data = {1, 2}};
    struct ring *m = open_ring(&t, &timing);
    ring_reader_open(&reader, m);
    check_int("nothing yet", reader.hal.recv(&reader, &f), 0);
    check_int("received", t.hal.recv(t.hal.context, &f), 1);
    check_int("sent", t.hal.send(t.hal.context, &sent), 1);
    check_int("no room", t.hal.send(t.hal.context, &(struct frame){.id = 77}), 0);
    t.hal.flush(t.hal.context);
    check_int("first", reader.hal.recv(&reader, &f), 1);
    check_int("its identifier", f.id, 0);
    check_int("second", reader.hal.recv(&reader, &f), 1);
    check_bytes("as it was sent", &f, &sent, sizeof f);
    check_int("the refused one is none", reader.hal.recv(&reader, &f), 0);
    check_int("lateness", reader.timing.lateness.bin[3], 7);
    check_int("compute", reader.timing.compute.bin[TIMING_BINS - 1], 9);
    check_true("not over", !ring_is_over(&reader));
    ring_end(m);
    check_true("over", ring_is_over(&reader));
    ring_unshare(m);
}

TEST(ring_counts_what_is_lost)
{
    static struct ring_reader reader;
    struct timing timing = {0};
    struct ring_writer t;
    struct frame f;
    struct ring *m = open_ring(&t, &timing);
    ring_reader_open(&reader, m);
    for (int i = 0; i < RING_RECORDS; i++)
        t.hal.recv(t.hal.context, &f);
    int all = 0;
    while (reader.hal.recv(&reader, &f) == 1 && f.id == (uint32_t)all)
        all++;
    check_int("as many as there is room for", all, RING_RECORDS);
    for (int i = 0; i <= RING_RECORDS; i++)
        t.hal.recv(t.hal.context, &f);
    check_int("one more: told as lost", reader.hal.recv(&reader, &f), -HAL_DROPPED);
    check_int("all of them", (int)reader.lost, RING_RECORDS + 1);
    t.hal.recv(t.hal.context, &f);
    check_int("and on", reader.hal.recv(&reader, &f), 1);
    check_int("with the newest", f.id, 2 * RING_RECORDS + 1);
    ring_unshare(m);
}

/* Another process writes as fast as it can: what arrives is in order, and with the lost ones it is all. */
TEST(ring_between_processes)
{
    static struct ring_reader reader;
    struct timing timing = {0};
    struct ring_writer t;
    struct frame f;
    struct ring *m = open_ring(&t, &timing);
    uint32_t next = 0;
    int disorder = 0, got;
    pid_t writer = fork();
    if (writer == 0) {
        for (int i = 0; i < ACROSS; i++)
            t.hal.recv(t.hal.context, &f);
        ring_end(m);
        _exit(0);
    }
    ring_reader_open(&reader, m);
    for (bool over = false; !over;) {
        over = ring_is_over(&reader);
        while ((got = reader.hal.recv(&reader, &f)) != 0) {
            disorder += got > 0 && f.id != next;
            next = got > 0 ? f.id + 1 : (uint32_t)reader.read;
        }
    }
    (void)waitpid(writer, NULL, 0);
    check_int("frames out of their place", disorder, 0);
    check_int("read and lost", (int)next, ACROSS);
    ring_unshare(m);
}
