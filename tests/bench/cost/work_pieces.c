/* work_pieces.c - see work_pieces.h. */
#include "tests/bench/cost/work_pieces.h"

#include <string.h>
#include "firmware/app/app.h"
#include "firmware/method/auto.h"
#include "firmware/method/taylor/taylor_piece.h"
#include "firmware/plant/plant_change.h"
#include "models/hertz_rig.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/silent_bus.h"

#define WORK __attribute__((noinline)) static void
#define HZ   230.0 /* the default rig's contact resonance, nearly */

#ifndef BOARD_SUBSTEPS
#define BOARD_SUBSTEPS 64 /* in a frame of a millisecond */
#endif

enum { PERIOD = 128, SUBSTEPS = 64 };

const char *work_fault;

static struct plant pl;
static struct app app;
static double scratch[METHOD_SCRATCH], state[MODEL_STATES], start_at[MODEL_STATES];
static struct segment input;
static struct wave wave;
static enum step_status status, wanted;

static void expect(const char *what, int condition)
{
    if (!condition && !work_fault)
        work_fault = what;
}

static void start(const struct model *m, const struct method *method, double tick_s, double tol)
{
    struct plant_config c = {
        .model = m, .method = method, .tick_s = tick_s, .dilation = 1.0, .tol = tol, .scratch = scratch};
    const char *why = plant_init(&pl, &c);
    expect(why ? why : "plant_init", !why);
}

/* The rig with one drive, some ticks on its way. */
static void start_rig(const struct method *method, double newton, double hertz, double tick_s, double tol)
{
    start(&hertz_rig, method, tick_s, tol);
    plant_drive_start(&pl, RIG_FORCE, newton, hertz, 0.0);
    expect("a finite motion", plant_run(&pl, 2 * PERIOD));
}

/* One step of the method itself, from `state`, over `input`. */
static void one_step(void)
{
    struct crossing c;
    status = pl.step(pl.model, pl.p, pl.scratch, &input, pl.regime, state, &c);
}

/* The last tick once more, from where the plant is; each step is to end as `end`. */
static void take_input(enum step_status end)
{
    input = pl.segment;
    memcpy(state, pl.x, sizeof state);
    wanted = end;
    one_step();
}

WORK tick(void)
{
    status = plant_run(&pl, 1) ? STEP_END : STEP_NOT_FINITE;
}

/* ---- rk4 ---- */

static void setup_rk4_step(void)
{
    start_rig(&rk4, 1.0, 225.0, 1e-3 / SUBSTEPS, 0.0);
    take_input(STEP_END);
}

WORK once_rk4_step(void)
{
    one_step();
}

static void setup_auto_step(void)
{
    start_rig(&auto_method, 1.0, 225.0, 1e-3 / SUBSTEPS, 1e-4);
    expect("rk4 by choice", auto_now(pl.scratch) == &rk4);
    take_input(STEP_END);
}

WORK once_auto_step(void)
{
    one_step();
}

static void setup_rk4_tick(void)
{
    start_rig(&rk4, 1.0, 225.0, 1e-3 / SUBSTEPS, 0.0);
}

WORK once_rk4_tick(void)
{
    tick();
}

/* A new sampled force in each tick, as a controller at tick rate sends it. */
WORK once_sample_tick(void)
{
    plant_sample(&pl, RIG_FORCE, pl.now.tick & 1u ? 0.5 : -0.5, 0);
    tick();
}

WORK once_drive(void)
{
    (void)drive_segment(&pl.drive[RIG_FORCE], TICK_FRACTIONS, pl.ticks_per_time, &wave,
                        &input.at[0][RIG_FORCE], &input.at[1][RIG_FORCE], &input.at[2][RIG_FORCE]);
}

WORK once_ledger(void)
{
    (void)ledger_piece(&pl.ledger, pl.p, &input, start_at, state);
}

static void setup_float32_step(void)
{
    start_rig(&rk4_float32, 1.0, 225.0, 1e-3 / SUBSTEPS, 0.0);
    take_input(STEP_END);
}

WORK once_float32_step(void)
{
    one_step();
}

static void setup_float32_tick(void)
{
    start_rig(&rk4_float32, 1.0, 225.0, 1e-3 / SUBSTEPS, 0.0);
}

WORK once_float32_tick(void)
{
    tick();
}

/* ---- taylor ---- */

static const struct taylor *piece(void)
{
    return (const struct taylor *)(const void *)scratch;
}

/* Steps so short that all of them lie in one series. */
static void setup_taylor_read(void)
{
    start_rig(&taylor, 1.0, 225.0, 1e-9, 0.0);
    take_input(STEP_END);
}

WORK once_taylor_read(void)
{
    one_step();
}

/* A state put in place begins a series: one in time where the contact is deep, in s where it is nearly lost.
 * An input that changed is done with in a short series that nothing is kept of. */
static void setup_series(double eta, double rate, enum taylor_kind kind)
{
    start_rig(&taylor, 1.0, 225.0, 1.0 / HZ / PERIOD, 0.0);
    input = pl.segment;
    input.changed = kind == TAYLOR_NONE;
    if (input.changed)
        input.wave[RIG_FORCE] = (struct wave){.offset = 0.01, .slope = 0.02, .cosine = 1.0};
    start_at[0] = eta;
    start_at[1] = rate;
    memcpy(state, start_at, sizeof state);
    wanted = STEP_END;
    one_step();
    expect("the kind of the series", piece()->kind == kind);
    expect("one that reaches the end", kind == TAYLOR_NONE || piece()->now == input.length);
}

static void setup_taylor_short(void)
{
    setup_series(1.5, 0.3, TAYLOR_NONE);
}

WORK once_taylor_short(void)
{
    memcpy(state, start_at, 2 * sizeof(double));
    one_step();
}

