/* bench_lockstep.c - words per second that a controller of plain sockets exchanges with contactplant run
 * --lockstep.
 *
 *   bench_lockstep PORT PLANT_PORT EXCHANGES
 *
 * The counterpart of tests/cli/lockstep_client.py: a session, a force in each bus frame, a heartbeat in each
 * tenth. It checks that the plant took every sample: tick and bus frame go on together. */
#include "firmware/bus/wire.h"
#include "hal/link/cannelloni.h"
#include "hal/posix/clock.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    MORE = CANNELLONI_PAYLOAD - (CANNELLONI_FRAME_HEADER + FRAME_DATA) + 1,
    SUBSTEPS = 64,
    OPENING = 1000
};

static const struct wire_scene scene = {.base_id = 0x200,
                                        .frame_rate_Hz = 1e3,
                                        .dilation = 1.0,
                                        .substeps = SUBSTEPS,
                                        .lsb = {1.0, 1.0, 1.0, 1.0}};
static int plant;
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

/* One word, and the bus frame that answers it. False: the plant is not there. */
static int exchange(void)
{
    static struct frame f[CANNELLONI_FRAMES_MAX];
    uint8_t answer[CANNELLONI_PACKET_MAX];
    ssize_t n = send(plant, word.bytes, word.n_bytes, 0);
    cannelloni_next(&word);
    for (n = n < 0 ? n : MORE; n >= MORE;) {
        n = recv(plant, answer, sizeof answer, 0);
        int frames = n < 0 ? 0 : cannelloni_parse(answer, (size_t)n, f, CANNELLONI_FRAMES_MAX);
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

int main(int argc, char **argv)
{
    long n = argc == 4 ? atol(argv[3]) : 0;
    cannelloni_begin(&word, 0);
    if (n < 1 || !connect_plant(argv[1], argv[2]) || !open_session()) {
        fprintf(stderr, "bench_lockstep: PORT PLANT_PORT EXCHANGES, beside contactplant run --lockstep\n");
        return 1;
    }
    uint32_t begin_tick = tick;
    int64_t begin_ns = clock_ns();
    for (long i = 0; i < n; i++) {
        put(WIRE_STREAM, tick / SUBSTEPS, i % 8, 0.0);
        if (i % 10 == 0)
            put(WIRE_ENABLE, 1.0, frame, 0.0);
        if (!exchange())
            return 1;
    }
    double took_s = 1e-9 * (double)(clock_ns() - begin_ns);
    put(WIRE_CONTROL, CONTROL_STOP, 0xFF - CONTROL_STOP, 0.0);
    (void)exchange();
    printf("%ld exchanges, %.0f/s\n", n, (double)n / took_s);
    return tick - begin_tick < (uint32_t)n * SUBSTEPS;
}
