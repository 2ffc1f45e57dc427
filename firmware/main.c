/* main.c - the plant on a board: a frame of work per timer period, sleep between, one line a second on the
 * console.
 *
 * All models and methods are in the image. FIRMWARE_MODEL, FIRMWARE_METHOD and FIRMWARE_SUBSTEPS choose
 * among them (make firmware MODEL=.. METHOD=.. SUBSTEPS=..). FIRMWARE_SCENE (SCENE=..) names a preset
 * instead, which has all of them, its drives and its start.
 *
 * The board restarts by itself after a failed assertion, an exception, a broken stack guard, a stopped
 * clock or a bite of the watchdog. Then the drives are silent and FAULT_ASSERT is latched; HEALTH last_run
 * and the console say what it was. A reset command acknowledges it; until then every start reports it
 * again. */
#include "firmware/app/app.h"
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_report.h"
#include "models/text.h"
#include "hal/board/board.h"
#include "hal/board/console.h"
#include "models/models.h"

enum { STATUS_EVERY = 1000, BASE_ID = 0x200 };

static struct app app;
static double scratch[METHOD_SCRATCH];
static float capture[BOARD_CAPTURE_VALUES];

/* ---- what runs ---- */

#ifdef FIRMWARE_SCENE
#define CHOICE  "scene " FIRMWARE_SCENE
#define FRAME_S app.config.frame_s

static const struct preset *preset;
static double si[MODEL_PARAMETERS];
static struct harmonic drive[MODEL_INPUTS];
static struct watch_limits limits;

static const char *choose(struct app_config *c)
{
    preset = scenes_find(FIRMWARE_SCENE);
    if (!preset)
        return "no scene " FIRMWARE_SCENE;
    const struct scene *s = &preset->scene;
    scenes_resolve(s, si, drive);
    c->model = s->model;
    c->method = method_find(s->method);
    c->si = si;
    c->frame_s = s->frame_s;
    c->substeps = (uint32_t)s->substeps;
    c->dilation = s->dilation;
    c->tol = s->tolerance;
    c->watch = plant_scene_watch(s, s->dilation, &limits) ? &limits : NULL;
    return c->method ? NULL : "no method of " FIRMWARE_SCENE;
}

static void begin(void)
{
    plant_scene_begin(&app.plant, &preset->scene, si, drive);
}
#else
#define CHOICE  FIRMWARE_MODEL " " FIRMWARE_METHOD
#define FRAME_S 1e-3

static const struct model *find_model(const char *name)
{
    for (int i = 0; i < MODELS; i++)
        if (text_equal(name, model_table[i]->name))
            return model_table[i];
    return NULL;
}

static const char *choose(struct app_config *c)
{
    c->frame_s = FRAME_S;
    c->substeps = FIRMWARE_SUBSTEPS;
    c->dilation = 1.0;
    c->model = find_model(FIRMWARE_MODEL);
    c->method = method_find(FIRMWARE_METHOD);
    if (!c->model)
        return "no model " FIRMWARE_MODEL;
    return c->method ? NULL : "no method " FIRMWARE_METHOD;
}

static void begin(void)
{
}
#endif

/* ---- start ---- */

/* Runs the self-test in the memory that the plant will use. A failure is reported on the bus, and keeps
 * the plant from being enabled. */
static struct selftest_result test_itself(void)
{
    const struct selftest_parts parts = {.model = model_table,
                                         .n_models = MODELS,
                                         .method = method_table,
                                         .n_methods = METHODS,
                                         .plant = &app.plant,
                                         .scratch = scratch,
                                         .n_scratch = METHOD_SCRATCH};
    struct selftest_result r;
    selftest_run(&parts, &r);
    return r;
}

static const char *start(void)
{
    const char *why;
    struct app_config c = {
        .base_id = BASE_ID, .scratch = scratch, .capture = capture, .n_capture = BOARD_CAPTURE_VALUES};
    why = choose(&c);
    if (why)
        return why;
    if (!board_pace(c.frame_s))
        return "the clock that paces frames stands still, or cannot make such periods";
    const struct hal *bus = board_bus(&why);
    if (!bus)
        return why;
    struct selftest_result r = test_itself();
    why = app_init(&app, &c, bus);
    if (why)
        return why;
    begin();
    app_take_selftest(&app, &r);
    return NULL;
}

/* ---- console ---- */

static void item(const char *name, uint64_t value)
{
    console_text(name);
    console_number(value);
}

static void tell_status(void)
{
    item("frame ", app.frame);
    item(" state ", app.state);
    item(" faults ", app.faults);
    item(" tick ", app.plant.now.tick);
    item(" missed ", app.count[DIAG_FRAMES_MISSED]);
    item(" compute_max_us ", app.timing.compute.max_us);
    item(" stack ", board_stack_used());
    item("/", board_stack_bytes());
    console_text(" hash ");
    console_hex(plant_hash(&app.plant), 16);
    console_text("\n");
}

/* ---- frames ---- */

/* Runs one frame. With none due it waits for a new period. Else it runs one of those that are due, and
 * first reports the periods that have begun meanwhile. Returns how many are due after it. */
static uint32_t turn(uint32_t due)
{
    uint32_t period_us = (uint32_t)(FRAME_S * 1e6);
    bool waits = due == 0;
    uint32_t periods = waits || board_late_us() >= period_us ? board_wait() : 0;
    uint32_t late_us = board_late_us() + (periods - waits) * period_us;
    due = app_overrun(&app, periods - waits);
    if (waits)
        histogram_add(&app.timing.lateness, late_us, app.frame);
    app_frame(&app);
    if (!board_stack_intact())
        board_fail(&(struct board_fault){.kind = BOARD_STACK});
    return due - 1;
}

/* ---- the last run ---- */

/* The fault that ended the last run, 0 for none; also printed on the console. */
static uint32_t last_run(void)
{
    struct board_fault last;
    uint32_t starts;
    if (!board_take_fault(&last, &starts))
        return 0;
    console_fault(&last, starts);
    return last.kind;
}

/* True once a reset command has cleared the fault of the last run. */
static bool acknowledged(void)
{
    if (app.faults & FAULT_ASSERT)
        return false;
    board_forget_fault();
    return true;
}

/* For a plant that cannot run: prints the reason and the fault of the last run, and sleeps for good. */
static void stand(const char *why)
{
    (void)last_run();
    console_text(why);
    console_text("\n");
    console_flush();
    board_stand();
}

int main(void)
{
    const char *why = start();
    console_text("contactplant " BOARD_NAME " " CHOICE "\n");
    if (why)
        stand(why);
    uint32_t ended = last_run();
    if (ended)
        app_take_last_run(&app, ended);
    if (!board_watch())
        console_text("no watchdog\n");
    uint64_t next = 0;
    uint32_t due = 0;
    (void)board_wait(); /* periods that passed during the start are no overrun */
    for (;;) {
        due = turn(due);
        if (ended && acknowledged())
            ended = 0;
        console_poll();
        if (app.frame >= next) {
            next = app.frame + STATUS_EVERY;
            tell_status();
        }
    }
}
