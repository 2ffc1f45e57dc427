/* bench_plants.c - one controller for each plant of contactplant run --plants, in real time, over one socket.
 *
 *   bench_plants PORT PLANT_PORT PLANTS SECONDS
 *
 * Each opens a session, starts its plant, streams a force in each bus frame and says its heartbeat in each
 * tenth. They end SECONDS after the last plant was started. Prints what was heard; fails where a plant does
 * not run then. */
#include "firmware/bus/wire.h"
#include "hal/hal.h"
#include "hal/link/cannelloni.h"
#include "hal/posix/clock.h"

#include <arpa/inet.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <time.h>

enum { PLANTS = 512, SUBSTEPS = 64, AHEAD = 4, BASE = 0x200, BEATS = 10, OPENING_S = 20, BUFFER = 8 << 20 };

/* A controller and the last that it heard. */
struct member {
    uint8_t counter[WIRE_COMMANDS], session, session_seen, state;
    uint32_t frame, tick;
};

static struct member member[PLANTS];
static int link_to_plants, n_plants;
static struct cannelloni packet;
static unsigned long long frames_heard;

static struct wire_scene scene_of(int i)
{
    return (struct wire_scene){.base_id = (uint32_t)(BASE + i * FRAME_IDS),
                               .extended = true,
                               .frame_rate_Hz = 1e3,
                               .dilation = 1.0,
                               .substeps = SUBSTEPS,
                               .lsb = {1.0, 1.0, 1.0, 1.0}};
}

static void say_packet(void)
{
    if (packet.n_frames)
        (void)!send(link_to_plants, packet.bytes, packet.n_bytes, 0);
    cannelloni_next(&packet);
}

static void put(int i, unsigned kind, double first, double second, double third)
{
    struct member *m = &member[i];
    const struct wire_scene scene = scene_of(i);
    const struct message command = {
        .kind = (uint8_t)kind, .counter = m->counter[kind], .value = {m->session, first, second, third}};
    struct frame f;
    m->counter[kind] = (uint8_t)((m->counter[kind] + 1) % WIRE_COUNTER_STATES);
    wire_encode(&scene, &command, &f);
    if (!cannelloni_has_room(&packet, &f))
        say_packet();
    cannelloni_add(&packet, &f);
}

static void hear(const struct frame *f)
{
    uint32_t i = (f->id - BASE) / FRAME_IDS, kind = f->id % FRAME_IDS;
    struct message m;
    frames_heard++;
    if (i >= (uint32_t)n_plants || (kind != WIRE_STATUS && kind != WIRE_SYNC))
        return;
    const struct wire_scene scene = scene_of((int)i);
    if (wire_decode(&scene, f, &m) != WIRE_OK)
        return;
    if (m.kind == WIRE_STATUS) {
        member[i].session_seen = (uint8_t)m.value[SESSION];
        member[i].state = (uint8_t)m.value[STATUS_STATE];
        member[i].frame = (uint32_t)m.value[STATUS_FRAME];
    } else {
        member[i].tick = (uint32_t)m.value[SYNC_TICK];
    }
}

static void hear_all(void)
{
    static struct frame f[CANNELLONI_FRAMES_MAX];
    static uint32_t passed_over;
    uint8_t bytes[CANNELLONI_PACKET_MAX];
    ssize_t n;
    while ((n = recv(link_to_plants, bytes, sizeof bytes, MSG_DONTWAIT)) > 0) {
        int frames = cannelloni_parse(bytes, (size_t)n, f, CANNELLONI_FRAMES_MAX, &passed_over);
        for (int k = 0; k < frames; k++)
            hear(&f[k]);
    }
}

/* Controller i in bus frame n. */
static void speak(int i, long n)
{
    struct member *m = &member[i];
    if (!m->frame)
        return;
    bool open = m->session && m->session_seen == m->session;
    if (!open && n % BEATS == i % BEATS) {
        m->session = (uint8_t)(m->session_seen % WIRE_SESSIONS + 1);
        put(i, WIRE_ENABLE, 1.0, m->frame, 0.0);
    }
    if (!open)
        return;
    if (n % BEATS == i % BEATS) {
        put(i, WIRE_ENABLE, 1.0, m->frame, 0.0);
        if (m->state != STATE_RUNNING)
            put(i, WIRE_CONTROL, CONTROL_START, 0xFF - CONTROL_START, m->frame);
    }
    if (m->state == STATE_RUNNING)
        put(i, WIRE_STREAM, (double)((m->tick / SUBSTEPS + AHEAD) & 0xFFFF), (double)((n + i) % 8), 0.0);
}

static int running(void)
{
    int n = 0;
    for (int i = 0; i < n_plants; i++)
        n += member[i].state == STATE_RUNNING;
    return n;
}

static bool connect_plants(const char *port, const char *plant_port)
{
    struct sockaddr_in own = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}}, other = own;
    int bytes = BUFFER;
    own.sin_port = htons((uint16_t)atoi(port));
    other.sin_port = htons((uint16_t)atoi(plant_port));
    link_to_plants = socket(AF_INET, SOCK_DGRAM, 0);
    if (setsockopt(link_to_plants, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes))
        setsockopt(link_to_plants, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    return bind(link_to_plants, (struct sockaddr *)&own, sizeof own) == 0 &&
           connect(link_to_plants, (struct sockaddr *)&other, sizeof other) == 0;
}

int main(int argc, char **argv)
{
    n_plants = argc == 5 ? atoi(argv[3]) : 0;
    cannelloni_begin(&packet, 0);
    if (n_plants < 1 || n_plants > PLANTS || !connect_plants(argv[1], argv[2])) {
        fprintf(stderr, "bench_plants: PORT PLANT_PORT PLANTS SECONDS, beside contactplant run --plants\n");
        return 1;
    }
    int64_t begin_ns = clock_ns(), end_ns = begin_ns + OPENING_S * INT64_C(1000000000);
    bool all = false;
    for (long n = 0; clock_ns() < end_ns; n++) {
        const struct timespec rest = {.tv_nsec = 900000};
        hear_all();
        for (int i = 0; i < n_plants; i++)
            speak(i, n);
        say_packet();
        if (!all && running() == n_plants) {
            all = true;
            end_ns = clock_ns() + (int64_t)(atof(argv[4]) * 1e9);
        }
        nanosleep(&rest, NULL);
    }
    hear_all();
    printf("%d of %d plants run, %llu frames heard\n", running(), n_plants, frames_heard);
    return running() != n_plants;
}
