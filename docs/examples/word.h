/* word.h - a controller's way to a plant in lockstep: one packet out, the plant's bus frame in, and so on,
 * over UDP or through memory that both share (docs/guide/lockstep.md).
 *
 * A wait sends what was said since the last one, an empty packet where that is nothing, and takes the
 * whole answer. Usage: PROGRAM PLANT ME RATE SUBSTEPS [MEMORY], as `command = ./PROGRAM {plant} {me} {rate}
 * {substeps} {memory}` fills in. Without MEMORY it speaks UDP, also to a plant in real time. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* syscall */
#endif
#include <arpa/inet.h>
#include <contactplant.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <math.h>
#include <poll.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum {
    WORD_FRAMES = 256,
    WORD_WHOLE = 1388,   /* a shorter packet ends a bus frame */
    WORD_SLOTS = 32,     /* packets that a ring of the memory holds */
    WORD_APART_US = 400, /* it looks so long before it sleeps: longer than a sleeper takes to wake */
    WORD_UNKNOWN_US = 20,
    WORD_PATIENCE_S = 10,
    WORD_REALTIME_MS = 100 /* in which a plant in real time speaks */
};

/* A ring of packets with one writer and one reader: slot i % WORD_SLOTS has packet i. `processor` is where
 * the writer runs, plus 1; 0: not told. */
struct word_ring {
    uint32_t written, processor, gap[14], taken, gap2[15], asleep, gap3[15];
    struct {
        uint32_t n;
        uint8_t bytes[2044];
    } slot[WORD_SLOTS];
};

static struct word_memory {
    struct word_ring to_plant, from_plant;
} * word_memory; /* NULL: over UDP */

static struct contactplant_frame word_in[4096], word_out[WORD_FRAMES];
static int word_socket, word_n_in, word_next_in, word_n_out;
static unsigned long word_substeps;
static int word_realtime; /* the plant does not wait: a sample needs frames of lead */
static int word_behind;   /* newer frames wait already, so an answer to this one would be late */
static double word_rate_Hz;

static int word_receive(void *unused, struct contactplant_frame *frame)
{
    (void)unused;
    return word_next_in < word_n_in ? (*frame = word_in[word_next_in++], 1) : 0;
}

static int word_send(void *unused, const struct contactplant_frame *frame)
{
    (void)unused;
    return word_n_out < WORD_FRAMES ? (word_out[word_n_out++] = *frame, 1) : 0;
}

static void word_flush(void *unused) /* a wait does it */
{
    (void)unused;
}

static ssize_t word_take(uint8_t *packet);

/* A plant on another processor answers sooner than a sleeper wakes: some looks, 20 us, before the recv that
 * sleeps. After looks in vain, as on one processor, the next 64 recv sleep at once. A program that was
 * stopped and goes on has its recv interrupted: the packet still comes. */
static ssize_t word_packet(uint8_t *packet, size_t size)
{
    static int rest;
    int looks = rest ? 0 : 64, flags;
    ssize_t n;
    if (word_memory)
        return word_take(packet);
    do {
        flags = looks-- > 0 ? MSG_DONTWAIT : 0;
        n = recv(word_socket, packet, size, flags);
    } while (n < 0 && (errno == EINTR || (flags && errno == EAGAIN)));
    rest = rest ? rest - 1 : flags ? 0 : 64;
    return n;
}

static void word_pause(void) /* between two looks, which are too quick otherwise */
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

#ifndef __cplusplus
int sched_getcpu(void); /* where another header stands before this one, sched.h does not declare it */
#endif

static int word_is_there(const struct word_ring *r)
{
    return __atomic_load_n(&r->written, __ATOMIC_SEQ_CST) != r->taken;
}

/* Looks for so many microseconds; 1: there is a packet. */
static int word_look(const struct word_ring *r, long us)
{
    struct timespec begin, now;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    do {
        for (int i = 0; i < 16; i++, word_pause())
            if (word_is_there(r))
                return 1;
        clock_gettime(CLOCK_MONOTONIC, &now);
    } while ((now.tv_sec - begin.tv_sec) * 1000000 + (now.tv_nsec - begin.tv_nsec) / 1000 < us);
    return 0;
}

/* Looks while the plant answers on another processor. On this one it waits for it. After looks in vain the
 * next waits sleep at once: 1, 3, 7 and at most 63, until a look finds a packet. */
