/* test_memory.c - lockstep through memory: packets of a controller that follows hal/posix/memory.h by hand.
 */
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include "hal/posix/memory.h"
#include "tests/fixture/packet.h"
#include "tests/unit/test.h"

static struct memory plant;
static struct memory_rings *bench; /* the controller's view */

static void open_both(void)
{
    check_no_error("the plant makes its memory", memory_open(&plant, NULL));
    int file = open(plant.path, O_RDWR);
    check_is("the controller opens its file", file, >=, 0);
    bench = mmap(NULL, sizeof *bench, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
}

static void close_both(void)
{
    munmap(bench, sizeof *bench);
    memory_close(&plant);
}

/* The bytes, which are so many as they say or fewer. */
static void say_length(const void *packet, size_t size, size_t n)
{
    struct memory_ring *r = &bench->to_plant;
    uint32_t i = r->written[0] % MEMORY_SLOTS;
    memcpy(r->slot[i].bytes, packet, n < size ? n : size);
    r->slot[i].n = (uint32_t)n;
    __atomic_store_n(r->written, r->written[0] + 1, __ATOMIC_SEQ_CST);
}

static void say(const void *packet, size_t n)
{
    say_length(packet, n, n);
}

static int hear(struct frame *f, int max)
{
    int n = 0;
    while (n < max && plant.hal.recv(&plant, &f[n]) == 1)
        n++;
    return n;
}

TEST(memory_layout)
{
    check_int("a ring, bytes", sizeof(struct memory_ring), 3 * 64 + 32 * 2048);
    check_int("slots begin at", offsetof(struct memory_ring, slot), 192);
    check_int("bytes of a packet begin after its length", offsetof(struct memory_ring, slot[0].bytes), 196);
}

TEST(memory_words)
{
    static const uint8_t empty[] = {2, 0, 0, 0, 0};
    struct frame f[PACKET_FRAMES + 1];
    open_both();
    plant.hal.send(&plant, &packet_frame[0]);
    check_int("no word: no turn", memory_await(&plant, 0), false);
    say(packet_golden, sizeof packet_golden);
    say(empty, sizeof empty);
    check_int("a word begins a turn", memory_await(&plant, 0), true);
    check_int("frames of it, not of the next", hear(f, PACKET_FRAMES + 1), PACKET_FRAMES);
    for (int i = 0; i < PACKET_FRAMES; i++)
        check_true("a frame as it was sent", packet_same(&f[i], &packet_frame[i]));
    plant.hal.flush(&plant);
    check_int("an empty word, too", memory_await(&plant, 0), true);
    check_int("has no frames", hear(f, 1), 0);
    plant.hal.flush(&plant);
    check_int("then there is none", memory_await(&plant, 0), false);
    check_int("an answer a turn", bench->from_plant.written[0], 2);
    check_int("of one frame", bench->from_plant.slot[0].bytes[4], 1);
    check_int("and of none", bench->from_plant.slot[1].n, CANNELLONI_HEADER);
    close_both();
}

/* An app may leave a part of a word: that is the next turn's. */
TEST(memory_rest_of_word)
{
    struct frame f[PACKET_FRAMES];
    open_both();
    say(packet_golden, sizeof packet_golden);
    check_int("a word", memory_await(&plant, 0), true);
    check_int("one frame taken", hear(f, 1), 1);
    check_int("the rest is a word", memory_await(&plant, 0), true);
    check_int("frames left", hear(f, PACKET_FRAMES), PACKET_FRAMES - 1);
    close_both();
}

/* 107 full frames fill a packet: docs/guide/lockstep.md, rule 3. */
TEST(memory_long_answer)
{
    const struct frame full = {.id = 1, .length = FRAME_DATA};
    open_both();
    for (int i = 0; i < 107 + 106; i++)
        check_int("a frame is taken", plant.hal.send(&plant, &full), 1);
    plant.hal.flush(&plant);
    check_int("packets", bench->from_plant.written[0], 2);
    check_int("the first says that more follows", bench->from_plant.slot[0].n, 5 + 107 * 13);
    check_int("the second does not", bench->from_plant.slot[1].n, 5 + 106 * 13);
    for (int i = 0; i < 107; i++)
        plant.hal.send(&plant, &full);
    plant.hal.flush(&plant);
    check_int("a full packet alone and an empty one", bench->from_plant.written[0], 4);
    check_int("which is empty", bench->from_plant.slot[3].n, CANNELLONI_HEADER);
    close_both();
}

TEST(memory_full_ring)
{
    const struct frame full = {.id = 1, .length = FRAME_DATA};
    int taken = 0;
    open_both();
    while (taken < 100000 && plant.hal.send(&plant, &full))
        taken++;
    check_int("frames until the ring and the packet are full", taken, (MEMORY_SLOTS + 1) * 107);
    bench->from_plant.taken[0] = 1; /* the controller takes one packet */
    check_int("there is room again", plant.hal.send(&plant, &full), 1);
    close_both();
}

/* An answer that found the ring full goes while the plant waits for the next word, its end too: the
 * controller waits for that. */
TEST(memory_full_ring_ends)
{
    const struct frame full = {.id = 1, .length = FRAME_DATA};
    open_both();
    bench->from_plant.written[0] = MEMORY_SLOTS; /* full */
    for (int i = 0; i < 107; i++)
        plant.hal.send(&plant, &full);
    plant.hal.flush(&plant);
    check_int("nothing went", bench->from_plant.written[0], MEMORY_SLOTS);
    bench->from_plant.taken[0] = 1; /* a slot */
    check_int("no word yet", memory_await(&plant, 0), false);
    check_int("the long packet went", bench->from_plant.written[0], MEMORY_SLOTS + 1);
    bench->from_plant.taken[0] = MEMORY_SLOTS + 1; /* all of them */
    check_int("no word yet", memory_await(&plant, 0), false);
    check_int("its end went", bench->from_plant.written[0], MEMORY_SLOTS + 2);
    check_int("which is empty", bench->from_plant.slot[1].n, CANNELLONI_HEADER);
    check_int("and nothing more goes", memory_await(&plant, 0), false);
    check_int("packets", bench->from_plant.written[0], MEMORY_SLOTS + 2);
    close_both();
}

TEST(memory_hostile)
{
    static const struct {
        const char *name;
        size_t n;
    } word[] = {{"a length of four billion", 0xFFFFFFFFu},
                {"one byte too long", MEMORY_BYTES + 1},
                {"half a packet", sizeof packet_golden / 2},
                {"nothing", 0}};
    struct frame f;
    open_both();
    for (unsigned i = 0; i < sizeof word / sizeof word[0]; i++) {
        say_length(packet_golden, sizeof packet_golden, word[i].n);
        check_int(word[i].name, memory_await(&plant, 0), false);
        check_int("is reported", plant.hal.recv(&plant, &f), -HAL_FOREIGN);
        check_int("once", plant.hal.recv(&plant, &f), 0);
        check_int("and counted", plant.malformed, i + 1);
    }
    say(packet_golden, sizeof packet_golden);
    check_int("the next good one is a word", memory_await(&plant, 0), true);
    close_both();
}

/* A count of more packets than there are slots is none: nothing old is taken twice. */
TEST(memory_wild_count)
{
    struct frame f;
    open_both();
    say(packet_golden, sizeof packet_golden);
    check_int("a word", memory_await(&plant, 0), true);
    check_is("its frames", hear(&f, 1), ==, 1);
    while (hear(&f, 1))
        ;
    bench->to_plant.written[0] += MEMORY_SLOTS + 1;
    check_int("33 more packets: no word", memory_await(&plant, 0), false);
    check_int("is reported", plant.hal.recv(&plant, &f), -HAL_FOREIGN);
    check_int("and counted", plant.malformed, 1);
    check_int("none of them is a word", memory_await(&plant, 0), false);
    say(packet_golden, sizeof packet_golden);
    check_int("the next good one is", memory_await(&plant, 0), true);
    close_both();
}

/* The controller is told that the plant ends, and need not wait in vain. */
TEST(memory_end)
{
    open_both();
    bench->from_plant.slot[0].n = 99;
    memory_close(&plant);
    check_int("a packet more", bench->from_plant.written[0], 1);
    check_int("of no bytes", bench->from_plant.slot[0].n, 0);
    munmap(bench, sizeof *bench);
}

/* The counters are 32 bits long and wrap after four billion packets. */
TEST(memory_wraps)
{
    struct frame f[PACKET_FRAMES];
    int frames = 0;
    open_both();
    bench->to_plant.written[0] = bench->to_plant.taken[0] = UINT32_MAX - 1;
    bench->from_plant.written[0] = bench->from_plant.taken[0] = UINT32_MAX - 1;
    for (int i = 0; i < 4; i++) {
        say(packet_golden, sizeof packet_golden);
        check_int("a word", memory_await(&plant, 0), true);
        frames += hear(f, PACKET_FRAMES);
        plant.hal.flush(&plant);
    }
    check_int("frames of four words", frames, 4 * PACKET_FRAMES);
    check_int("answers written", bench->from_plant.written[0], 2);
    close_both();
}

/* A controller that is slow at first and quick then: the plant sleeps, is woken by nobody, and looks again.
 */
TEST(memory_slow_controller)
{
    enum { WORDS = 600 };
    struct frame f[PACKET_FRAMES];
    int words = 0, status = 1;
    open_both();
    pid_t child = fork();
    if (child == 0) {
        for (int i = 0; i < WORDS; i++) {
            usleep(i < 20 ? 2000 : 0);
            say(packet_golden, sizeof packet_golden);
            while (__atomic_load_n(bench->from_plant.written, __ATOMIC_SEQ_CST) != (uint32_t)i + 1)
                usleep(1);
            __atomic_store_n(bench->from_plant.taken, (uint32_t)i + 1, __ATOMIC_SEQ_CST);
        }
        _exit(0);
    }
    for (int looks = 0; words < WORDS && looks < 100000; looks++)
        if (memory_await(&plant, 5)) {
            words += hear(f, PACKET_FRAMES) == PACKET_FRAMES;
            plant.hal.flush(&plant);
        }
    waitpid(child, &status, 0);
    check_int("words of another process", words, WORDS);
    check_int("all of them answered", status, 0);
    close_both();
}

TEST(memory_named)
{
    char path[64];
    struct memory second;
    struct stat s;
    snprintf(path, sizeof path, "/tmp/contactplant_test_%ld", (long)getpid());
    check_no_error("a file with a name", memory_open(&plant, path));
    check_int("is there", stat(path, &s), 0);
    check_int("for its owner alone", s.st_mode & 0777, 0600);
    check_contains("a second plant is refused", memory_open(&second, path), "exists; another plant has it");
    check_int("and leaves it there", stat(path, &s), 0);
    memory_close(&plant);
    check_is("it goes with the plant", stat(path, &s), <, 0);
    check_no_error("another one", memory_open(&plant, path));
    unlink(path);
    check_no_error("and one more after its file was removed", memory_open(&second, path));
    memory_close(&plant);
    check_int("the file of the other stays", stat(path, &s), 0);
    memory_close(&second);
    check_is("and goes with that", stat(path, &s), <, 0);
    check_contains("no folder", memory_open(&plant, "/nowhere/rig"), "/nowhere/rig: No such file");
    check_contains("a long path",
                   memory_open(&plant,
                               "/1234567890123456789012345678901234567890123456789012345678901234567890"
                               "12345678901234567890123456789012345678901234567890"),
                   "too long");
}