static void setup_taylor_time(void)
{
    setup_series(1.5, 0.3, TAYLOR_TIME);
}

WORK once_taylor_time(void)
{
    memcpy(state, start_at, 2 * sizeof(double));
    one_step();
}

static void setup_taylor_regular(void)
{
    setup_series(0.02, -0.3, TAYLOR_REGULAR);
}

WORK once_taylor_regular(void)
{
    memcpy(state, start_at, 2 * sizeof(double));
    one_step();
}

/* Ticks of a motion, on the average: contact kept, and lost in every cycle. */
static void setup_taylor_smooth_tick(void)
{
    start_rig(&taylor, 0.5, 0.9 * HZ, 1.0 / HZ / PERIOD, 0.0);
}

WORK once_taylor_smooth_tick(void)
{
    tick();
}

static void setup_taylor_lost_tick(void)
{
    start_rig(&taylor, 0.3 * 64.0, 0.9 * HZ, 1.0 / HZ / PERIOD, 0.0);
}

WORK once_taylor_lost_tick(void)
{
    tick();
}

/* ---- the shaft ---- */

static void start_shaft(const struct method *method, double tick_s)
{
    start(&shaft_bearing, method, tick_s, 0.0);
    plant_drive_start(&pl, 1, 2.0, 25.0, 0.0);
    expect("a finite motion", plant_run(&pl, 10));
}

static void setup_shaft_rk4_tick(void)
{
    start_shaft(&rk4, 1e-3 / SUBSTEPS);
}

WORK once_shaft_rk4_tick(void)
{
    tick();
}

static void setup_shaft_float32_tick(void)
{
    start_shaft(&rk4_float32, 1e-3 / SUBSTEPS);
}

WORK once_shaft_float32_tick(void)
{
    tick();
}

static void setup_shaft_exact_tick(void)
{
    start_shaft(&exact, 1e-3 / SUBSTEPS);
}

WORK once_shaft_exact_tick(void)
{
    tick();
}

static void setup_exact_step(void)
{
    start_shaft(&exact, 1e-4);
    take_input(STEP_END);
}

WORK once_exact_step(void)
{
    one_step();
}

static void setup_exact_event(void)
{
    start_shaft(&exact, 1e-4);
    const double near_the_gap[MODEL_STATES] = {0.99, 0.2, 0.1, 0.2};
    memcpy(start_at, near_the_gap, sizeof start_at);
    input = pl.segment;
    memcpy(state, start_at, sizeof state);
    wanted = STEP_SWITCH;
    one_step();
}

WORK once_exact_event(void)
{
    memcpy(state, start_at, sizeof state);
    one_step();
}

/* ---- a frame ---- */

static void start_frames(const struct method *method)
{
    const struct app_config c = {.model = &hertz_rig,
                                 .method = method,
                                 .frame_s = 1e-3,
                                 .substeps = BOARD_SUBSTEPS,
                                 .dilation = 1.0,
                                 .scratch = scratch};
    const char *why = app_init(&app, &c, &silent_bus);
    expect(why ? why : "app_init", !why);
    plant_drive_start(&app.plant, RIG_FORCE, 1.0, 225.0, 0.0);
    app.state = STATE_RUNNING;
    for (int i = 0; i < 100; i++)
        app_frame(&app);
    wanted = status = STEP_END;
}

WORK frame(void)
{
    app_frame(&app);
    status = app.state == STATE_RUNNING ? STEP_END : STEP_NOT_FINITE;
}

static void setup_frame(void)
{
    start_frames(&rk4);
}

WORK once_frame(void)
{
    frame();
}

static void setup_float32_frame(void)
{
    start_frames(&rk4_float32);
}

WORK once_float32_frame(void)
{
    frame();
}

static void setup_taylor_frame(void)
{
    start_frames(&taylor);
}

WORK once_taylor_frame(void)
{
    frame();
}

const struct work_piece work_piece[WORK_PIECES] = {
    {"rk4_step", setup_rk4_step, once_rk4_step},
    {"auto_step", setup_auto_step, once_auto_step},
    {"rk4_tick", setup_rk4_tick, once_rk4_tick},
    {"float32_step", setup_float32_step, once_float32_step},
    {"float32_tick", setup_float32_tick, once_float32_tick},
    {"sample_tick", setup_rk4_tick, once_sample_tick},
    {"drive", setup_rk4_step, once_drive},
    {"ledger", setup_rk4_step, once_ledger},
    {"taylor_read", setup_taylor_read, once_taylor_read},
    {"taylor_short", setup_taylor_short, once_taylor_short},
    {"taylor_time", setup_taylor_time, once_taylor_time},
    {"taylor_regular", setup_taylor_regular, once_taylor_regular},
    {"taylor_smooth_tick", setup_taylor_smooth_tick, once_taylor_smooth_tick},
    {"taylor_lost_tick", setup_taylor_lost_tick, once_taylor_lost_tick},
    {"exact_step", setup_exact_step, once_exact_step},
    {"exact_event", setup_exact_event, once_exact_event},
    {"shaft_rk4_tick", setup_shaft_rk4_tick, once_shaft_rk4_tick},
    {"shaft_float32_tick", setup_shaft_float32_tick, once_shaft_float32_tick},
    {"shaft_exact_tick", setup_shaft_exact_tick, once_shaft_exact_tick},
    {"frame", setup_frame, once_frame},
    {"float32_frame", setup_float32_frame, once_float32_frame},
    {"taylor_frame", setup_taylor_frame, once_taylor_frame},
};

void work_setup(int i)
{
    wanted = STEP_END;
    work_piece[i].setup();
}

void work_check(int i)
{
    expect(work_piece[i].name, status == wanted);
}