static void word_look_before_sleep(const struct word_ring *r)
{
    static unsigned at_once, in_vain;
    uint32_t there = __atomic_load_n(&r->processor, __ATOMIC_SEQ_CST), here = (uint32_t)sched_getcpu() + 1;
    if (word_is_there(r) || (there && there == here))
        return;
    if (at_once)
        at_once--;
    else
        at_once = in_vain =
            word_look(r, there ? WORD_APART_US : WORD_UNKNOWN_US) ? 0 : (2 * in_vain + 1) & 63;
}

/* A packet of the memory; -1 after silence, or when the plant has ended: that is a packet of no bytes. The
 * plant looks, too, so most words are there before a sleep. */
static ssize_t word_take(uint8_t *packet)
{
    const struct timespec patience = {WORD_PATIENCE_S, 0};
    struct word_ring *r = &word_memory->from_plant;
    uint32_t i = r->taken;
    word_look_before_sleep(r);
    while (__atomic_load_n(&r->written, __ATOMIC_SEQ_CST) == i) {
        __atomic_store_n(&r->asleep, 1, __ATOMIC_SEQ_CST);
        if (__atomic_load_n(&r->written, __ATOMIC_SEQ_CST) == i &&
            syscall(SYS_futex, &r->written, FUTEX_WAIT, i, &patience, NULL, 0) < 0 && errno == ETIMEDOUT)
            return -1;
    }
    __atomic_store_n(&r->asleep, 0, __ATOMIC_SEQ_CST);
    size_t n = r->slot[i % WORD_SLOTS].n;
    int good = n > 0 && n <= sizeof r->slot->bytes;
    if (good)
        memcpy(packet, r->slot[i % WORD_SLOTS].bytes, n);
    __atomic_store_n(&r->taken, i + 1, __ATOMIC_SEQ_CST);
    return good ? (ssize_t)n : (errno = EPIPE, -1);
}

/* The plant takes a word for each answer: there is always a free slot. */
static void word_put(const uint8_t *packet, size_t n)
{
    struct word_ring *r = &word_memory->to_plant;
    r->slot[r->written % WORD_SLOTS].n = (uint32_t)n;
    memcpy(r->slot[r->written % WORD_SLOTS].bytes, packet, n);
    __atomic_store_n(&r->processor, (uint32_t)sched_getcpu() + 1, __ATOMIC_SEQ_CST);
    __atomic_store_n(&r->written, r->written + 1, __ATOMIC_SEQ_CST);
    if (__atomic_load_n(&r->asleep, __ATOMIC_SEQ_CST))
        syscall(SYS_futex, &r->written, FUTEX_WAKE, 1, NULL, NULL, 0);
}

/* Something comes within that time, over UDP. */
static int word_hears(int milliseconds)
{
    struct pollfd socket = {word_socket, POLLIN, 0};
    return !word_memory && poll(&socket, 1, milliseconds) > 0;
}

/* One bus frame. A plant that is not up yet refuses the word; it is said again. One that has answered and
 * refuses has ended. */
static double word_wait(void *unused, double seconds)
{
    static uint8_t sequence, packet[2048];
    static int answered;
    ssize_t n;
    int taken = 0, silent = word_behind && !word_n_out;
    (void)unused, (void)seconds;
    size_t size = contactplant_pack(sequence++, word_out, word_n_out, packet, &taken);
    memmove(word_out, word_out + taken, (size_t)(word_n_out -= taken) * sizeof *word_out);
    word_n_in = word_next_in = 0;
    do {
        if (word_memory)
            word_put(packet, size);
        else if (!silent)
            (void)!send(word_socket, packet, size, 0);
        n = word_packet(packet, sizeof packet);
    } while (n < 0 && errno == ECONNREFUSED && !answered && !usleep(10000));
    answered |= n >= 0;
    for (; n >= 0; n = n < WORD_WHOLE ? -2 : word_packet(packet, sizeof packet)) {
        int got = contactplant_unpack(packet, (size_t)n, word_in + word_n_in, 4096 - word_n_in);
        word_n_in += got > 0 ? got : 0;
    }
    word_behind = word_realtime && word_hears(0);
    return n == -2 ? 1.0 / word_rate_Hz : -1.0; /* time is bus frames; silence ends the wait */
}

static void word_must(int good, const char *why)
{
    if (!good)
        exit((fprintf(stderr, "%s\n", why), 1));
}

