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

static struct memory plant_memory;
static struct memory_rings *bench_rings; /* the controller's view */

static void open_rings(void)
{
    check_no_error("the plant makes its memory", memory_open(&plant_memory, NULL));
    int file = open(plant_memory.path, O_RDWR);
    check_is("the controller opens its file", file, >=, 0);
    bench_rings = mmap(NULL, sizeof *bench_rings, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
}

static void close_rings(void)
{
    munmap(bench_rings, sizeof *bench_rings);
    memory_close(&plant_memory);
}

/* The bytes, which are so many as they say or fewer. */
static void say_length(const void *packet, size_t size, size_t n)
{
    struct memory_ring *r = &bench_rings->to_plant;
    uint32_t i = r->written % MEMORY_SLOTS;
    memcpy(r->slot[i].bytes, packet, n < size ? n : size);
    r->slot[i].n = (uint32_t)n;
    __atomic_store_n(&r->written, r->written + 1, __ATOMIC_SEQ_CST);
}

static void say_packet(const void *packet, size_t n)
{
    say_length(packet, n, n);
}

static int hear_frames(struct frame *f, int max)
{
    int n = 0;
    while (n < max && plant_memory.hal.recv(&plant_memory, &f[n]) == 1)
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
    open_rings();
    plant_memory.hal.send(&plant_memory, &packet_frame[0]);
    check_int("no word: no turn", memory_await(&plant_memory, 0), false);
    say_packet(packet_golden, sizeof packet_golden);
    say_packet(empty, sizeof empty);
    check_int("a word begins a turn", memory_await(&plant_memory, 0), true);
    check_int("frames of it, not of the next", hear_frames(f, PACKET_FRAMES + 1), PACKET_FRAMES);
    for (int i = 0; i < PACKET_FRAMES; i++)
        check_true("a frame as it was sent", packet_same(&f[i], &packet_frame[i]));
    plant_memory.hal.flush(&plant_memory);
    check_int("an empty word, too", memory_await(&plant_memory, 0), true);
    check_int("has no frames", hear_frames(f, 1), 0);
    plant_memory.hal.flush(&plant_memory);
    check_int("then there is none", memory_await(&plant_memory, 0), false);
    check_int("an answer a turn", bench_rings->from_plant.written, 2);
    check_int("of one frame", bench_rings->from_plant.slot[0].bytes[4], 1);
    check_int("and of none", bench_rings->from_plant.slot[1].n, CANNELLONI_HEADER);
    close_rings();
}

/* An app may leave a part of a word: that is the next turn's. */
TEST(memory_rest_of_word)
{
    struct frame f[PACKET_FRAMES];
    open_rings();
    say_packet(packet_golden, sizeof packet_golden);
    check_int("a word", memory_await(&plant_memory, 0), true);
    check_int("one frame taken", hear_frames(f, 1), 1);
    check_int("the rest is a word", memory_await(&plant_memory, 0), true);
    check_int("frames left", hear_frames(f, PACKET_FRAMES), PACKET_FRAMES - 1);
    close_rings();
}

/* 107 full frames fill a packet: docs/guide/lockstep.md, rule 3. */
TEST(memory_long_answer)
{
    const struct frame full = {.id = 1, .length = FRAME_DATA};
    open_rings();
    for (int i = 0; i < 107 + 106; i++)
        check_int("a frame is taken", plant_memory.hal.send(&plant_memory, &full), 1);
    plant_memory.hal.flush(&plant_memory);
    check_int("packets", bench_rings->from_plant.written, 2);
    check_int("the first says that more follows", bench_rings->from_plant.slot[0].n, 5 + 107 * 13);
    check_int("the second does not", bench_rings->from_plant.slot[1].n, 5 + 106 * 13);
    for (int i = 0; i < 107; i++)
        plant_memory.hal.send(&plant_memory, &full);
    plant_memory.hal.flush(&plant_memory);
    check_int("a full packet alone and an empty one", bench_rings->from_plant.written, 4);
    check_int("which is empty", bench_rings->from_plant.slot[3].n, CANNELLONI_HEADER);
    close_rings();
}

TEST(memory_full_ring)
{
    const struct frame full = {.id = 1, .length = FRAME_DATA};
    int taken = 0;
    open_rings();
    while (taken < 100000 && plant_memory.hal.send(&plant_memory, &full))
        taken++;
    check_int("frames until the ring and the packet are full", taken, (MEMORY_SLOTS + 1) * 107);
    bench_rings->from_plant.taken = 1; /* the controller takes one packet */
    check_int("there is room again", plant_memory.hal.send(&plant_memory, &full), 1);
    close_rings();
}

/* An answer that found the ring full goes while the plant waits for the next word, its end too: the
 * controller waits for that. */
TEST(memory_full_ring_ends)
{
    const struct frame full = {.id = 1, .length = FRAME_DATA};
    open_rings();
    bench_rings->from_plant.written = MEMORY_SLOTS; /* full */
    for (int i = 0; i < 107; i++)
        plant_memory.hal.send(&plant_memory, &full);
    plant_memory.hal.flush(&plant_memory);
    check_int("nothing went", bench_rings->from_plant.written, MEMORY_SLOTS);
    bench_rings->from_plant.taken = 1; /* a slot */
    check_int("no word yet", memory_await(&plant_memory, 0), false);
    check_int("the long packet went", bench_rings->from_plant.written, MEMORY_SLOTS + 1);
    bench_rings->from_plant.taken = MEMORY_SLOTS + 1; /* all of them */
    check_int("no word yet", memory_await(&plant_memory, 0), false);
    check_int("its end went", bench_rings->from_plant.written, MEMORY_SLOTS + 2);
    check_int("which is empty", bench_rings->from_plant.slot[1].n, CANNELLONI_HEADER);
    check_int("and nothing more goes", memory_await(&plant_memory, 0), false);
    check_int("packets", bench_rings->from_plant.written, MEMORY_SLOTS + 2);
    close_rings();
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
    open_rings();
    for (unsigned i = 0; i < sizeof word / sizeof word[0]; i++) {
        say_length(packet_golden, sizeof packet_golden, word[i].n);
        check_int(word[i].name, memory_await(&plant_memory, 0), false);
        check_int("is reported", plant_memory.hal.recv(&plant_memory, &f), -HAL_FOREIGN);
        check_int("once", plant_memory.hal.recv(&plant_memory, &f), 0);
        check_int("and counted", plant_memory.malformed, i + 1);
    }
    say_packet(packet_beside, sizeof packet_beside);
    check_int("one with frames of other kinds is a word", memory_await(&plant_memory, 0), true);
    check_int("they are reported", plant_memory.hal.recv(&plant_memory, &f), -HAL_FOREIGN);
    check_int("and counted", plant_memory.passed_over, 2);
    check_int("the command beside them is taken", plant_memory.hal.recv(&plant_memory, &f), 1);
    check_true("as it is", packet_same(&f, &packet_frame[0]));
    say_packet(packet_golden, sizeof packet_golden);
    check_int("the next good one is a word", memory_await(&plant_memory, 0), true);
    close_rings();
}

/* A count of more packets than there are slots is none: nothing old is taken twice. */
TEST(memory_wild_count)
{
    struct frame f;
    open_rings();
    say_packet(packet_golden, sizeof packet_golden);
    check_int("a word", memory_await(&plant_memory, 0), true);
    check_is("its frames", hear_frames(&f, 1), ==, 1);
    while (hear_frames(&f, 1))
        ;
    bench_rings->to_plant.written += MEMORY_SLOTS + 1;
    check_int("33 more packets: no word", memory_await(&plant_memory, 0), false);
    check_int("is reported", plant_memory.hal.recv(&plant_memory, &f), -HAL_FOREIGN);
    check_int("and counted", plant_memory.malformed, 1);
    check_int("none of them is a word", memory_await(&plant_memory, 0), false);
    say_packet(packet_golden, sizeof packet_golden);
    check_int("the next good one is", memory_await(&plant_memory, 0), true);
    close_rings();
}

/* The controller is told that the plant ends, and need not wait in vain. */
TEST(memory_end)
{
    open_rings();
    bench_rings->from_plant.slot[0].n = 99;
    memory_close(&plant_memory);
    check_int("a packet more", bench_rings->from_plant.written, 1);
    check_int("of no bytes", bench_rings->from_plant.slot[0].n, 0);
    munmap(bench_rings, sizeof *bench_rings);
}

/* The counters are 32 bits long and wrap after four billion packets. */
TEST(memory_wraps)
{
    struct frame f[PACKET_FRAMES];
    int frames = 0;
    open_rings();
    bench_rings->to_plant.written = bench_rings->to_plant.taken = UINT32_MAX - 1;
    bench_rings->from_plant.written = bench_rings->from_plant.taken = UINT32_MAX - 1;
    for (int i = 0; i < 4; i++) {
        say_packet(packet_golden, sizeof packet_golden);
        check_int("a word", memory_await(&plant_memory, 0), true);
        frames += hear_frames(f, PACKET_FRAMES);
        plant_memory.hal.flush(&plant_memory);
    }
    check_int("frames of four words", frames, 4 * PACKET_FRAMES);
    check_int("answers written", bench_rings->from_plant.written, 2);
    close_rings();
}

/* A controller that is slow at first and quick then: the plant sleeps, is woken by nobody, and looks again.
 */
TEST(memory_slow_controller)
{
    enum { WORDS = 600 };
    struct frame f[PACKET_FRAMES];
    int words = 0, status = 1;
    open_rings();
    pid_t child = fork();
    if (child == 0) {
        for (int i = 0; i < WORDS; i++) {
            usleep(i < 20 ? 2000 : 0);
            say_packet(packet_golden, sizeof packet_golden);
            while (__atomic_load_n(&bench_rings->from_plant.written, __ATOMIC_SEQ_CST) != (uint32_t)i + 1)
                usleep(1);
            __atomic_store_n(&bench_rings->from_plant.taken, (uint32_t)i + 1, __ATOMIC_SEQ_CST);
        }
        _exit(0);
    }
    for (int looks = 0; words < WORDS && looks < 100000; looks++)
        if (memory_await(&plant_memory, 5)) {
            words += hear_frames(f, PACKET_FRAMES) == PACKET_FRAMES;
            plant_memory.hal.flush(&plant_memory);
        }
    waitpid(child, &status, 0);
    check_int("words of another process", words, WORDS);
    check_int("all of them answered", status, 0);
    close_rings();
}

/* Who has the path cannot make the memory shorter or longer, by any call that would. */
static void check_sealed(const char *path)
{
    struct stat s;
    int file = open(path, O_RDWR);
    check_is("another process opens it", file, >=, 0);
    check_is("truncate to nothing", truncate(path, 0), <, 0);
    check_is("ftruncate to one byte less", ftruncate(file, sizeof(struct memory_rings) - 1), <, 0);
    check_is("ftruncate to more", ftruncate(file, 2 * sizeof(struct memory_rings)), <, 0);
    check_is("open with O_TRUNC", open(path, O_RDWR | O_TRUNC), <, 0);
    check_is("the seals cannot be changed", fcntl(file, F_ADD_SEALS, F_SEAL_WRITE), <, 0);
    fstat(file, &s);
    check_int("it is as long as it was, bytes", s.st_size, sizeof(struct memory_rings));
    close(file);
}

TEST(memory_sealed)
{
    char path[64];
    snprintf(path, sizeof path, "/tmp/contactplant_test_%ld", (long)getpid());
    check_no_error("without a name", memory_open(&plant_memory, NULL));
    check_sealed(plant_memory.path);
    memory_close(&plant_memory);
    check_no_error("with a name", memory_open(&plant_memory, path));
    check_sealed(path);
    memory_close(&plant_memory);
}

TEST(memory_named)
{
    char path[64];
    struct memory second;
    struct stat s;
    snprintf(path, sizeof path, "/tmp/contactplant_test_%ld", (long)getpid());
    check_no_error("a file with a name", memory_open(&plant_memory, path));
    check_int("is there", stat(path, &s), 0);
    check_int("for its owner alone", s.st_mode & 0777, 0600);
    check_contains("a second plant is refused", memory_open(&second, path), "exists; another plant has it");
    check_int("and leaves it there", stat(path, &s), 0);
    memory_close(&plant_memory);
    check_is("it goes with the plant", stat(path, &s), <, 0);
    check_no_error("another one", memory_open(&plant_memory, path));
    unlink(path);
    check_no_error("and one more after its file was removed", memory_open(&second, path));
    memory_close(&plant_memory);
    check_int("the file of the other stays", stat(path, &s), 0);
    memory_close(&second);
    check_is("and goes with that", stat(path, &s), <, 0);
    check_contains("no folder", memory_open(&plant_memory, "/nowhere/rig"), "/nowhere/rig: No such file");
    check_contains("a long path",
                   memory_open(&plant_memory, "/1234567890123456789012345678901234567890123456789012345678901"
                                              "23456789012345678901234567890123456789012345678901234567890"),
                   "too long");
}
