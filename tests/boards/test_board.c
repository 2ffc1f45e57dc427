/* test_board.c - a session with a board over real UDP: commands at named instants, parameters, refusals, a
 * time-out.
 *
 * It writes a log of it all for contactplant replay, which must find every byte equal on this machine.
 *
 *     test_board ports                              prints two free UDP ports
 *     test_board network PORT                       prints struct net_config with the one peer 10.0.2.2:PORT
 *     test_board session SUBSTEPS PLANT CONTROLLER LOG CONSOLE EMULATOR...
 *     test_board restarted SUBSTEPS PLANT CONTROLLER LOG CONSOLE EMULATOR...
 *     test_board preset SCENE PLANT CONTROLLER LOG CONSOLE EMULATOR...
 *     test_board hostile SUBSTEPS PLANT CONTROLLER LOG CONSOLE EMULATOR...
 *
 * The board is at 127.0.0.1:PLANT, the test at CONTROLLER. The last run of a `restarted` board failed. A
 * `preset` is in the image: it runs, and nothing else is asked of it. `hostile` sends Ethernet frames in
 * UDP (tests/boards/board_hostile.h).
 *
 * The emulator is started after our socket is open, so that nothing of the board's first frame is missed.
 * A line per check and `N passed, N failed`. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "firmware/bus/wire_table.h"
#include "hal/board/board.h"
#include "hal/ethernet/net.h"
#include "host_sim/cli/names.h"
#include "models/hertz_rig.h"
#include "tests/boards/board_bench.h"
#include "tests/boards/board_hostile.h"
#include "tests/boards/board_record.h"

/* Frames until every field of DRIVE_ECHO was sent. */
enum { ECHO_ROUND = 20 * (MODEL_INPUTS * ARM_FIELDS + INFO_ITEMS) };
enum { PRESET_FRAMES = 400 };
enum { TIMEOUT = 150 /* frames, where the time-out is tested */, HASH_EVERY = 16 /* frames */ };
enum { BASE_HZ = 1700, SOUND = 10 /* ticks per period of a drive */ };

static struct udp udp;
static struct board_record record;
static struct client *const client = &bench.client;
static const struct latest *const latest = &bench.client.latest;

/* ---- ports and addresses ---- */

/* Free and below those that the kernel gives away, to whom
 * it likes: they stay free until the emulator takes them. */
enum { PORT_FIRST = 20000, PORTS = 12000 };

static unsigned free_port(unsigned from)
{
    static struct udp u;
    char local[8];
    struct udp_config c = {.local = local, .peer = {"1"}, .n_peers = 1};
    for (unsigned i = 0; i < PORTS; i++) {
        unsigned port = PORT_FIRST + (from + i) % PORTS;
        snprintf(local, sizeof local, "%u", port);
        if (udp_open(&u, &c))
            continue;
        udp_close(&u);
        return port;
    }
    return 0;
}

static int print_ports(void)
{
    unsigned plant = free_port(2 * (unsigned)getpid()), controller = free_port(plant - PORT_FIRST + 1);
    printf("%u %u\n", plant, controller);
    return plant == 0 || controller == 0;
}

static int print_network(unsigned port)
{
    const struct net_config c = {
        .self = {{0x52, 0x54, 0x00, 0x12, 0x34, 0x56}, {{10, 0, 2, 15}, {0x4E, 0x20}}},
        .n_peers = 1,
        .peer = {{{10, 0, 2, 2}, {(uint8_t)(port >> 8), (uint8_t)port}}}};
    return fwrite(&c, sizeof c, 1, stdout) != 1;
}

/* ---- the session ---- */

/* Fires input i some frames ahead, `part` ticks later; must be answered so. */
static void fire(const char *name, int i, uint64_t frames, double part, enum cause expected)
{
    uint64_t tick = latest->tick + frames * bench.scene.config.substeps + (uint64_t)part;
    bench_check(name, bench_answer(WIRE_FIRE, client_fire(client, 1u << i, false, tick, part - floor(part))),
                expected);
}