static struct sockaddr_in word_address(const char *text)
{
    struct sockaddr_in at;
    char host[64] = "";
    const char *colon = strrchr(text, ':');
    memset(&at, 0, sizeof at);
    at.sin_family = AF_INET;
    snprintf(host, sizeof host, "%.*s", colon ? (int)(colon - text) : 0, text);
    word_must(colon && inet_pton(AF_INET, host, &at.sin_addr) == 1, "write an address as 127.0.0.1:20000");
    at.sin_port = htons((uint16_t)atoi(colon + 1));
    return at;
}

/* Answers that another controller has left there are not for this one. */
static void word_map(const char *path)
{
    int file = open(path, O_RDWR);
    word_must(file >= 0 && lseek(file, 0, SEEK_END) == (off_t)sizeof *word_memory,
              "the plant's memory cannot be opened");
    void *at = mmap(NULL, sizeof *word_memory, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    word_must(at != MAP_FAILED, "the plant's memory cannot be mapped");
    word_memory = (struct word_memory *)at;
    struct word_ring *r = &word_memory->from_plant;
    __atomic_store_n(&r->taken, __atomic_load_n(&r->written, __ATOMIC_SEQ_CST), __ATOMIC_SEQ_CST);
}

static void word_connect(const char *to, const char *from)
{
    const struct timeval patience = {WORD_PATIENCE_S, 0};
    struct sockaddr_in plant = word_address(to), me = word_address(from);
    word_socket = socket(AF_INET, SOCK_DGRAM, 0);
    setsockopt(word_socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    word_must(!bind(word_socket, (struct sockaddr *)&me, sizeof me), "my port is in use");
    word_must(!connect(word_socket, (struct sockaddr *)&plant, sizeof plant), "no way to the plant");
}

/* The plant that the controller expects: keys of a scene's [plant]. */
#ifndef WORD_PLANT
#define WORD_PLANT "model = hertz_rig"
#endif

/* A client in a session of its own with that plant, whose time runs. */
static struct contactplant_client *word_begin(int argc, char **argv)
{
    static union contactplant_client_memory memory;
    static const struct contactplant_transport transport = {NULL, word_receive, word_send, word_flush,
                                                            word_wait};
    struct contactplant_error error;
    char scene[160];
    word_must(argc == 5 || argc == 6,
              "usage: PROGRAM PLANT ME RATE SUBSTEPS [MEMORY], addresses as 127.0.0.1:20000");
    word_rate_Hz = atof(argv[3]);
    word_substeps = strtoul(argv[4], NULL, 10);
    if (argc == 6)
        word_map(argv[5]);
    else
        word_connect(argv[1], argv[2]);
    snprintf(scene, sizeof scene, "[plant]\n" WORD_PLANT "\n[deadline]\nframe = %.17g s\nsubsteps = %lu\n",
             1.0 / word_rate_Hz, word_substeps);
    struct contactplant_client *c =
        contactplant_client_open(&memory, sizeof memory, scene, &transport, &error);
    word_must(c != NULL, error.text);
    word_must(!contactplant_client_begin(c, 5.0), contactplant_client_error(c));
    int status = 1;
    for (int i = 0; i < 20 && status; i++) { /* again where the link lost it */
        word_must(!contactplant_client_control(c, CONTACTPLANT_START, 0), contactplant_client_error(c));
        status = contactplant_client_wait(c, CONTACTPLANT_WAIT_STATE, CONTACTPLANT_STATE_RUNNING, 0.05);
        contactplant_client_heartbeat(c);
    }
    word_must(!status, "the plant does not start");
    word_realtime = word_hears(WORD_REALTIME_MS + (int)(2000.0 / word_rate_Hz)); /* in lockstep it waits */
    return c;
}

/* The next plant frame into *now, with a heartbeat; 0 when the session is over. The link may lose the first
 * MOTION: the frames before any was heard are passed over, for one NaN would stay in a controller's sums. */
static int word_next(struct contactplant_client *c, struct contactplant_latest *now)
{
    int status;
    contactplant_client_latest(c, now, sizeof *now);
    do {
        if (!word_behind) /* an old frame's heartbeat would be refused */
            contactplant_client_heartbeat(c);
        status = contactplant_client_wait(c, CONTACTPLANT_WAIT_CONTACT, now->contact_tick + 1, 1.0);
        contactplant_client_latest(c, now, sizeof *now);
    } while (!status && now->session && isnan(now->displacement_m));
    return !status && now->session;
}
