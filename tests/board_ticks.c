/* board_ticks.c - a program for boards: what a tick of each method takes, and for the rig a whole frame with the substeps of
 * the board's image. In nanoseconds by the board's clock; in QEMU with -icount shift=0 that is its instructions.
 *
 * One drive, the rig's contact kept. A frame sends to a bus that takes everything at once. */
#include "firmware/app.h"
#include "hal/board.h"
#include "hal/console.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"
#include "tests/silent_bus.h"

/* TICKS: then microseconds of all are nanoseconds of one. */
enum { NS_PER_US = 1000, TICKS = NS_PER_US, WARM_UP = 200, FRAMES = 100 };

static struct plant pl;
static struct app app;
static double work[METHOD_WORK];

static const struct {
    const char *name;
    const struct model *model;
    const struct method *method;
    int input;
    double newton, hertz;
} run[] = {
    {"rk4", &hertz_rig, &rk4, RIG_FORCE, 1.0, 225.0},
    {"rk4_float32", &hertz_rig, &rk4_float32, RIG_FORCE, 1.0, 225.0},
    {"taylor", &hertz_rig, &taylor, RIG_FORCE, 1.0, 225.0},
    {"rk4:shaft", &shaft_bearing, &rk4, 1, 2.0, 25.0},
    {"rk4_float32:shaft", &shaft_bearing, &rk4_float32, 1, 2.0, 25.0},
    {"exact:shaft", &shaft_bearing, &exact, 1, 2.0, 25.0},
};
enum { RUNS = sizeof run / sizeof run[0], RIG_RUNS = 3 };

static void tell(const char *name, const char *what, const char *why, uint32_t value)
{
    console_text(name);
    console_text(what);
    if (why)
        console_text(why);
    else
        console_number(value);
    console_text("\n");
    console_flush();
}

static const char *measure_ticks(int i, uint32_t *us)
{
    struct plant_config c = {
        .model = run[i].model, .method = run[i].method, .tick_s = 1e-3 / 64, .dilation = 1.0, .work = work};
    const char *why = plant_init(&pl, &c);
    if (why)
        return why;
    plant_drive_start(&pl, run[i].input, run[i].newton, run[i].hertz, 0.0);
    if (!plant_run(&pl, WARM_UP))
        return "not finite";
    uint32_t begin_us = board_now_us();
    bool finite = plant_run(&pl, TICKS);
    *us = board_now_us() - begin_us;
    return finite ? NULL : "not finite";
}

static const char *measure_frames(int i, uint32_t *ns)
{
    const struct app_config c = {.model = run[i].model,
                                 .method = run[i].method,
                                 .frame_s = 1e-3,
                                 .substeps = BOARD_SUBSTEPS,
                                 .dilation = 1.0,
                                 .work = work};
    const char *why = app_init(&app, &c, &silent_bus);
    if (why)
        return why;
    plant_drive_start(&app.plant, run[i].input, run[i].newton, run[i].hertz, 0.0);
    app.state = STATE_RUNNING;
    for (int k = 0; k < WARM_UP; k++)
        app_frame(&app);
    uint32_t begin_us = board_now_us();
    for (int k = 0; k < FRAMES; k++)
        app_frame(&app);
    *ns = (board_now_us() - begin_us) * (NS_PER_US / FRAMES);
    return app.state == STATE_RUNNING ? NULL : "stopped";
}

int main(void)
{
    uint32_t ns = 0;
    bool paced = board_pace(0.1);
    for (int i = 0; paced && i < RUNS; i++) {
        const char *why = measure_ticks(i, &ns);
        tell(run[i].name, " tick ", why, ns);
    }
    for (int i = 0; paced && i < RIG_RUNS; i++) {
        const char *why = measure_frames(i, &ns);
        tell(run[i].name, " frame ", why, ns);
    }
    return !paced;
}
