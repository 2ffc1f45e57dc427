/* word.h - a controller's way to a plant in lockstep: one packet out, the plant's bus frame in, and so on
 * over UDP.
 *
 * A wait sends what was said since the last one, an empty packet where that is nothing, and takes the
 * whole answer. Usage: PROGRAM PLANT ME RATE SUBSTEPS, as `command = ./PROGRAM {plant} {me} {rate}
 * {substeps}` fills in. */
#include <arpa/inet.h>
#include <contactplant.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { WORD_FRAMES = 256, WORD_WHOLE = 1388 /* a shorter packet ends a bus frame */ };

static struct contactplant_frame word_in[4096], word_out[WORD_FRAMES];
static int word_socket, word_n_in, word_next_in, word_n_out;
static unsigned long word_substeps;
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

/* A plant on another processor answers sooner than a sleeper wakes: some looks, 20 us, before the recv that
 * sleeps. After looks in vain, as on one processor, the next 64 recv sleep at once. A program that was
 * stopped and goes on has its recv interrupted: the packet still comes. */
static ssize_t word_packet(uint8_t *packet, size_t size)
{
    static int rest;
    int looks = rest ? 0 : 64, flags;
    ssize_t n;
    do {
        flags = looks-- > 0 ? MSG_DONTWAIT : 0;
        n = recv(word_socket, packet, size, flags);
    } while (n < 0 && (errno == EINTR || (flags && errno == EAGAIN)));
    rest = rest ? rest - 1 : flags ? 0 : 64;
    return n;
}

/* One bus frame. A plant that is not up yet refuses the word; it is said again. One that has answered and
 * refuses has ended. */
static double word_wait(void *unused, double seconds)
{
    static uint8_t sequence, packet[2048];
    static int answered;
    ssize_t n;
    int taken = 0;
    (void)unused, (void)seconds;
    size_t size = contactplant_pack(sequence++, word_out, word_n_out, packet, &taken);
    memmove(word_out, word_out + taken, (size_t)(word_n_out -= taken) * sizeof *word_out);
    word_n_in = word_next_in = 0;
    do {
        (void)!send(word_socket, packet, size, 0);
        n = word_packet(packet, sizeof packet);
    } while (n < 0 && errno == ECONNREFUSED && !answered && !usleep(10000));
    answered |= n >= 0;
    for (; n >= 0; n = n < WORD_WHOLE ? -2 : word_packet(packet, sizeof packet)) {
        int got = contactplant_unpack(packet, (size_t)n, word_in + word_n_in, 4096 - word_n_in);
        word_n_in += got > 0 ? got : 0;
    }
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

/* A client in a session of its own with a hertz_rig whose time runs. */
static struct contactplant_client *word_begin(int argc, char **argv)
{
    static union contactplant_client_memory memory;
    static const struct contactplant_transport transport = {NULL, word_receive, word_send, word_flush,
                                                            word_wait};
    struct contactplant_error error;
    const struct timeval patience = {10, 0};
    char scene[160];
    word_must(argc == 5, "usage: PROGRAM PLANT ME RATE SUBSTEPS, addresses as 127.0.0.1:20000");
    struct sockaddr_in plant = word_address(argv[1]), me = word_address(argv[2]);
    word_rate_Hz = atof(argv[3]);
    word_substeps = strtoul(argv[4], NULL, 10);
    word_socket = socket(AF_INET, SOCK_DGRAM, 0);
    setsockopt(word_socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    word_must(!bind(word_socket, (struct sockaddr *)&me, sizeof me), "my port is in use");
    word_must(!connect(word_socket, (struct sockaddr *)&plant, sizeof plant), "no way to the plant");
    snprintf(scene, sizeof scene, "[plant]\nmodel = hertz_rig\n[deadline]\nframe = %.17g s\nsubsteps = %lu\n",
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
    return c;
}

/* The next plant frame into *now, with a heartbeat; 0 when the session is over. The link may lose the first
 * MOTION: the frames before any was heard are passed over, for one NaN would stay in a controller's sums. */
static int word_next(struct contactplant_client *c, struct contactplant_latest *now)
{
    int status;
    contactplant_client_latest(c, now, sizeof *now);
    do {
        contactplant_client_heartbeat(c);
        status = contactplant_client_wait(c, CONTACTPLANT_WAIT_CONTACT, now->contact_tick + 1, 1.0);
        contactplant_client_latest(c, now, sizeof *now);
    } while (!status && now->session && isnan(now->displacement_m));
    return !status && now->session;
}
