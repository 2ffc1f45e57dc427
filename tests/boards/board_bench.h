/* board_bench.h - the bench for tests of a board: the client and its answers, frames that pass, checks,
 * the emulator.
 *
 * One bench a program. Waiting is counted in the board's frames wherever it can be; seconds only bound it. */
#ifndef TESTS_BOARD_BENCH_H
#define TESTS_BOARD_BENCH_H

#include <sys/types.h>
#include "host_sim/live/client.h"
#include "host_sim/scene/scene.h"

enum {
    BENCH_SUBSTEPS = 64,  /* default of an image whose board names none */
    BENCH_HEARTBEAT = 20, /* frames */
    BENCH_PATIENCE =
        10000, /* the most there is: frames without a heartbeat while a loaded machine runs the test */
    BENCH_HEALTH_ROUND = 5 * DIAG_COUNTERS /* frames until every counter was sent */
};

struct bench {
    struct scene_app scene; /* that of the image */
    struct client client;
    int cause[WIRE_KINDS];   /* cause of the last REPLY to each kind, or -1 */
    uint64_t reaction_frame; /* frame of the first STATUS with a reaction since this was 0 */
};
extern struct bench bench;

/* Equal numbers, printed. */
void bench_check(const char *name, double got, double expected);

/* Bound of any wait, seconds: long, until something has failed. */
double bench_limit_s(void);

/* The scene of this name, or for NULL the default one with
 * these substeps, before there is a bus. False: it said why. */
bool bench_open(const char *scene, uint32_t substeps);

/* The client on this bus. */
void bench_connect(const struct hal *hal);

/* Room for what a board says while this program is away; as much as the system grants. */
void bench_roomy(int socket);

/* Starts the emulator, its console into a file. */
pid_t bench_boot(const char *console, char **emulator);

/* Ends it and prints the sums: the program's exit status. */
int bench_close(pid_t emulator);

/* Frames of the board pass, with heartbeats or without. */
void bench_pass(uint64_t frames, bool beat);

/* The cause with which the board answers a command of this kind; `sent` is there for its evaluation. */
int bench_answer(unsigned kind, bool sent);

/* A parameter or setting: sent, committed, echoed. */
void bench_set(const char *name, double value);

/* CONTROL with the latest frame as its argument: must be answered so. */
void bench_control(const char *name, enum control_operation operation, enum cause expected);

/* Messages sent between these two calls go in one packet, which one frame of the board takes (CAN has no
 * packets). */
void bench_gather(void);
void bench_send_off(void);

/* A session whose time-out and age limit a loaded machine does not reach. */
void bench_open_session(void);

#endif
