#include "tests/board_bench.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include "host_sim/clock.h"

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

bool bench_open(uint32_t substeps)
{
    char why[SCENE_REASON];
    bool there = scene_init(&bench.scene, NULL, why);
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
    char why[SCENE_REASON];
    unsigned index = (unsigned)scene_find(bench.scene.config.model, name, why);
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

void bench_open_session(void)
{
    bench_check("the board answers and gives a session", client_open(&bench.client, false, bench_limit_s()),
                true);
    bench_set("timeout_frames", BENCH_PATIENCE);
    bench_set("age_limit_frames", BENCH_PATIENCE);
}