static void shake(void)
{
    const double tick_Hz = bench.scene.config.substeps / bench.scene.config.frame_s;
    bench_set("hash_every", HASH_EVERY);
    bench_control("start", CONTROL_START, CAUSE_OK);
    client_arm(client, RIG_FORCE, 3.0, 225.0, 0.3, 0.1);
    fire("a drive, inside a tick", RIG_FORCE, 500, 17.25, CAUSE_OK);
    client_arm(client, RIG_BASE, 2e-6, fmin(BASE_HZ, tick_Hz / SOUND), 0.0, 0.01);
    fire("the base", RIG_BASE, 600, 0.0, CAUSE_OK);
    bench_pass(800, true);
    client_arm(client, RIG_FORCE, 70.0, 230.0, 0.0, 0.05);
    bench_check("a drive for an instant that has passed",
                bench_answer(WIRE_FIRE, client_fire(client, 1u << RIG_FORCE, false, 64, 0.0)), CAUSE_LATE);
    fire("a drive that breaks contact", RIG_FORCE, 500, 0.0, CAUSE_OK);
    bench_pass(500 + ECHO_ROUND, true);
    bench_check("contact was lost and found", latest->touchdowns > 10 && latest->liftoffs > 10, true);
    bench_check("amplitude that the board echoes, N", latest->drive[RIG_FORCE][ARM_AMPLITUDE], 70.0);
    bench_set("damping_N_s_per_m", 250.0);
    bench_pass(500, true);
}

static void send_damaged(void)
{
    struct frame f = {.id = client->scene.base_id + WIRE_ENABLE, .length = 8, .data = {0x5F, 0x51, 1}};
    client->hal->send(client->hal->context, &f);
    client->hal->flush(client->hal->context);
    bench_pass(BENCH_HEALTH_ROUND + BENCH_HEARTBEAT, true);
    bench_check("frames with a wrong CRC", latest->health[DIAG_CRC], 1);
    bench_check("drives that took effect", latest->health[DIAG_FIRE_APPLIED], 3);
}

/* The last heartbeat and the shorter time-out go in one packet, which one frame takes: how long this program
 * is away after it is part of the silence. */
static void fall_silent(void)
{
    const double timeout = TIMEOUT;
    unsigned index = (unsigned)names_find(bench.scene.config.model, NAMES_PARAMETER, "timeout_frames");
    bench.reaction_frame = 0;
    bench_gather();
    bool sent = client_enable(client, true) && client_set(client, 1, &index, &timeout, COMMIT_NOW);
    bench_send_off();
    bench_check("the shorter time-out is taken", bench_answer(WIRE_PARAM_COMMIT, sent), CAUSE_OK);
    bench_pass(BENCH_HEARTBEAT, false);
    uint64_t last_beat = record.taken_frame;
    bench_check("timeout_frames", latest->parameter[index], TIMEOUT);
    bench_pass(2 * TIMEOUT, false);
    bench_check("frames of silence until the reaction", (double)(bench.reaction_frame - last_beat),
                TIMEOUT + 1);
    bench_check("the reaction is the ramp", latest->reaction, REACTION_RAMP);
    bench_check("and latched", latest->faults, FAULT_TIMEOUT);
    bench_control("a command of the old session", CONTROL_PAUSE, CAUSE_SESSION);
}

static void end_session(void)
{
    bench_open_session();
    bench_control("pause", CONTROL_PAUSE, CAUSE_OK);
    bench_control("reset", CONTROL_RESET, CAUSE_OK);
    bench_pass(BENCH_HEALTH_ROUND + BENCH_HEARTBEAT, true);
    bench_check("faults after the reset", latest->faults, 0);
    bench_check("time-outs", latest->health[DIAG_TIMEOUTS], 1);
    bench_check("frames missed", latest->health[DIAG_FRAMES_MISSED], 0);
    bench_check("frames dropped by the board", latest->health[DIAG_RX_DROPPED], 0);
    client_enable(client, false);
    bench_check("off", client_wait_state(client, STATE_OFF, bench_limit_s()), true);
    bench_pass(BENCH_HEARTBEAT, false);
}

static void whole_session(void)
{
    bench_open_session();
    shake();
    send_damaged();
    fall_silent();
    end_session();
    bench_check("hashes", latest->count[WIRE_HASH] > 100, true);
}

