/* test_board_can.c - a session with a board over SocketCAN: the emulator's CAN bus is this machine's
 * vcan0.
 *
 *     tests/can/can_vm.sh -- build/test_board_can INTERFACE CONSOLE EMULATOR...
 *
 * Commands name their instants, so the state at a tick depends on nothing else. A second plant in this
 * program gets equal commands over hal/loopback. Every hash that the board sends must be that plant's hash
 * at the tick. The program prints a line per check and `N passed, N failed`.
 *
 * A virtual bus has no bit times. The emulator of a busy machine may hand over more frames at once than
 * the board's controller keeps. The board then says so, commands are missing, and the run proves nothing:
 * exit status 3. */
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>
#include "firmware/bus/wire_table.h"
#include "firmware/plant/plant_report.h"
#include "hal/link/loopback.h"
#include "hal/posix/socketcan.h"
#include "host_sim/cli/names.h"
#include "models/hertz_rig.h"
#include "tests/boards/board_bench.h"
#include "host_sim/live/client_host.h"

enum {
    HASH_EVERY = 8, /* frames */
    HASHES = 4000,
    ORDERS = 8,
    AHEAD = 600, /* frames from a command to its instant, more where it was late */
    TWIN_AHEAD = 100,
    TWIN_SESSION = 1,
    TIMEOUT = 150,
    BREATH = 3,
    TRIES = 4,
    REPEAT = 3, /* exit status */
    NOISE = 100 /* frames that are not the plant's, of each kind */
};
static const uint64_t hash_bits = UINT64_C(0xFFFFFFFFFFFF); /* 48 of 64 bits are in HASH */

static struct socketcan can;
static struct client *const client = &bench.client;
static const struct latest *const latest = &bench.client.latest;

/* ---- a bus with bit times ---- */

static struct hal paced;

/* Frames of the board pass, beside those that have come already. */
static void breathe(void)
{
    client_poll(client);
    bench_pass(BREATH, false);
}

static int transmit(void *context, const struct frame *f)
{
    int taken = can.hal.send(context, f);
    if (latest->frame > 0)
        breathe();
    return taken;
}

/* ---- hashes that the board sends ---- */

static struct {
    uint64_t tick, value;
} hash[HASHES];
static int n_hashes;
static int sync_counter; /* COUNTER of the last SYNC */
static void (*bench_hears)(void *context, const struct frame *f, const struct message *m);

static void hear(void *context, const struct frame *f, const struct message *m)
{
    bench_hears(context, f, m);
    if (m->kind == WIRE_SYNC) {
        bool gap = m->counter != (sync_counter + 1) % WIRE_COUNTER_STATES;
        n_hashes -=
            gap && n_hashes > 0; /* the SYNC that dated the latest hash may have been lost on the way */
        sync_counter = m->counter;
    }
    if (m->kind != WIRE_HASH || n_hashes == HASHES)
        return;
    hash[n_hashes].tick = latest->tick; /* SYNC came before it */
    hash[n_hashes++].value = (uint64_t)m->value[HASH_VALUE];
}

/* ---- commands, kept for the twin ---- */

static struct order {
    int channel;
    double field[ARM_FIELDS];
    double damping; /* 0: as it is */
    uint64_t tick;
    double fraction;
} order[ORDERS];
static int n_orders;

static bool send_order(struct client *c, const struct order *o)
{
    bool sent = client_arm(c, o->channel, o->field[0], o->field[1], o->field[2], o->field[3]);
    if (o->damping > 0.0) {
        unsigned index = (unsigned)names_find(bench.scene.config.model, NAMES_PARAMETER, "damping_N_s_per_m");
        sent = client_set(c, 1, &index, &o->damping, COMMIT_WITH_FIRE) && sent;
    }
    return client_fire(c, 1u << o->channel, o->damping > 0.0, o->tick, o->fraction) && sent;
}

static void command(const char *name, struct order o)
{
    int cause = CAUSE_LATE;
    uint64_t ahead = 0;
    o.fraction = 0.25;
    while (ahead < TRIES * AHEAD && cause == CAUSE_LATE) { /* a busy machine may need longer */
        ahead += AHEAD;
        o.tick = latest->tick + ahead * bench.scene.config.substeps + 17;
        cause = bench_answer(WIRE_FIRE, send_order(client, &o));
    }
    bench_check(name, cause, CAUSE_OK);
    order[n_orders++] = o;
    bench_pass(ahead + 300, true);
}

static void shake(void)
{
    bench_set("hash_every", HASH_EVERY);
    bench_control("start", CONTROL_START, CAUSE_OK);
    bench_pass(BENCH_HEARTBEAT, true);
    command("a drive", (struct order){.channel = RIG_FORCE, .field = {3.0, 225.0, 0.3, 0.1}});
    command("the base", (struct order){.channel = RIG_BASE, .field = {2e-6, 1700.0, 0.0, 0.01}});
    command("a drive that breaks contact, with new damping",
            (struct order){.channel = RIG_FORCE, .field = {70.0, 230.0, 0.0, 0.05}, .damping = 250.0});
    bench_check("contact was lost and found", latest->touchdowns > 10 && latest->liftoffs > 10, true);
}

/* ---- the twin ---- */

static struct {
    struct loopback_bus bus;
    struct app app;
    struct client client;
    double scratch[METHOD_SCRATCH];
    int i_order, i_hash, equal;
} twin;

