/* test_socketcan.c - hal/socketcan on a real kernel's vcan0, against a raw socket of the test's own.
 *
 * A program of its own, since it needs SocketCAN and the right to take interfaces down:
 *     tests/can/can_vm.sh -- build/test_socketcan
 * Prints a line per check with its values and `N passed, N failed`. */
#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>
#include "hal/posix/socketcan.h"

enum { BASE = 0x240, EXTENDED_BASE = 0x18DAF140, FLOOD = 20000, WAIT_MS = 10000, QUIET_MS = 1000 };

static int n_passed, n_failed;
static struct socketcan plant, bench;

static void check(const char *name, long long got, long long expected)
{
    int ok = got == expected;
    printf("%s  %s: %lld, expected %lld\n", ok ? "ok  " : "FAIL", name, got, expected);
    n_passed += ok;
    n_failed += !ok;
}

static void check_text(const char *name, const char *got, const char *part)
{
    printf("reason: %s\n", got ? got : "(none)");
    check(name, got && strstr(got, part), 1);
}

/* With CAN FD off the kernel hands out classic frames only: this makes the next one look longer. */
static bool longer;

ssize_t recvmsg(int fd, struct msghdr *m, int flags)
{
    ssize_t n = syscall(SYS_recvmsg, fd, m, flags);
    if (n != CAN_MTU || !longer)
        return n;
    longer = false;
    return CANFD_MTU;
}

/* ---- a raw socket that shares no code with the hal ---- */