/* The reason stays latched, drives are off and nothing starts until a controller resets it. */
static void after_failure(void)
{
    bench_open_session();
    bench_check("state", latest->state, STATE_FAULT);
    bench_check("latched", latest->faults, FAULT_ASSERT);
    bench_pass(BENCH_HEALTH_ROUND + BENCH_HEARTBEAT, true);
    bench_check("HEALTH: the watchdog ended the last run", latest->health[DIAG_LAST_RUN], BOARD_WATCHDOG);
    bench_control("start", CONTROL_START, CAUSE_STATE);
    bench_control("reset", CONTROL_RESET, CAUSE_OK);
    bench_check("ready", client_wait_state(client, STATE_READY, bench_limit_s()), true);
    bench_check("faults after the reset", latest->faults, 0);
    bench_control("start", CONTROL_START, CAUSE_OK);
    bench_pass(BENCH_HEARTBEAT, true);
    bench_check("running", latest->state, STATE_RUNNING);
}

/* The motion of the scene by itself: no command touches it, and the replay of the log has the host's. */
static void preset_session(void)
{
    const struct app_config *c = &bench.scene.config;
    bench_open_session();
    bench_set("hash_every", HASH_EVERY);
    bench_control("start", CONTROL_START, CAUSE_OK);
    bench_pass(PRESET_FRAMES + BENCH_HEALTH_ROUND + ECHO_ROUND, true);
    bench_check("running", latest->state, STATE_RUNNING);
    bench_check("ticks in the frames that were asked for", latest->tick >= PRESET_FRAMES * c->substeps, true);
    for (int i = 0; i < c->model->n_inputs; i++)
        bench_check("amplitude that the board echoes", latest->drive[i][ARM_AMPLITUDE],
                    (double)(float)bench.scene.drive[i].amplitude);
    bench_check("contact was made and lost", latest->touchdowns > 10 && latest->liftoffs > 10, true);
    bench_check("hashes", latest->count[WIRE_HASH] > 50, true);
    client_enable(client, false);
    bench_check("off", client_wait_state(client, STATE_OFF, bench_limit_s()), true);
    bench_pass(BENCH_HEARTBEAT, false);
}

/* ---- start and end ---- */

static bool open_bus(const char *plant, const char *controller, const char *log)
{
    const struct udp_config c = {.local = controller, .peer = {plant}, .n_peers = 1};
    FILE *file = fopen(log, "w");
    const char *reason = udp_open(&udp, &c);
    if (!file || reason) {
        printf("FAIL  %s\n", reason ? reason : "cannot write the log");
        return false;
    }
    bench_roomy(udp.queue[0].socket);
    board_record_open(&record, &udp, &bench.scene.app.scene, bench.scene.config.frame_s, file);
    bench_connect(&record.hal);
    return true;
}

static int over_udp(void (*all)(void), char **argument)
{
    if (!open_bus(argument[0], argument[1], argument[2]))
        return 1;
    pid_t emulator = bench_boot(argument[3], argument + 4);
    all();
    board_record_close(&record);
    bench_check("packets missing or out of order", (double)record.out_of_order, 0);
    bench_check("commands that were not taken", record.n_waiting, 0);
    printf("note  %llu bus frames, %llu ticks, %llu hashes, %llu touchdowns\n",
           (unsigned long long)record.frame, (unsigned long long)latest->tick,
           (unsigned long long)latest->count[WIRE_HASH], (unsigned long long)latest->touchdowns);
    return bench_close(emulator);
}

int main(int argc, char **argv)
{
    const char *what = argc > 1 ? argv[1] : "";
    if (argc == 2 && !strcmp(what, "ports"))
        return print_ports();
    if (argc == 3 && !strcmp(what, "network"))
        return print_network((unsigned)atoi(argv[2]));
    bool preset = !strcmp(what, "preset");
    if (argc > 7 && !bench_open(preset ? argv[2] : NULL, (uint32_t)atoi(argv[2])))
        return 1;
    if (argc > 7 && preset)
        return over_udp(preset_session, argv + 3);
    if (argc > 7 && !strcmp(what, "session"))
        return over_udp(whole_session, argv + 3);
    if (argc > 7 && !strcmp(what, "restarted"))
        return over_udp(after_failure, argv + 3);
    if (argc > 7 && !strcmp(what, "hostile"))
        return board_hostile(argv[3], argv[4], argv[6], argv + 7);
    fprintf(stderr,
            "usage: test_board ports | network PORT\n"
            "       test_board session|restarted|hostile SUBSTEPS PLANT CONTROLLER LOG CONSOLE EMULATOR...\n"
            "       test_board preset SCENE PLANT CONTROLLER LOG CONSOLE EMULATOR...\n");
    return 2;
}
