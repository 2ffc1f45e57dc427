/* bench_frame.c - time per step and per frame on this machine, against a tight hand-written loop in the same
 * run.
 *
 *   bench_frame [ROUNDS]
 *
 * Numbers, never pass or fail: the machine decides them. Interleaved rounds, medians. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "firmware/app/app.h"
#include "models/hertz_rig.h"
#include "tests/bench/cost/bench_time.h"
#include "tests/fixture/silent_bus.h"
#include "tests/bench/cost/work_pieces.h"

enum { ROUNDS = 25, STEPS = 200000, SAMPLES = 400, TOGETHER = 10, SUBSTEPS = 64 };

/* A hand-written plant for one drive, to compare with: equal equation and units, phasor drive, all in
 * registers, and in the second-order form that makes it fastest. */
struct hand {
    double y, w, cosine, sine;
};

static double acceleration(double drive, double y, double w, double two_xi)
{
    double e = y > 0.0 ? y : 0.0;
    return ((2.0 / 3.0) * (1.0 + drive) - two_xi * w) - (2.0 / 3.0) * (e * sqrt(e));
}

static struct hand hand_loop(struct hand s, int steps, double h, double two_xi, double sigma, double omega)
{
    double ch = cos(0.5 * omega * h), sh = sin(0.5 * omega * h), half = 0.5 * h, sixth = h / 6.0;
    double quarter = half * half, square = half * h;
    for (int i = 0; i < steps; i++) {
        double d0 = sigma * s.cosine, c = s.cosine * ch - s.sine * sh, d = s.sine * ch + s.cosine * sh;
        double d1 = sigma * c;
        s.cosine = c * ch - d * sh;
        s.sine = d * ch + c * sh;
        double d2 = sigma * s.cosine;
        double k1 = acceleration(d0, s.y, s.w, two_xi);
        double y2 = s.y + half * s.w, k2 = acceleration(d1, y2, s.w + half * k1, two_xi);
        double k3 = acceleration(d1, y2 + quarter * k1, s.w + half * k2, two_xi), y4 = s.y + h * s.w;
        double k4 = acceleration(d2, y4 + square * k2, s.w + h * k3, two_xi);
        s.y = y4 + h * sixth * (k1 + (k2 + k3));
        s.w += sixth * ((k1 + k4) + 2.0 * (k2 + k3));
    }
    return s;
}

static void start(struct app *a, const struct hal *hal)
{
    struct app_config c = {
        .model = &hertz_rig, .method = &rk4, .frame_s = 1e-3, .substeps = SUBSTEPS, .dilation = 1.0};
    const char *why = app_init(a, &c, hal);
    if (why) {
        fprintf(stderr, "%s\n", why);
        exit(1);
    }
    plant_drive_start(&a->plant, RIG_FORCE, 1.0, 225.0, 0.0);
    a->state = STATE_RUNNING;
}

/* The method alone, as the plant calls it, the drive's inputs standing: contact kept, no switch. */
static double kernel_ns(struct app *a)
{
    struct plant *pl = &a->plant;
    struct crossing c;
    double x[MODEL_STATES], begin = bench_time_ns();
    memcpy(x, pl->x, sizeof x);
    for (int i = 0; i < STEPS; i++) {
        if (pl->step(pl->model, pl->p, pl->scratch, &pl->segment, pl->regime, x, &c) != STEP_END)
            exit(3);
    }
    return (bench_time_ns() - begin) / STEPS;
}

static double plant_ns(struct app *a)
{
    double begin = bench_time_ns();
    if (!plant_run(&a->plant, STEPS))
        exit(3);
    return (bench_time_ns() - begin) / STEPS;
}

/* Frames, ten a sample: the clock of the process is a system call, which takes a third of a frame. */
static void frames_us(struct app *a, double *us)
{
    for (int i = 0; i < SAMPLES; i++) {
        double begin = bench_time_ns();
        for (int k = 0; k < TOGETHER; k++)
            app_frame(a);
        us[i] = 1e-3 * (bench_time_ns() - begin) / TOGETHER;
    }
}

/* A piece of work by name, its call included. */
static double piece_ns(const char *name)
{
    double ns[ROUNDS];
    int i = 0;
    while (strcmp(work_piece[i].name, name) != 0)
        i++;
    for (int r = 0; r < ROUNDS; r++) {
        work_setup(i);
        double begin = bench_time_ns();
        for (int k = 0; k < WORK_CALLS; k++)
            work_piece[i].once();
        ns[r] = (bench_time_ns() - begin) / WORK_CALLS;
    }
    work_check(i);
    return bench_time_median(ns, ROUNDS);
}

int main(int argc, char **argv)
{
    static struct app a;
    static double frame[SAMPLES];
    double hand_ns[ROUNDS], kernel[ROUNDS], tick[ROUNDS], frame_us[ROUNDS], frame_p99[ROUNDS];
    struct hand s = {1.0, 0.0, 1.0, 0.0};
    int rounds = argc > 1 ? atoi(argv[1]) : ROUNDS;
    if (rounds < 1 || rounds > ROUNDS) {
        fprintf(stderr, "usage: bench_frame [ROUNDS], 1 to %d\n", ROUNDS);
        return 2;
    }
    start(&a, &silent_bus);
    double h = a.plant.h, omega = 225.0 * 2.0 * 3.14159265358979 * a.plant.scale.time_s;
    for (int r = 0; r < rounds; r++) {
        double begin = bench_time_ns();
        s = hand_loop(s, STEPS, h, a.plant.p[RIG_P_TWO_XI], 1.0 / 64.0, omega);
        hand_ns[r] = (bench_time_ns() - begin) / STEPS;
        kernel[r] = kernel_ns(&a);
        tick[r] = plant_ns(&a);
        frames_us(&a, frame);
        frame_us[r] = bench_time_median(frame, SAMPLES);
        frame_p99[r] = frame[SAMPLES * 99 / 100];
        if (isatty(STDERR_FILENO))
            fprintf(stderr, "\rround %d of %d%s", r + 1, rounds,
                    r + 1 < rounds ? "" : "\r                \r");
    }
    double hand = bench_time_median(hand_ns, rounds), kernel_median = bench_time_median(kernel, rounds);
    printf("hand-written rk4 loop, one drive    %7.1f ns a step   (ends at y = %.6f)\n", hand, s.y);
    printf("rk4 kernel as the plant calls it    %7.1f ns a step   ratio %.2f\n", kernel_median,
           kernel_median / hand);
    printf("plant tick, drive, switches, ledger %7.1f ns a tick\n", bench_time_median(tick, rounds));
    printf("frame of %d ticks, lock-in, telemetry  median %.2f us, 99 %% below %.2f us\n", SUBSTEPS,
           bench_time_median(frame_us, rounds), bench_time_median(frame_p99, rounds));
    printf("exact on the shaft: a step %.1f ns, a switch %.0f ns\n", piece_ns("exact_step"),
           piece_ns("exact_event"));
    printf("taylor, series: in time %.0f ns, regularised %.0f ns, short %.0f ns\n", piece_ns("taylor_time"),
           piece_ns("taylor_regular"), piece_ns("taylor_short"));
    if (work_fault)
        fprintf(stderr, "%s\n", work_fault);
    return work_fault != NULL;
}
