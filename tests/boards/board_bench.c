/* board_bench.c - the bench for tests of a board; see board_bench.h. */
#include "tests/boards/board_bench.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include "firmware/bus/wire_table.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/names.h"
#include "host_sim/live/client_host.h"

enum { OPENINGS = 10 };

struct bench bench;

static int n_passed, n_failed;

void bench_check(const char *name, double got, double expected)
{
    int ok = got == expected;
    printf("%s  %s: %.9g, expected %.9g\n", ok ? "ok  " : "FAIL", name, got, expected);
    n_passed += ok;
    n_failed += !ok;
}

double bench_limit_s(void)
{
    return n_failed ? 2.0 : 60.0;
}

/* ---- start and end ---- */

static void hear(void *context, const struct frame *f, const struct message *m)
{
    (void)context, (void)f;
    if (m->kind == WIRE_REPLY && m->value[REPLY_MESSAGE] < WIRE_KINDS)
        bench.cause[(int)m->value[REPLY_MESSAGE]] = (int)m->value[REPLY_CAUSE];
    if (m->kind == WIRE_STATUS && m->value[STATUS_REACTION] < REACTION_NONE && !bench.reaction_frame)
        bench.reaction_frame = bench.client.latest.frame;
}

bool bench_open(const char *scene, uint32_t substeps)
{
    char why[SCENE_REASON];
    bool there = scene_init(&bench.scene, scene, why);
    if (!scene)
        bench.scene.config.substeps = substeps;
    if (there && scene_start(&bench.scene, NULL, why))
        return true;
    printf("FAIL  %s\n", why);
    return false;
}

void bench_connect(const struct hal *hal)
{
    client_init(&bench.client, hal, &bench.scene.app.scene);
    bench.client.heard = hear;
    memset(bench.cause, -1, sizeof bench.cause);
}

void bench_roomy(int socket)
{
    int bytes = 16 << 20;
    if (setsockopt(socket, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0)
        setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

pid_t bench_boot(const char *console, char **emulator)
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

int bench_close(pid_t emulator)
{
    kill(emulator, SIGTERM);
    waitpid(emulator, NULL, 0);
    printf("%d passed, %d failed\n", n_passed, n_failed);
    return n_failed != 0;
}

/* ---- the controller ---- */

static bool is_frame(const struct client *c, const void *argument)
{
    return c->latest.frame >= *(const uint64_t *)argument;
}

void bench_pass(uint64_t frames, bool beat)
{
    struct client *c = &bench.client;
    uint64_t end = c->latest.frame + frames;
    bool alive = true;
    while (alive && c->latest.frame < end) {
        uint64_t next = c->latest.frame + BENCH_HEARTBEAT;
        if (beat)
            client_enable(c, true);
        next = next < end ? next : end;
        alive = client_wait(c, is_frame, &next, bench_limit_s());
    }
    if (!alive)
        bench_check("the board goes on", false, true);
}

static bool is_answered(const struct client *c, const void *argument)
{
    (void)c;
    return bench.cause[*(const unsigned *)argument] >= 0;
}

int bench_answer(unsigned kind, bool sent)
{
    if (sent)
        client_wait(&bench.client, is_answered, &kind, bench_limit_s());
    int got = bench.cause[kind];
    bench.cause[kind] = -1;
    return got;
}

void bench_set(const char *name, double value)
{
    unsigned index = (unsigned)names_find(bench.scene.config.model, NAMES_PARAMETER, name);
    struct client *c = &bench.client;
    bench_check("a set of one is taken",
                bench_answer(WIRE_PARAM_COMMIT, client_set(c, 1, &index, &value, COMMIT_NOW)), CAUSE_OK);
    bench_pass(BENCH_HEARTBEAT, true);
    bench_check(name, c->latest.parameter[index], (double)(float)value);
}

void bench_control(const char *name, enum control_operation operation, enum cause expected)
{
    struct client *c = &bench.client;
    bench_check(name, bench_answer(WIRE_CONTROL, client_control(c, operation, c->latest.frame)), expected);
}

static void later(void *context)
{
    (void)context;
}

static struct hal gathering;
static const struct hal *bus;

void bench_gather(void)
{
    bus = bench.client.hal;
    gathering = *bus;
    gathering.flush = later;
    bench.client.hal = &gathering;
}

void bench_send_off(void)
{
    bench.client.hal = bus;
    bus->flush(bus->context);
}

/* The settings come with the ENABLE: between the two, this program could be away for longer than the default
 * time-out. An ENABLE that is too old already opens nothing. */
void bench_open_session(void)
{
    const char *const name[] = {"timeout_frames", "age_limit_frames"};
    const double value[] = {BENCH_PATIENCE, BENCH_PATIENCE};
    struct client *c = &bench.client;
    unsigned index[2];
    int cause = -1;
    bool alive = client_wait_alive(c, bench_limit_s());
    for (int i = 0; i < 2; i++)
        index[i] = (unsigned)names_find(bench.scene.config.model, NAMES_PARAMETER, name[i]);
    for (int i = 0; alive && i < OPENINGS && cause != CAUSE_OK; i++) {
        c->session = (uint8_t)(c->latest.session % WIRE_SESSIONS + 1);
        bench_gather();
        bool sent = client_enable(c, true) && client_set(c, 2, index, value, COMMIT_NOW);
        bench_send_off();
        cause = bench_answer(WIRE_PARAM_COMMIT, sent);
    }
    bench_check("the board answers, gives a session and takes a set of two", cause, CAUSE_OK);
    bench_pass(BENCH_HEARTBEAT, true);
    for (int i = 0; i < 2; i++)
        bench_check(name[i], c->latest.parameter[index[i]], value[i]);
}
