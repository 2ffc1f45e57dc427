/* socketcan.c - a Linux CAN interface by a raw socket; see socketcan.h. */
#include "hal/posix/socketcan.h"

#ifdef __linux__

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>
#include "hal/posix/clock.h"

enum {
    RECEIVE_TRIES = 64, /* confirmations, error frames without news and signals that one recv passes over */
    PASSIVE_OR_WARNING =
        CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING | CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE
};

/* ---- receiving ---- */

/* The fault bits of an error frame, counted. */
static int read_error_frame(struct socketcan *s, const struct can_frame *f)
{
    int fault = 0;
    if (f->can_id & CAN_ERR_BUSOFF) {
        s->bus_off++;
        fault |= HAL_BUS_OFF;
    }
    if (f->can_id & CAN_ERR_CRTL && f->data[1] & PASSIVE_OR_WARNING) {
        s->passive++;
        fault |= HAL_ERROR_PASSIVE;
    }
    if (f->can_id & CAN_ERR_CRTL && f->data[1] & CAN_ERR_CRTL_RX_OVERFLOW) {
        s->dropped++;
        fault |= HAL_DROPPED;
    }
    s->restarted += (f->can_id & CAN_ERR_RESTARTED) != 0;
    return fault;
}

static uint64_t nanoseconds(const struct timespec *t)
{
    return (uint64_t)t->tv_sec * 1000000000u + (uint64_t)t->tv_nsec;
}

/* Reads the kernel's report beside the frame: its arrival time and how many frames it had to drop. */
static int read_control(struct socketcan *s, struct msghdr *m, uint64_t *arrived_ns)
{
    uint32_t seen = s->dropped_seen;
    for (struct cmsghdr *c = CMSG_FIRSTHDR(m); c; c = CMSG_NXTHDR(m, c)) {
        struct timespec t;
        if (c->cmsg_level != SOL_SOCKET)
            continue;
        if (c->cmsg_type == SO_RXQ_OVFL)
            memcpy(&seen, CMSG_DATA(c), sizeof seen);
        if (c->cmsg_type == SO_TIMESTAMPNS) {
            memcpy(&t, CMSG_DATA(c), sizeof t);
            *arrived_ns = nanoseconds(&t);
        }
    }
    uint32_t dropped = seen - s->dropped_seen;
    s->dropped_seen = seen;
    s->dropped += dropped;
    return dropped ? HAL_DROPPED : 0;
}

static void unpack_frame(const struct can_frame *in, struct frame *out)
{
    bool extended = (in->can_id & CAN_EFF_FLAG) != 0;
    out->id = in->can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    out->flags = extended ? FRAME_EXTENDED : 0;
    out->length = in->can_dlc <= FRAME_DATA ? in->can_dlc : FRAME_DATA;
    memcpy(out->data, in->data, FRAME_DATA);
}

/* An outage begins: HAL_DOWN once, however often it is met before the next frame goes or comes. */
static int note_down(struct socketcan *s)
{
    struct timespec t;
    if (s->is_down)
        return 0;
    clock_gettime(CLOCK_REALTIME, &t);
    s->down_ns = nanoseconds(&t);
    s->is_down = true;
    s->down++;
    return HAL_DOWN;
}

/* The fault bits of a failed read; -1 when there was just nothing to read. */
static int receive_failed(struct socketcan *s)
{
    if (errno == EAGAIN || errno == EWOULDBLOCK)
        return -1;
    if (errno == EINTR)
        return 0;
    return note_down(s);
}

/* Takes one message from the socket, a frame into s->frame. Returns the fault bits it gave, -1 when none
 * waited. */
static int receive_message(struct socketcan *s)
{
    union {
        struct can_frame classic;
        struct canfd_frame longer; /* room, so that a longer frame is seen as such */
    } in;
    union {
        struct cmsghdr align;
        char bytes[CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t))];
    } control;
    uint64_t arrived_ns = 0;
    if (s->taken == SOCKETCAN_TURN)
        return -1;
    s->taken++;
    struct iovec data = {&in, sizeof in};
    struct msghdr m = {.msg_iov = &data, .msg_iovlen = 1};
    m.msg_control = &control;
    m.msg_controllen = sizeof control;
    ssize_t n = recvmsg(s->socket, &m, MSG_DONTWAIT);
    if (n < 0)
        return receive_failed(s);
    int fault = read_control(s, &m, &arrived_ns);
    if (n != CAN_MTU) {
        s->foreign++;
        return fault | HAL_FOREIGN;
    }
    if (in.classic.can_id & CAN_ERR_FLAG)
        return fault | read_error_frame(s, &in.classic);
    if (m.msg_flags & MSG_CONFIRM) {
        s->confirmed++;
        s->confirmed_ns = arrived_ns;
        return fault;
    }
    unpack_frame(&in.classic, &s->frame);
    s->has_frame = true;
    if (arrived_ns > s->down_ns) /* one that had waited since before says nothing */
        s->is_down = false;
    s->received++;
    s->received_ns = arrived_ns;
    return fault;
}

static int receive(void *context, struct frame *f)
{
    struct socketcan *s = context;
    if (s->send_fault) {
        int fault = s->send_fault;
        s->send_fault = 0;
        return -fault;
    }
    for (int i = 0; i < RECEIVE_TRIES && !s->has_frame; i++) {
        int fault = receive_message(s);
        if (fault < 0)
            s->taken = 0; /* the turn ends */
        if (fault)
            return fault < 0 ? 0 : -fault;
    }
    if (!s->has_frame)
        return 0;
    *f = s->frame;
    s->has_frame = false;
    return 1;
}

