/* bench_lockstep.c - words per second that a controller of plain sockets, or through memory, exchanges with
 * contactplant run --lockstep.
 *
 *   bench_lockstep PORT PLANT_PORT EXCHANGES
 *   bench_lockstep FILE EXCHANGES              beside run --bus memory:FILE
 *
 * The counterpart of tests/cli/lockstep_client.py: a session, a force in each bus frame, a heartbeat in each
 * tenth. It checks that the plant took every sample: tick and bus frame go on together. */
#include "firmware/bus/wire.h"
#include "hal/link/cannelloni.h"
#include "hal/posix/clock.h"
#include "hal/posix/memory.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    SUBSTEPS = 64,
    OPENING = 1000,
    RUN = 50 /* exchanges so short that other work on the machine leaves some of them alone */
};

static const struct wire_scene scene = {.base_id = 0x200,
                                        .frame_rate_Hz = 1e3,
                                        .dilation = 1.0,
                                        .substeps = SUBSTEPS,
                                        .lsb = {1.0, 1.0, 1.0, 1.0}};
static int plant;
static struct memory_rings *rings; /* NULL: over UDP */
static struct memory_wait wait;
static struct cannelloni word;
static uint8_t counter[WIRE_COMMANDS], session, session_seen;
static uint32_t frame, tick;

static void put(unsigned kind, double first, double second, double third)
{
    struct message m = {
        .kind = (uint8_t)kind, .counter = counter[kind], .value = {session, first, second, third}};
    struct frame f;
    counter[kind] = (uint8_t)((counter[kind] + 1) % WIRE_COUNTER_STATES);
    wire_encode(&scene, &m, &f);
    cannelloni_add(&word, &f);
}

static void hear(const struct frame *f)
{
    struct message m;
    if (wire_decode(&scene, f, &m) != WIRE_OK)
        return;
    if (m.kind == WIRE_STATUS) {
        session_seen = (uint8_t)m.value[SESSION];
        frame = (uint32_t)m.value[STATUS_FRAME];
    }
    if (m.kind == WIRE_SYNC)
        tick = (uint32_t)m.value[SYNC_TICK];
}

static ssize_t put_word(void)
{
    return memory_ring_put(&rings->to_plant, word.bytes, word.n_bytes) ? (ssize_t)word.n_bytes : -1;
}

/* A packet of the plant. */
static ssize_t take_answer(uint8_t *answer)
{
    while (!memory_ring_await(&rings->from_plant, &wait, 1000))
        ;
    return memory_ring_take(&rings->from_plant, answer);
}

/* One word, and the bus frame that answers it. False: the plant is not there. */
static int exchange(void)
{
    static struct frame f[CANNELLONI_FRAMES_MAX];
    static uint32_t passed_over;
    uint8_t answer[CANNELLONI_PACKET_MAX];
    ssize_t n = rings ? put_word() : send(plant, word.bytes, word.n_bytes, 0);
    cannelloni_next(&word);
    for (n = n < 0 ? n : CANNELLONI_MORE; n >= CANNELLONI_MORE;) {
        n = rings ? take_answer(answer) : recv(plant, answer, sizeof answer, 0);
        int frames = n < 0 ? 0 : cannelloni_parse(answer, (size_t)n, f, CANNELLONI_FRAMES_MAX, &passed_over);
        for (int i = 0; i < frames; i++)
            hear(&f[i]);
    }
    return n >= 0;
}

/* The first words are empty, until the plant is up and has told its STATUS. */
static int open_session(void)
{
    for (int i = 0; i < OPENING && !frame; i++)
        if (!exchange())
            usleep(10000);
    session = (uint8_t)(session_seen % WIRE_SESSIONS + 1);
    put(WIRE_ENABLE, 1.0, frame, 0.0);
    put(WIRE_CONTROL, CONTROL_START, 0xFF - CONTROL_START, frame);
    for (int i = 0; i < OPENING && session_seen != session; i++)
        (void)exchange();
    return session_seen == session;
}

static int connect_plant(const char *port, const char *plant_port)
{
    struct sockaddr_in own = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}}, other = own;
    own.sin_port = htons((uint16_t)atoi(port));
    other.sin_port = htons((uint16_t)atoi(plant_port));
    plant = socket(AF_INET, SOCK_DGRAM, 0);
    return bind(plant, (struct sockaddr *)&own, sizeof own) == 0 &&
           connect(plant, (struct sockaddr *)&other, sizeof other) == 0;
}

/* The plant may not be up yet. */
static int map_memory(const char *path)
{
    int file = -1;
    for (int i = 0; i < OPENING && file < 0; i++) {
        file = open(path, O_RDWR);
        if (file < 0)
            usleep(10000);
    }
    usleep(10000); /* that the file has its length */
    rings = mmap(NULL, sizeof *rings, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    return rings != MAP_FAILED;
}

/* n exchanges; the nanoseconds of the best RUN of them, or a negative number: the plant is gone. */
static int64_t exchange_all(long n)
{
    int64_t begin_ns = clock_ns(), best_ns = INT64_MAX;
    for (long i = 0; i < n; i++) {
        put(WIRE_STREAM, tick / SUBSTEPS, i % 8, 0.0);
        if (i % 10 == 0)
            put(WIRE_ENABLE, 1.0, frame, 0.0);
        if (!exchange())
            return -1;
        if (i % RUN != RUN - 1)
            continue;
        int64_t now_ns = clock_ns();
        best_ns = now_ns - begin_ns < best_ns ? now_ns - begin_ns : best_ns;
        begin_ns = now_ns;
    }
    return best_ns;
}

int main(int argc, char **argv)
{
    long n = argc == 3 || argc == 4 ? atol(argv[argc - 1]) : 0;
    cannelloni_begin(&word, 0);
    if (n < 1 || !(argc == 3 ? map_memory(argv[1]) : connect_plant(argv[1], argv[2])) || !open_session()) {
        fprintf(stderr,
                "bench_lockstep: PORT PLANT_PORT EXCHANGES, or FILE EXCHANGES, beside contactplant run "
                "--lockstep\n");
        return 1;
    }
    uint32_t begin_tick = tick;
    int64_t begin_ns = clock_ns();
    int64_t best_ns = exchange_all(n);
    if (best_ns < 0)
        return 1;
    double took_s = 1e-9 * (double)(clock_ns() - begin_ns);
    put(WIRE_CONTROL, CONTROL_STOP, 0xFF - CONTROL_STOP, 0.0);
    (void)exchange();
    printf("%ld exchanges, %.0f/s, the best %d in a row %.0f/s", n, (double)n / took_s, RUN,
           1e9 * RUN / (double)best_ns);
    if (rings)
        printf(", %u sleeps", wait.sleeps);
    printf("\n");
    return tick - begin_tick < (uint32_t)n * SUBSTEPS;
}
