/* test_board.c - a session with a board over real UDP: commands at named instants, parameters, refusals, a time-out, and
 * a log of it all for contactplant replay, which must find every byte equal on this machine.
 *
 *     test_board ports                              prints two free UDP ports
 *     test_board network PORT                       prints struct net_config with 10.0.2.2:PORT as the only peer
 *     test_board session PLANT CONTROLLER LOG CONSOLE EMULATOR...   127.0.0.1:PLANT is the board, CONTROLLER is ours
 *     test_board restarted PLANT CONTROLLER LOG CONSOLE EMULATOR...  the same for a board whose last run failed
 *
 * The emulator is started after our socket is open, so that nothing of the board's first frame is missed, its console
 * goes to a file, and it is ended with the session. Waiting is counted in the board's frames wherever it can be; seconds
 * only bound it. A line per check and `N passed, N failed`. */
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include "hal/net.h"
#include "host_sim/client.h"
#include "host_sim/clock.h"
#include "host_sim/scene.h"
#include "models/hertz_rig.h"
#include "tests/board_record.h"

enum {
    HEARTBEAT = 20,  /* frames */
    PATIENCE = 4000, /* frames without a heartbeat while a loaded machine runs this test */
    TIMEOUT = 150,   /* frames, where the time-out itself is tested */
    HASH_EVERY = 16, /* frames: 1024 ticks */
    HEALTH_ROUND = 5 * DIAG_COUNTERS
};
static const double limit_s = 60.0; /* of any wait */

static int n_passed, n_failed;
static struct scene scene;
static struct udp udp;
static struct board_record record;
static struct client client;
static int cause[WIRE_KINDS]; /* of the last REPLY to each kind, or -1 */
static double latency_apply;  /* ticks, of the last FIRE */
static uint64_t reaction_frame, last_beat;

static void check(const char *name, double got, double expected)
{
    int ok = got == expected;
    printf("%s  %s: %.9g, expected %.9g\n", ok ? "ok  " : "FAIL", name, got, expected);
    n_passed += ok;
    n_failed += !ok;
}

/* ---- ports and addresses ---- */

static int print_ports(void)
{
    static struct udp a, b;
    const struct udp_config any = {.local = "0", .peer = {"1"}, .n_peers = 1};
    if (udp_open(&a, &any) || udp_open(&b, &any))
        return 1;
    printf("%u %u\n", a.port, b.port);
    return 0;
}

static int print_network(unsigned port)
{
    const struct net_config c = {
        .self = {{0x52, 0x54, 0x00, 0x12, 0x34, 0x56}, {{10, 0, 2, 15}, {0x4E, 0x20}}},
        .n_peers = 1,
        .peer = {{{10, 0, 2, 2}, {(uint8_t)(port >> 8), (uint8_t)port}}}};
    return fwrite(&c, sizeof c, 1, stdout) != 1;
}

/* ---- the controller ---- */

static void hear(void *context, const struct frame *f, const struct message *m)
{
    (void)context, (void)f;
    if (m->kind == WIRE_REPLY && m->value[REPLY_MESSAGE] < WIRE_KINDS)
        cause[(int)m->value[REPLY_MESSAGE]] = (int)m->value[REPLY_CAUSE];
    if (m->kind == WIRE_LATENCY && (int)m->value[LATENCY_MESSAGE] == WIRE_FIRE)
        latency_apply = m->value[LATENCY_APPLY];
    if (m->kind == WIRE_STATUS && m->value[STATUS_REACTION] < REACTION_NONE && !reaction_frame)
        reaction_frame = client.latest.frame;
}

static bool is_frame(const struct client *c, const void *argument)
{
    return c->latest.frame >= *(const uint64_t *)argument;
}

/* Frames of the board pass, with heartbeats or without. */
static void pass(uint64_t frames, bool beat)
{
    uint64_t end = client.latest.frame + frames;
    double give_up = clock_now_s() + limit_s;
    while (client.latest.frame < end && clock_now_s() < give_up) {
        uint64_t next = client.latest.frame + HEARTBEAT;
        if (beat)
            client_enable(&client, true);
        next = next < end ? next : end;
        if (!client_wait(&client, is_frame, &next, limit_s))
            break;
    }
    check("frames that did not come", (double)(client.latest.frame < end), 0);
}

static bool is_answered(const struct client *c, const void *argument)
{
    (void)c;
    return cause[*(const unsigned *)argument] >= 0;
}