static void twin_frame(void)
{
    app_frame(&twin.app);
    client_poll(&twin.client);
    uint64_t tick = twin.app.plant.now.tick;
    while (twin.i_hash < n_hashes && (hash[twin.i_hash].tick == 0 || hash[twin.i_hash].tick < tick))
        twin.i_hash++; /* before it ran, or of no frame's end */
    for (; twin.i_hash < n_hashes && hash[twin.i_hash].tick == tick; twin.i_hash++)
        twin.equal += hash[twin.i_hash].value == (plant_hash(&twin.app.plant) & hash_bits);
}

static void twin_start(void)
{
    struct app_config c = bench.scene.config;
    c.scratch = twin.scratch;
    c.capture = NULL;
    c.n_capture = 0;
    loopback_init(&twin.bus, 2, LOOPBACK_RING);
    const char *why = app_init(&twin.app, &c, &twin.bus.port[0].hal);
    printf("note  the twin: %s\n", why ? why : "ready");
    client_init(&twin.client, &twin.bus.port[1].hal, &twin.app.scene);
    twin.client.session = TWIN_SESSION;
    twin_frame();
    client_enable(&twin.client, true);
    twin_frame();
    client_control(&twin.client, CONTROL_START, twin.client.latest.frame);
}

static void compare_hashes(void)
{
    uint64_t last = n_hashes > 0 ? hash[n_hashes - 1].tick : 0;
    int running = 0;
    twin_start();
    while (twin.app.plant.now.tick < last && twin.app.state != STATE_OFF) {
        uint64_t soon = twin.app.plant.now.tick + TWIN_AHEAD * (uint64_t)bench.scene.config.substeps;
        client_enable(&twin.client, true);
        if (twin.i_order < n_orders && order[twin.i_order].tick < soon)
            send_order(&twin.client, &order[twin.i_order++]);
        twin_frame();
    }
    for (int i = 0; i < n_hashes; i++)
        running += hash[i].tick > 0;
    bench_check("hashes while plant time ran", running > 200, true);
    bench_check("hashes equal to those of the twin at their ticks", twin.equal, running);
}

/* ---- what is not the plant's ---- */

static void make_noise(const char *interface)
{
    struct sockaddr_can address = {.can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(interface)};
    int s = socket(PF_CAN, SOCK_RAW, CAN_RAW), sent = 0;
    struct can_frame f = {.can_dlc = 8};
    if (s < 0 || bind(s, (struct sockaddr *)&address, sizeof address) != 0)
        return bench_check("a raw socket", false, true);
    const uint32_t base = client->scene.base_id;
    const uint32_t id[] = {base - 1, base + WIRE_KINDS, base | CAN_RTR_FLAG, base | CAN_EFF_FLAG,
                           (base << 18) | CAN_EFF_FLAG};
    enum { IDS = sizeof id / sizeof id[0] };
    for (int i = 0; i < IDS * NOISE; i++) {
        f.can_id = id[i % IDS];
        sent += write(s, &f, sizeof f) == sizeof f;
        if (i % IDS == IDS - 1) /* the only kind that an SJA1000's filter lets through */
            breathe();
    }
    close(s);
    bench_check("frames that are not the plant's", sent, IDS * NOISE);
    bench_pass(BENCH_HEALTH_ROUND + BENCH_HEARTBEAT, true);
    bench_check("of them reached its commands", latest->health[DIAG_UNKNOWN_ID] + latest->health[DIAG_CRC],
                0);
    bench_check(
        "fault reports of its bus",
        latest->health[DIAG_BUS_OFF] + latest->health[DIAG_BUS_PASSIVE] + latest->health[DIAG_BUS_DOWN], 0);
}

/* ---- the end ---- */

static bool has_reaction(const struct client *c, const void *argument)
{
    (void)argument;
    return c->latest.reaction != REACTION_NONE;
}

static void fall_silent(void)
{
    bench_set("timeout_frames", TIMEOUT);
    client_wait(client, has_reaction, NULL,
                bench_limit_s()); /* periods that the board missed are forgiven once */
    bench_check("silence has its reaction, the ramp", latest->reaction, REACTION_RAMP);
    bench_check("and is latched", latest->faults, FAULT_TIMEOUT);
    bench_open_session();
    bench_control("pause", CONTROL_PAUSE, CAUSE_OK);
    bench_control("reset", CONTROL_RESET, CAUSE_OK);
    bench_pass(BENCH_HEALTH_ROUND, true);
    bench_check("frames dropped by the board", latest->health[DIAG_RX_DROPPED], 0);
    bench_check("off", client_close(client, bench_limit_s()) && latest->state == STATE_OFF, true);
}

int main(int argc, char **argv)
{
    struct socketcan_config c = {.interface = argv[1]};
    if (argc < 4) {
        fprintf(stderr, "usage: test_board_can INTERFACE CONSOLE EMULATOR...\n");
        return 2;
    }
    if (!bench_open(NULL, BENCH_SUBSTEPS))
        return 1;
    c.base_id = bench.scene.app.scene.base_id;
    const char *reason = socketcan_open(&can, &c);
    if (reason) {
        printf("FAIL  %s\n", reason);
        return 1;
    }
    bench_roomy(can.socket);
    paced = can.hal;
    paced.send = transmit;
    bench_connect(&paced);
    bench_hears = client->heard;
    client->heard = hear;
    pid_t emulator = bench_boot(argv[2], argv + 3);
    bench_open_session();
    shake();
    make_noise(argv[1]);
    client->heard = bench_hears; /* the commands below name no instant */
    bool cut_off = latest->health[DIAG_TIMEOUTS] > 0.0;
    fall_silent();
    compare_hashes();
    int status = bench_close(emulator);
    return status && (cut_off || latest->health[DIAG_RX_DROPPED] > 0.0) ? REPEAT : status;
}
