/* test_tee.c - the memory between a plant and the scope: all frames in order, or the number of those that
 * were lost. */
#include "host_sim/scope/tee.h"
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

static struct tee_memory *open_tee(struct tee *t, const struct timing *timing)
{
    struct tee_memory *m = tee_share();
    given = 0;
    tee_open(t, m, &below, timing);
    return m;
}

TEST(tee_copies_both_ways)
{
    static struct tee_reader reader;
    struct timing timing = {.lateness.bin[3] = 7, .compute.bin[TIMING_BINS - 1] = 9};
    struct tee t;
    struct frame f, sent = {.id = 500, .length = 2, .flags = FRAME_EXTENDED, .data = {1, 2}};
    struct tee_memory *m = open_tee(&t, &timing);
    tee_read(&reader, m);
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
    check_true("not over", !tee_is_over(&reader));
    tee_end(m);
    check_true("over", tee_is_over(&reader));
    tee_unshare(m);
}

TEST(tee_counts_what_is_lost)
{
    static struct tee_reader reader;
    struct timing timing = {0};
    struct tee t;
    struct frame f;
    struct tee_memory *m = open_tee(&t, &timing);
    tee_read(&reader, m);
    for (int i = 0; i < TEE_RECORDS; i++)
        t.hal.recv(t.hal.context, &f);
    int all = 0;
    while (reader.hal.recv(&reader, &f) == 1 && f.id == (uint32_t)all)
        all++;
    check_int("as many as there is room for", all, TEE_RECORDS);
    for (int i = 0; i <= TEE_RECORDS; i++)
        t.hal.recv(t.hal.context, &f);
    check_int("one more: told as lost", reader.hal.recv(&reader, &f), -HAL_DROPPED);
    check_int("all of them", (int)reader.lost, TEE_RECORDS + 1);
    t.hal.recv(t.hal.context, &f);
    check_int("and on", reader.hal.recv(&reader, &f), 1);
    check_int("with the newest", f.id, 2 * TEE_RECORDS + 1);
    tee_unshare(m);
}

/* Another process writes as fast as it can: what arrives is in order, and with the lost ones it is all. */
TEST(tee_between_processes)
{
    static struct tee_reader reader;
    struct timing timing = {0};
    struct tee t;
    struct frame f;
    struct tee_memory *m = open_tee(&t, &timing);
    uint32_t next = 0;
    int disorder = 0, got;
    pid_t writer = fork();
    if (writer == 0) {
        for (int i = 0; i < ACROSS; i++)
            t.hal.recv(t.hal.context, &f);
        tee_end(m);
        _exit(0);
    }
    tee_read(&reader, m);
    for (bool over = false; !over;) {
        over = tee_is_over(&reader);
        while ((got = reader.hal.recv(&reader, &f)) != 0) {
            disorder += got > 0 && f.id != next;
            next = got > 0 ? f.id + 1 : (uint32_t)reader.read;
        }
    }
    (void)waitpid(writer, NULL, 0);
    check_int("frames out of their place", disorder, 0);
    check_int("read and lost", (int)next, ACROSS);
    tee_unshare(m);
}