static int raw_open(void)
{
    struct sockaddr_can address = {.can_family = AF_CAN, .can_ifindex = (int)if_nametoindex("vcan0")};
    int on = 1, s = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    setsockopt(s, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
    if (s < 0 || bind(s, (struct sockaddr *)&address, sizeof address) != 0) {
        perror("test_socketcan: vcan0");
        exit(1);
    }
    return s;
}

static void raw_send(int s, uint32_t can_id, uint8_t length, uint8_t first)
{
    struct can_frame f = {.can_id = can_id, .can_dlc = length, .data = {first, 2, 3, 4, 5, 6, 7, 8}};
    while (write(s, &f, sizeof f) < 0) /* a full queue drains by itself */
        usleep(100);
}

static void raw_send_error(int s, uint32_t class, uint8_t controller)
{
    struct can_frame f = {.can_id = CAN_ERR_FLAG | class, .can_dlc = 8, .data = {0, controller}};
    check("error frame injected", write(s, &f, sizeof f), sizeof f);
}

/* ---- the hal under test ---- */

static void open_hal(struct socketcan *s, uint32_t base, bool extended, bool confirm)
{
    struct socketcan_config c = {
        .interface = "vcan0", .base_id = base, .extended = extended, .confirm = confirm};
    const char *reason = socketcan_open(s, &c);
    if (reason) {
        printf("FAIL  open: %s\n", reason);
        exit(1);
    }
}

static int take_within(struct socketcan *s, struct frame *f, int ms)
{
    struct pollfd p = {.fd = s->socket, .events = POLLIN};
    int got = s->hal.recv(s->hal.context, f);
    if (got == 0 && poll(&p, 1, ms) > 0)
        got = s->hal.recv(s->hal.context, f);
    return got;
}

static int take(struct socketcan *s, struct frame *f)
{
    return take_within(s, f, WAIT_MS);
}

/* Until the wire is quiet: what a queue let go of may still be on its way when the next sockets open. */
static void drain(struct socketcan *s)
{
    struct frame f;
    while (take_within(s, &f, QUIET_MS) > 0)
        ;
}

static int give(struct socketcan *s, const struct frame *f)
{
    int taken = s->hal.send(s->hal.context, f);
    s->hal.flush(s->hal.context);
    return taken;
}

static void check_frame(const char *name, const struct frame *got, const struct frame *sent)
{
    printf("%s: id %X flags %u length %u\n", name, got->id, got->flags, got->length);
    check(name,
          got->id == sent->id && got->flags == sent->flags && got->length == sent->length &&
              memcmp(got->data, sent->data, sent->length) == 0,
          1);
}

/* ---- the tests ---- */

static void reasons(void)
{
    struct socketcan_config missing = {.interface = "nosuch0", .base_id = BASE};
    struct socketcan_config other = {.interface = "lo", .base_id = BASE};
    check_text("a missing interface is refused", socketcan_open(&plant, &missing),
               "nosuch0: no such interface");
    check_text("an interface that is not CAN is refused", socketcan_open(&plant, &other),
               "is not a CAN interface");
}

static long long ns_of(const struct timespec *t)
{
    return (long long)t->tv_sec * 1000000000 + t->tv_nsec;
}

static void round_trip(const char *name, uint32_t base, bool extended)
{
    const uint8_t flags = extended ? FRAME_EXTENDED : 0;
    struct frame command = {
        .id = base + 0x01, .length = 8, .flags = flags, .data = {1, 2, 3, 4, 5, 6, 7, 0xFF}};
    struct frame answer = {.id = base + 0x3F, .length = 3, .flags = flags, .data = {0xA, 0xB, 0xC}};
    struct frame got = {0};
    struct can_frame raw = {0};
    int watch = raw_open();
    printf("--- round trip, %s\n", name);
    open_hal(&plant, base, extended, false);
    open_hal(&bench, base, extended, false);
    printf("receive buffer granted: %d bytes, send buffer %d bytes\n", plant.receive_bytes, plant.send_bytes);
    check("command taken", give(&bench, &command), 1);
    check("command arrives", take(&plant, &got), 1);
    check_frame("command", &got, &command);
    check("as a raw socket sees it: bytes", read(watch, &raw, sizeof raw), CAN_MTU);
    check("as a raw socket sees it: id and flags", raw.can_id, command.id | (extended ? CAN_EFF_FLAG : 0));
    check("as a raw socket sees it: length", raw.can_dlc, 8);
    struct timespec before, now;
    clock_gettime(CLOCK_REALTIME, &before);
    check("answer taken", give(&plant, &answer), 1);
    check("answer arrives", take(&bench, &got), 1);
    check_frame("answer", &got, &answer);
    check("own frames do not come back", plant.hal.recv(&plant, &got), 0);
    check("nor are they confirmed", plant.confirmed, 0);
    clock_gettime(CLOCK_REALTIME, &now);
    long long age_ns = ns_of(&now) - (long long)bench.received_ns;
    printf("age of the receive time stamp: %lld us\n", age_ns / 1000);
    check("the receive time stamp is between sending and reading",
          age_ns >= 0 && (long long)bench.received_ns >= ns_of(&before), 1);
    close(watch);
    socketcan_close(&plant);
    socketcan_close(&bench);
}

/* Nothing of what is refused arrives: the frame sent after it is the next one received. */
static void only_the_marker_arrives(const char *name, int raw, uint8_t mark)
{
    struct frame got = {0};
    raw_send(raw, BASE, 1, mark);
    check(name, take(&plant, &got) == 1 && got.id == BASE && got.length == 1 ? got.data[0] : -1, mark);
}

static void filters(void)
{
    int raw = raw_open();
    struct canfd_frame fd = {.can_id = BASE + 1, .len = 12};
    printf("--- filters\n");
    open_hal(&plant, BASE, false, false);
    raw_send(raw, BASE - 1, 8, 0);
    raw_send(raw, BASE + 0x40, 8, 0);
    only_the_marker_arrives("identifiers below and above ours are refused", raw, 1);
    raw_send(raw, (BASE + 1) | CAN_EFF_FLAG, 8, 0);
    only_the_marker_arrives("the same number with 29 bits is refused", raw, 2);
    raw_send(raw, (BASE + 1) | CAN_RTR_FLAG, 8, 0);
    only_the_marker_arrives("a remote frame is refused", raw, 3);
    check("CAN FD frame sent", write(raw, &fd, sizeof fd), CANFD_MTU);
    only_the_marker_arrives("a CAN FD frame is refused", raw, 4);
    check("received", plant.received, 4);
    struct frame got = {0};
    longer = true;
    raw_send(raw, BASE + 1, 8, 0);
    check("a longer frame, if one came, is refused", take(&plant, &got), -HAL_FOREIGN);
    check("and counted", plant.foreign, 1);
    only_the_marker_arrives("the one behind it comes", raw, 5);
    socketcan_close(&plant);
    open_hal(&plant, EXTENDED_BASE, true, false);
    raw_send(raw, (EXTENDED_BASE + 0x40) | CAN_EFF_FLAG, 8, 0);
    raw_send(raw, EXTENDED_BASE & CAN_SFF_MASK, 8, 0);
    raw_send(raw, (EXTENDED_BASE + 0x3F) | CAN_EFF_FLAG, 1, 5);
    check("with a 29-bit base only its 64 identifiers arrive",
          take(&plant, &got) == 1 ? (long long)got.id : -1, EXTENDED_BASE + 0x3F);
    socketcan_close(&plant);
    close(raw);
}

/* The identifiers of plants that follow each other. */
static void many_plants(void)
{
    static const uint32_t ours[] = {EXTENDED_BASE, EXTENDED_BASE + 0x7F, EXTENDED_BASE + 0xBF};
    struct socketcan_config c = {
        .interface = "vcan0", .base_id = EXTENDED_BASE, .n_plants = SOCKETCAN_PLANTS + 1, .extended = true};
    struct frame got = {0};
    int raw = raw_open();
    printf("--- several plants\n");
    check_text("more plants than filters are refused", socketcan_open(&plant, &c), "Argument list too long");
    c.n_plants = SOCKETCAN_PLANTS;
    check("as many as there are filters", socketcan_open(&plant, &c) == NULL, 1);
    socketcan_close(&plant);
    c.n_plants = 3;
    check("three plants", socketcan_open(&plant, &c) == NULL, 1);
    raw_send(raw, (EXTENDED_BASE - 1) | CAN_EFF_FLAG, 8, 0);
    raw_send(raw, (EXTENDED_BASE + 0xC0) | CAN_EFF_FLAG, 8, 0);
    for (int i = 0; i < 3; i++)
        raw_send(raw, ours[i] | CAN_EFF_FLAG, 8, 0);
    for (int i = 0; i < 3; i++)
        check("only their identifiers arrive", take(&plant, &got) == 1 ? (long long)got.id : -1, ours[i]);
    socketcan_close(&plant);
    close(raw);
}

static void error_frames(void)
{
    int raw = raw_open();
    struct frame got;
    printf("--- error frames\n");
    open_hal(&plant, BASE, false, false);
    raw_send_error(raw, CAN_ERR_BUSOFF, 0);
    check("bus-off", take(&plant, &got), -HAL_BUS_OFF);
    raw_send_error(raw, CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    check("error passive", take(&plant, &got), -HAL_ERROR_PASSIVE);
    raw_send_error(raw, CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING);
    check("error warning", take(&plant, &got), -HAL_ERROR_PASSIVE);
    raw_send_error(raw, CAN_ERR_CRTL | CAN_ERR_BUSOFF, CAN_ERR_CRTL_TX_PASSIVE);
    check("two in one frame", take(&plant, &got), -(HAL_BUS_OFF | HAL_ERROR_PASSIVE));
    raw_send_error(raw, CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
    check("controller overflow", take(&plant, &got), -HAL_DROPPED);
    raw_send_error(raw, CAN_ERR_ACK | CAN_ERR_PROT | CAN_ERR_BUSERROR,
                   0); /* classes that were not asked for */
    only_the_marker_arrives("others say nothing", raw, 7);
    raw_send_error(raw, CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
    only_the_marker_arrives("error active again is no fault", raw, 8);
    raw_send_error(raw, CAN_ERR_RESTARTED, 0);
    only_the_marker_arrives("a restart is no fault", raw, 6);
    check("counted: bus-off", plant.bus_off, 2);
    check("counted: passive", plant.passive, 3);
    check("counted: restarts", plant.restarted, 1);
    socketcan_close(&plant);
    close(raw);
}

static void confirmation(void)
{
    struct frame f = {.id = BASE + 0x14, .length = 8}, got;
    printf("--- transmit confirmation\n");
    open_hal(&plant, BASE, false, true);
    check("sent", give(&plant, &f), 1);
    check("the confirmation is not handed out", take_within(&plant, &got, QUIET_MS), 0);
    check("confirmed", plant.confirmed, 1);
    check("dated", plant.confirmed_ns > 0, 1);
    socketcan_close(&plant);
}

/* Every frame sent is either received or counted as dropped. */
static void receive_overflow(void)
{
    int raw = raw_open();
    struct frame got;
    long long received = 0, faults = 0;
    printf("--- receive overflow\n");
    open_hal(&plant, BASE, false, false);
    for (int i = 0; i < FLOOD; i++)
        raw_send(raw, BASE + 4, 8, (uint8_t)i);
    for (int n = 1; n != 0;) {
        n = plant.hal.recv(&plant, &got);
        received += n > 0;
        faults += n == -HAL_DROPPED;
    }
    raw_send(raw, BASE + 4, 8, 0); /* the kernel tells its count with the next frame */
    for (int n = 1; n != 0;) {
        n = take_within(&plant, &got, QUIET_MS);
        received += n > 0;
        faults += n == -HAL_DROPPED;
    }
    printf("received %lld, dropped %u, reported %lld times\n", received, plant.dropped, faults);
    check("received + dropped", received + plant.dropped, FLOOD + 1);
    check("some were dropped", plant.dropped > 0, 1);
    check("HAL_DROPPED was reported", faults > 0, 1);
    socketcan_close(&plant);
    close(raw);
}

/* A queue discipline that holds frames back stands for a bus that is busy: 64 bytes are 4 classic frames. */
static void transmit_queue_full(void)
{
    struct frame f = {.id = BASE + 0x14, .length = 8}, got;
    int taken = 0;
    printf("--- transmit queue full\n");
    open_hal(&plant, BASE, false, false);
    open_hal(&bench, BASE, false, false);
    check("tc holds the queue back", system("tc qdisc replace dev vcan0 root plug limit 64"), 0);
    for (int i = 0; i < 10; i++)
        taken += give(&plant, &f);
    check("taken until full", taken, 4);
    check("refused and counted", plant.kernel_full, 6);
    check("tc lets go", system("tc qdisc del dev vcan0 root"), 0);
    check("taken again", give(&plant, &f), 1);
    check("and received", take(&bench, &got), 1);
    drain(&bench);
    socketcan_close(&plant);
    socketcan_close(&bench);
}

static void set_interface(bool up)
{
    struct ifreq r = {.ifr_name = "vcan0"};
    int s = socket(AF_INET, SOCK_DGRAM, 0);
    ioctl(s, SIOCGIFFLAGS, &r);
    r.ifr_flags = (short)(up ? r.ifr_flags | IFF_UP : r.ifr_flags & ~IFF_UP);
    check(up ? "interface set up" : "interface set down", ioctl(s, SIOCSIFFLAGS, &r), 0);
    close(s);
}

static void down_and_up(void)
{
    struct frame command = {.id = BASE + 1, .length = 8, .data = {9}}, got;
    printf("--- interface down and up\n");
    open_hal(&plant, BASE, false, false);
    open_hal(&bench, BASE, false, false);
    drain(&plant);
    drain(&bench);
    set_interface(false);
    check("down is reported", take(&plant, &got), -HAL_DOWN);
    check("once", plant.hal.recv(&plant, &got), 0);
    check("and counted", plant.down, 1);
    check("a frame is refused meanwhile", give(&bench, &command), 0);
    check("and again", give(&bench, &command), 0);
    check("the one that only sends hears of it too", bench.hal.recv(&bench, &got), -HAL_DOWN);
    check("once", bench.hal.recv(&bench, &got), 0);
    check("one outage", bench.down, 1);
    check("two failed sends", bench.send_failed, 2);
    struct socketcan late;
    open_hal(&late, BASE, false, false);
    check("opened while down: reported", take(&late, &got), -HAL_DOWN);
    set_interface(true);
    check("taken again", give(&bench, &command), 1);
    check("received again", take(&plant, &got), 1);
    check_frame("command after down and up", &got, &command);
    check("received by the one opened while down", take(&late, &got), 1);
    set_interface(false);
    check("the second outage is reported too", take(&plant, &got), -HAL_DOWN);
    check("counted", plant.down, 2);
    set_interface(true);
    socketcan_close(&late);
    check("reported to the sender", take(&bench, &got), -HAL_DOWN);
    check("frame after the outage", give(&bench, &command), 1);
    check("received", take(&plant, &got), 1);
    check("frame sent before an outage", give(&bench, &command), 1);
    set_interface(false);
    check("the outage is reported first", take(&plant, &got), -HAL_DOWN);
    check("then the frame of before", take(&plant, &got), 1);
    check("a frame is refused meanwhile", give(&plant, &command), 0);
    check("of the same outage", plant.hal.recv(&plant, &got), 0);
    check("counted", plant.down, 3);
    set_interface(true);
    socketcan_close(&plant);
    socketcan_close(&bench);
}

/* An interface of classic frames only, as a real controller without FD is. */
static void set_mtu(int mtu)
{
    struct ifreq r = {.ifr_name = "vcan0", .ifr_mtu = mtu};
    int s = socket(AF_INET, SOCK_DGRAM, 0);
    set_interface(false);
    check("MTU set", ioctl(s, SIOCSIFMTU, &r) == 0 ? mtu : errno, mtu);
    set_interface(true);
    close(s);
}

static void classic_mtu(void)
{
    struct canfd_frame fd = {.can_id = BASE + 1, .len = 12};
    printf("--- classic MTU\n");
    set_mtu(CAN_MTU);
    int raw = raw_open();
    open_hal(&plant, BASE, false, false);
    check("the kernel refuses CAN FD", write(raw, &fd, sizeof fd) < 0 ? errno : 0, EINVAL);
    only_the_marker_arrives("classic frames come through", raw, 9);
    socketcan_close(&plant);
    close(raw);
    set_mtu(CANFD_MTU);
}

/* The age of the frame that s took last. */
static long long stamp_age_ns(const struct socketcan *s)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return ns_of(&now) - (long long)s->received_ns;
}

/* The first socket that asks for stamps has the kernel switch them on, which it does later, from a worker of
 * its own; frames are stamped at reading until then. */
static void wait_for_stamps(struct socketcan *s, int raw)
{
    struct frame got;
    long long age_ns = 0;
    for (int i = 0; i < WAIT_MS && age_ns < 1000000; i++) {
        raw_send(raw, BASE + 1, 8, 0);
        usleep(1000);
        take(s, &got);
        age_ns = stamp_age_ns(s);
    }
}

/* Stamps are the kernel's at arrival, not ours at reading:
 * in order, and older than the wait before reading. */
static void time_stamps(void)
{
    enum { BURST = 50, PAUSE_MS = 20 };
    struct frame got;
    int raw = raw_open();
    long long in_order = 0;
    uint64_t first_ns = 0, last_ns = 0;
    printf("--- receive time stamps\n");
    open_hal(&plant, BASE, false, false);
    wait_for_stamps(&plant, raw);
    for (int i = 0; i < BURST; i++)
        raw_send(raw, BASE + 1, 8, (uint8_t)i);
    usleep(PAUSE_MS * 1000);
    for (int i = 0; i < BURST && take(&plant, &got) > 0; i++) {
        first_ns = i ? first_ns : plant.received_ns;
        in_order += plant.received_ns >= last_ns && got.data[0] == i;
        last_ns = plant.received_ns;
    }
    long long age_ns = stamp_age_ns(&plant);
    printf("burst of %d in %lld us, the last read %lld us after its arrival\n", BURST,
           (long long)(last_ns - first_ns) / 1000, age_ns / 1000);
    check("frames and stamps in order", in_order, BURST);
    check("the last is as old as the wait before reading", age_ns >= PAUSE_MS * 1000000LL, 1);
    socketcan_close(&plant);
    close(raw);
}

int main(void)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    reasons();
    round_trip("11-bit identifiers", BASE, false);
    round_trip("29-bit identifiers", EXTENDED_BASE, true);
    filters();
    many_plants();
    error_frames();
    confirmation();
    receive_overflow();
    transmit_queue_full();
    down_and_up();
    classic_mtu();
    time_stamps();
    printf("%d passed, %d failed\n", n_passed, n_failed);
    return n_failed != 0;
}
