/* controller_udp.c - your own controller over UDP: shakes the plant, and presses when the contact opens.
 *
 *   contactplant run &
 *   cc controller_udp.c $(pkg-config --cflags --libs contactplant) && ./a.out [PLANT'S PORT [OWN PORT]]
 * A plant answers its listed peers only: port 20001 is one, run --peer 127.0.0.1:PORT lists others. With
 * run --lockstep the plant waits for this controller, which says a word for each bus frame it hears. */
#include <arpa/inet.h>
#include <contactplant.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>

static struct pollfd udp;
static struct contactplant_frame in[CONTACTPLANT_PACKET_FRAMES], out[64];
static uint8_t sequence;
static int n_in, next, n_out, is_due = 1; /* is_due: a bus frame was heard whole, and not yet answered */

static int receive(void *unused, struct contactplant_frame *frame)
{
    uint8_t packet[2048];
    (void)unused;
    for (; next >= n_in; next = 0) {
        ssize_t n = recv(udp.fd, packet, sizeof packet, MSG_DONTWAIT);
        if (n < 0)
            return is_due |= errno == ECONNREFUSED, 0; /* said again where the plant is not up yet */
        is_due = n < 1388;                             /* a longer packet has another one behind it */
        n_in = contactplant_unpack(packet, (size_t)n, in, CONTACTPLANT_PACKET_FRAMES);
    }
    *frame = in[next++];
    return 1;
}

static int transmit(void *unused, const struct contactplant_frame *frame)
{
    (void)unused;
    return n_out < 64 ? (out[n_out++] = *frame, 1) : 0;
}

static void flush(void *unused)
{
    uint8_t packet[CONTACTPLANT_PACKET];
    (void)unused;
    (void)!send(udp.fd, packet, contactplant_pack(sequence++, out, n_out, packet, NULL), 0);
    n_out = 0;
    is_due = 0;
}

static double wait_for_it(void *unused, double seconds)
{
    (void)seconds;
    if (is_due)
        flush(unused);
    poll(&udp, 1, 1);
    return 1e-3; /* a bus frame, or this long without one */
}

static void must(int good, const char *why)
{
    if (!good)
        exit((fprintf(stderr, "%s\n", why), 1));
}

int main(int argc, char **argv)
{
    static union contactplant_client_memory memory;
    struct contactplant_transport transport = {NULL, receive, transmit, flush, wait_for_it};
    struct contactplant_error error;
    struct contactplant_latest now;
    static struct sockaddr_in at;
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons((uint16_t)atoi(argc > 2 ? argv[2] : "20001"));
    udp.fd = socket(AF_INET, SOCK_DGRAM, 0);
    udp.events = POLLIN;
    must(!bind(udp.fd, (struct sockaddr *)&at, sizeof at), "my port is in use");
    at.sin_port = htons((uint16_t)atoi(argc > 1 ? argv[1] : "20000"));
    must(!connect(udp.fd, (struct sockaddr *)&at, sizeof at), "no way to the plant's port");
    struct contactplant_client *me =
        contactplant_client_open(&memory, sizeof memory, "hertz_rig", &transport, &error);
    must(me != NULL, error.text);
    must(!contactplant_client_begin(me, 5.0), contactplant_client_error(me));
    must(!contactplant_client_control(me, CONTACTPLANT_START, 0), contactplant_client_error(me));
    must(!contactplant_client_wait(me, CONTACTPLANT_WAIT_STATE, CONTACTPLANT_STATE_RUNNING, 1.0), "no start");
    contactplant_client_latest(me, &now, sizeof now);
    contactplant_client_arm(me, 0, 3.0, 225.0, 0.0, 0.1); /* 3 N at 225 Hz, 50 frames from now */
    contactplant_client_fire(me, 1, now.tick + 50 * 64, 0.0);
    for (double force_N = 0.0, i = 0; i < 1000 && now.session; i++) {
        must(!contactplant_client_wait(me, CONTACTPLANT_WAIT_CONTACT, now.contact_tick + 1, 1.0), "silence");
        contactplant_client_latest(me, &now, sizeof now);
        force_N = now.in_contact ? 0.999 * force_N : force_N < 40.0 ? force_N + 1.0 : 40.0;
        contactplant_client_stream(me, 0, now.contact_tick / 64 + 2, force_N);
        contactplant_client_heartbeat(me);
    }
    printf("touchdowns %lu, refused %lu\n", (unsigned long)now.touchdowns, (unsigned long)now.refused);
    contactplant_client_control(me, CONTACTPLANT_STOP, 0);
    return contactplant_client_wait(me, CONTACTPLANT_WAIT_STATE, CONTACTPLANT_STATE_STOPPED, 1.0);
}
