/* socketcan.h - a Linux CAN interface (can0, vcan0, ...) by a raw SocketCAN socket.
 *
 * Receives the FRAME_IDS identifiers of one plant, or of several that follow each other, data frames only.
 * The kernel's filter compares the extended and remote flags too. So an 11-bit frame is never taken for a
 * 29-bit one with the same number, and remote frames do not come through. CAN FD is off: the kernel does not
 * deliver FD frames to this socket, and a frame whose size is not that of a classic one is refused
 * (HAL_FOREIGN). Own frames do not come back, but other programs of this machine see them.
 *
 * Error frames are on: bus-off, error passive or warning, and a controller's receive overflow become fault
 * bits. After bus-off the kernel drops what was queued and leaves the controller dead, unless the interface
 * was set up with a restart time: `ip link set can0 type can bitrate 1000000 restart-ms 100`. That choice is
 * the interface's; a restart is counted here. Interface down is reported as HAL_DOWN once each time; when it
 * comes up again, traffic goes on. An interface that was removed (an adapter unplugged) has to be opened
 * again.
 *
 * send never blocks. A full transmit queue (ENOBUFS) or an interface that is down makes it return 0: the
 * caller keeps the newest frame of each identifier, so no history piles up here. A CAN controller's queue
 * takes 10 frames unless told otherwise, less than a plant may say in a bus frame: `ip link set can0
 * txqueuelen 1000`.
 *
 * `confirm` asks for our own frames back once they have been on the bus (the kernel marks them MSG_CONFIRM).
 * They are not handed out but counted and dated in confirmed_ns: for measuring transmit latency; leave it off
 * otherwise, since each sent frame then costs a receive call. */
#ifndef HAL_SOCKETCAN_H
#define HAL_SOCKETCAN_H

#include <stdbool.h>
#include <stdint.h>
#include "hal/hal.h"

enum {
    SOCKETCAN_BUFFER =
        4
        << 20, /* receive buffer asked for: a quarter of a second of a full bus; the kernel may grant less */
    SOCKETCAN_PLANTS = 512, /* the kernel takes so many filters */
    SOCKETCAN_TURN = 4096   /* messages taken from one flush to the next, or until none waits */
};

struct socketcan_config {
    const char *interface;
    uint32_t base_id;  /* first of the plant's identifiers, a multiple of FRAME_IDS */
    uint32_t n_plants; /* with FRAME_IDS each, 1..SOCKETCAN_PLANTS; 0: one */
    bool extended;
    bool confirm;
};

/* Counters run since socketcan_open. Read them freely; only the hal writes. */
struct socketcan {
    struct hal hal; /* give this to an app or a client */
    int socket;
    int receive_bytes, send_bytes; /* socket buffers granted */
    uint32_t taken;                /* messages in this turn */
    struct frame frame;            /* taken from the socket, to be handed out */
    bool has_frame;
    bool is_down;          /* an outage was met, and no frame went or came since */
    uint64_t down_ns;      /* when it was met, CLOCK_REALTIME */
    int send_fault;        /* hal_fault bits met by send, for the next recv */
    uint64_t received_ns;  /* when the last frame arrived: kernel time stamp, CLOCK_REALTIME */
    uint64_t confirmed_ns; /* when our last frame had been on the bus, with `confirm` */
    uint32_t confirmed;
    uint32_t received, sent;
    uint32_t foreign;     /* frames refused for their size: HAL_FOREIGN */
    uint32_t dropped;     /* frames lost in the socket's queue (SO_RXQ_OVFL): HAL_DROPPED */
    uint32_t kernel_full; /* sends refused with ENOBUFS or EAGAIN */
    uint32_t send_failed; /* sends refused otherwise, e.g. interface down */
    uint32_t bus_off, restarted, passive, down;
    uint32_t dropped_seen; /* the kernel's count at the last frame */
    char reason[200];      /* text returned by socketcan_open */
};

/* NULL, or the reason with what to do about it (then nothing is open). *s must stay where it is. An
 * interface that exists but is down opens, and reports HAL_DOWN. */
const char *socketcan_open(struct socketcan *s, const struct socketcan_config *c);

void socketcan_close(struct socketcan *s);

#endif