/* The cause with which a command of this kind is answered; `sent` is there for its evaluation. */
static int answer(unsigned kind, bool sent)
{
    if (sent)
        client_wait(&client, is_answered, &kind, limit_s);
    int got = cause[kind];
    cause[kind] = -1;
    return got;
}

static void set(const char *name, double value)
{
    char why[SCENE_REASON];
    unsigned index = (unsigned)scene_find(scene.config.model, name, why);
    check(name, answer(WIRE_PARAM_COMMIT, client_set(&client, 1, &index, &value, COMMIT_NOW)), CAUSE_OK);
    pass(HEARTBEAT, true);
    check("the board's value", client.latest.parameter[index], (double)(float)value);
}

/* A tick some frames ahead. */
static uint64_t ahead(uint64_t frames)
{
    return client.latest.tick + frames * scene.config.substeps;
}

/* ---- the session ---- */

static void open_session(void)
{
    check("the board answers and gives a session", client_open(&client, false, limit_s), true);
    set("timeout_frames", PATIENCE);
    set("age_limit_frames", PATIENCE);
    set("hash_every", HASH_EVERY);
    check("start", answer(WIRE_CONTROL, client_control(&client, CONTROL_START, client.latest.frame)),
          CAUSE_OK);
}

static void shake(void)
{
    client_arm(&client, RIG_FORCE, 3.0, 225.0, 0.3, 0.1);
    check("a drive, at a tick and a quarter",
          answer(WIRE_FIRE, client_fire(&client, 1u << RIG_FORCE, false, ahead(2000) + 17, 0.25)), CAUSE_OK);
    client_arm(&client, RIG_FORCE, 4.0, (double)NAN, (double)NAN, (double)NAN);
    check("one that is late", answer(WIRE_FIRE, client_fire(&client, 1u << RIG_FORCE, false, 64, 0.0)),
          CAUSE_LATE);
    client_arm(&client, RIG_BASE, 2e-6, 1700.0, 0.0, 0.01);
    check("the base", answer(WIRE_FIRE, client_fire(&client, 1u << RIG_BASE, false, ahead(2100), 0.0)),
          CAUSE_OK);
    pass(2300, true);
    client_arm(&client, RIG_FORCE, 70.0, 230.0, 0.0, 0.05);
    check("a drive that breaks contact",
          answer(WIRE_FIRE, client_fire(&client, 1u << RIG_FORCE, false, ahead(500), 0.0)), CAUSE_OK);
    pass(1000, true);
    check("contact was lost and found", client.latest.touchdowns > 10 && client.latest.liftoffs > 10, true);
    check("amplitude that the board echoes, N", client.latest.drive[RIG_FORCE][ARM_AMPLITUDE], 70.0);
    check("the last FIRE was taken", latency_apply > 0.0, true);
    set("damping_N_s_per_m", 250.0);
    pass(500, true);
}

static void send_damaged(void)
{
    struct frame f = {.id = client.scene.base_id + WIRE_ENABLE, .length = 8, .data = {0x5F, 0x51, 1}};
    client.hal->send(client.hal->context, &f);
    client.hal->flush(client.hal->context);
    pass(HEALTH_ROUND + HEARTBEAT, true);
    check("frames with a wrong CRC", client.latest.health[DIAG_CRC], 1);
}

static void fall_silent(void)
{
    set("timeout_frames", TIMEOUT);
    client_enable(&client, true);
    pass(HEARTBEAT, false);
    last_beat = record.taken_frame;
    reaction_frame = 0;
    pass(2 * TIMEOUT, false);
    check("frames of silence until the reaction", (double)(reaction_frame - last_beat), TIMEOUT + 1);
    check("the reaction is the ramp", client.latest.reaction, REACTION_RAMP);
    check("and latched", client.latest.faults, FAULT_TIMEOUT);
    check("a command of the old session",
          answer(WIRE_CONTROL, client_control(&client, CONTROL_PAUSE, client.latest.frame)), CAUSE_SESSION);
}