/* ---- sending ---- */

static int transmit(void *context, const struct frame *f)
{
    struct socketcan *s = context;
    struct can_frame out = {.can_id = f->id | (f->flags & FRAME_EXTENDED ? CAN_EFF_FLAG : 0)};
    out.can_dlc = f->length;
    memcpy(out.data, f->data, FRAME_DATA);
    if (send(s->socket, &out, CAN_MTU, MSG_DONTWAIT) == CAN_MTU) {
        s->sent++;
        s->is_down = false;
        return 1;
    }
    if (errno == ENOBUFS || errno == EAGAIN || errno == EWOULDBLOCK) {
        s->kernel_full++;
    } else {
        /* A failed send takes the socket's pending error with it: recv would never see it. */
        s->send_failed++;
        s->send_fault |= note_down(s);
    }
    return 0;
}

static void flush(void *context)
{
    struct socketcan *s = context; /* every frame has gone out already */
    s->taken = 0;
}

/* ---- opening ---- */

static const char *refuse(struct socketcan *s, const char *interface, const char *what)
{
    snprintf(s->reason, sizeof s->reason, "socketcan: %.15s: %s", interface, what);
    socketcan_close(s);
    return s->reason;
}

static const char *socket_reason(int error)
{
    switch (error) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
        return "this kernel has no SocketCAN: load can_raw, or use UDP";
    case EPERM:
    case EACCES:
        return "no permission for a raw CAN socket: run as root or with CAP_NET_RAW, or use UDP";
    default:
        return strerror(error);
    }
}

static const char *bind_reason(int error)
{
    if (error == ENODEV)
        return "is not a CAN interface: `ip -details link show type can` and `type vcan` list those there "
               "are";
    return strerror(error);
}

/* A filter for each plant. */
static bool set_filters(struct socketcan *s, const struct socketcan_config *c)
{
    const uint32_t number = c->extended ? CAN_EFF_MASK : CAN_SFF_MASK, n = c->n_plants ? c->n_plants : 1;
    struct can_filter filter[SOCKETCAN_PLANTS];
    if (n > SOCKETCAN_PLANTS) {
        errno = E2BIG;
        return false;
    }
    for (uint32_t i = 0; i < n; i++)
        filter[i] = (struct can_filter){
            .can_id = (c->base_id + i * FRAME_IDS) | (c->extended ? CAN_EFF_FLAG : 0),
            .can_mask = (number & ~(uint32_t)(FRAME_IDS - 1)) | CAN_EFF_FLAG | CAN_RTR_FLAG};
    return setsockopt(s->socket, SOL_CAN_RAW, CAN_RAW_FILTER, filter, (socklen_t)(n * sizeof *filter)) == 0;
}

/* Everything that decides what the socket hears. False when the kernel refuses an option. */
static bool set_options(struct socketcan *s, const struct socketcan_config *c)
{
    const can_err_mask_t errors = CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
    const int on = 1, own = c->confirm, bytes = SOCKETCAN_BUFFER;
    bool ok = set_filters(s, c);
    ok = ok && setsockopt(s->socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) == 0;
    ok = ok && setsockopt(s->socket, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &own, sizeof own) == 0;
    ok = ok && setsockopt(s->socket, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) == 0;
    ok = ok && setsockopt(s->socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) == 0;
    /* more than the system's limit where we may (root), else as much as it grants */
    return ok && (setsockopt(s->socket, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) == 0 ||
                  setsockopt(s->socket, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes) == 0);
}

const char *socketcan_open(struct socketcan *s, const struct socketcan_config *c)
{
    struct sockaddr_can address = {.can_family = AF_CAN};
    memset(s, 0, sizeof *s);
    s->hal = (struct hal){s, receive, transmit, flush, clock_now_us, clock_no_watchdog};
    s->socket = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    if (s->socket < 0)
        return refuse(s, c->interface, socket_reason(errno));
    address.can_ifindex = (int)if_nametoindex(c->interface);
    if (!address.can_ifindex)
        return refuse(s, c->interface,
                      "no such interface: `ip link` lists those there are; for a virtual one, "
                      "`ip link add dev vcan0 type vcan` and `ip link set vcan0 up`");
    if (!set_options(s, c))
        return refuse(s, c->interface, strerror(errno));
    if (bind(s->socket, (const struct sockaddr *)&address, sizeof address) != 0)
        return refuse(s, c->interface, bind_reason(errno));
    socklen_t length = sizeof s->receive_bytes;
    getsockopt(s->socket, SOL_SOCKET, SO_RCVBUF, &s->receive_bytes, &length);
    getsockopt(s->socket, SOL_SOCKET, SO_SNDBUF, &s->send_bytes, &length);
    return NULL;
}

void socketcan_close(struct socketcan *s)
{
    if (s->socket >= 0)
        close(s->socket);
    s->socket = -1;
}

#else

const char *socketcan_open(struct socketcan *s, const struct socketcan_config *c)
{
    (void)s, (void)c;
    return "socketcan: only Linux has it; use UDP";
}

void socketcan_close(struct socketcan *s)
{
    (void)s;
}

#endif