static void end_session(void)
{
    check("a new session", client_open(&client, false, limit_s), true);
    check("pause", answer(WIRE_CONTROL, client_control(&client, CONTROL_PAUSE, client.latest.frame)),
          CAUSE_OK);
    check("reset", answer(WIRE_CONTROL, client_control(&client, CONTROL_RESET, client.latest.frame)),
          CAUSE_OK);
    pass(HEALTH_ROUND + HEARTBEAT, true);
    check("faults after the reset", client.latest.faults, 0);
    check("time-outs", client.latest.health[DIAG_TIMEOUTS], 1);
    check("frames missed", client.latest.health[DIAG_FRAMES_MISSED], 0);
    check("frames dropped by the board", client.latest.health[DIAG_RX_DROPPED], 0);
    client_enable(&client, false);
    check("off", client_wait_state(&client, STATE_OFF, limit_s), true);
    pass(HEARTBEAT, false);
}

/* ---- start and end ---- */

static pid_t boot(const char *console, char **emulator)
{
    pid_t child = fork();
    if (child)
        return child;
    int out = open(console, O_WRONLY | O_CREAT | O_TRUNC, 0666), in = open("/dev/null", O_RDONLY);
    dup2(in, 0);
    dup2(out, 1);
    dup2(out, 2);
    execvp(emulator[0], emulator);
    _exit(127);
}

static bool open_all(const char *plant, const char *controller, const char *log)
{
    char why[SCENE_REASON];
    const struct udp_config c = {.local = controller, .peer = {plant}, .n_peers = 1};
    FILE *file = fopen(log, "w");
    const char *reason = udp_open(&udp, &c);
    if (!file || reason || !scene_init(&scene, NULL, why) || !scene_start(&scene, NULL, why)) {
        printf("FAIL  %s\n", reason ? reason : "cannot open the log or make the scene");
        return false;
    }
    board_record_open(&record, &udp, &scene.app.scene, scene.config.frame_s, file);
    client_init(&client, &record.hal, &scene.app.scene);
    client.heard = hear;
    memset(cause, -1, sizeof cause);
    return true;
}

static void whole_session(void)
{
    open_session();
    shake();
    send_damaged();
    fall_silent();
    end_session();
    check("hashes", client.latest.count[WIRE_HASH] > 100, true);
}

/* The reason stays latched, drives are off and nothing starts until a controller resets it. */
static void after_failure(void)
{
    check("the board answers and gives a session", client_open(&client, false, limit_s), true);
    check("state", client.latest.state, STATE_FAULT);
    check("latched", client.latest.faults, FAULT_ASSERT);
    check("start", answer(WIRE_CONTROL, client_control(&client, CONTROL_START, client.latest.frame)),
          CAUSE_STATE);
    check("reset", answer(WIRE_CONTROL, client_control(&client, CONTROL_RESET, client.latest.frame)),
          CAUSE_OK);
    check("ready", client_wait_state(&client, STATE_READY, limit_s), true);
    check("faults after the reset", client.latest.faults, 0);
    check("start", answer(WIRE_CONTROL, client_control(&client, CONTROL_START, client.latest.frame)),
          CAUSE_OK);
    pass(HEARTBEAT, true);
    check("running", client.latest.state, STATE_RUNNING);
}

static int session(void (*all)(void), char **argument)
{
    if (!open_all(argument[0], argument[1], argument[2]))
        return 1;
    pid_t emulator = boot(argument[3], argument + 4);
    all();
    board_record_close(&record);
    kill(emulator, SIGTERM);
    waitpid(emulator, NULL, 0);
    check("packets missing or out of order", (double)record.out_of_order, 0);
    check("commands that were not taken", record.n_waiting, 0);
    printf("note  %llu bus frames, %llu ticks, %llu hashes, %llu touchdowns\n",
           (unsigned long long)record.frame, (unsigned long long)client.latest.tick,
           (unsigned long long)client.latest.count[WIRE_HASH], (unsigned long long)client.latest.touchdowns);
    printf("%d passed, %d failed\n", n_passed, n_failed);
    return n_failed != 0;
}

int main(int argc, char **argv)
{
    if (argc == 2 && !strcmp(argv[1], "ports"))
        return print_ports();
    if (argc == 3 && !strcmp(argv[1], "network"))
        return print_network((unsigned)atoi(argv[2]));
    if (argc > 6 && !strcmp(argv[1], "session"))
        return session(whole_session, argv + 2);
    if (argc > 6 && !strcmp(argv[1], "restarted"))
        return session(after_failure, argv + 2);
    fprintf(stderr, "usage: test_board ports | network PORT | session|restarted PLANT CONTROLLER LOG CONSOLE "
                    "EMULATOR...\n");
    return 2;
}
