/* bench.c - see bench.h. */
#include "host_sim/trial/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "host_sim/cli/clock.h"
#include "host_sim/live/bus.h"
#include "host_sim/live/lockstep.h"
#include "host_sim/trial/bench_plant.h"
#include "host_sim/trial/child.h"

enum {
    LOOK_FRAMES = 64, /* bus frames from one look at the controller's output to the next */
    COMMAND_TEXT = 4096,
    ADDRESS = 32,
    REASON = 512, /* room for that of a bus, a plant or a child */
    START_S = 2,  /* seconds of the bus, within which plant time must run */
    SLOWER = 2    /* bus frames may be so many times those of plant time */
};
static const double grace_s = 1.0; /* that a controller has to end after SIGTERM */

struct bench {
    const struct bench_setting *s;
    const struct trial_case *c;
    struct bench_result *r;
    struct bench_plant plant;
    struct bus bus;
    struct lockstep lockstep;
    struct child child;
    struct measurement_link link;
    bool was_enabled;
    uint32_t timeouts;
    uint64_t end_tick, frames;
};

static bool fail(struct bench_result *r, const char *format, const char *a, const char *b)
{
    snprintf(r->error, sizeof r->error, format, a, b);
    r->verdict = VERDICT_ERROR;
    return false;
}

/* ---- set-up ---- */

/* Every process has an address of its own on loopback, 127.64.0.0 and up: runs side by side need no free port. */
static void address(char text[ADDRESS], int port)
{
    unsigned pid = (unsigned)getpid();
    snprintf(text, ADDRESS, "127.%u.%u.%u:%d", 64 + (pid >> 16 & 63), pid >> 8 & 255, pid & 255, port);
}

/* The command with what stands in braces filled in. */
static bool fill(const struct bench *b, char text[COMMAND_TEXT])
{
    char plant[ADDRESS], me[ADDRESS], rate[ADDRESS], substeps[ADDRESS], seed[ADDRESS];
    const struct app_config *c = &b->plant.scene.config;
    const struct {
        const char *name, *text;
    } known[] = {{"{plant}", plant},
                 {"{me}", me},
                 {"{rate}", rate},
                 {"{substeps}", substeps},
                 {"{seed}", seed},
                 {"{scene}", b->s->trial->scene_name},
                 {"{contactplant}", b->s->program}};
    address(plant, 20000), address(me, 20001);
    snprintf(rate, sizeof rate, "%.17g", 1.0 / c->frame_s);
    snprintf(substeps, sizeof substeps, "%u", c->substeps);
    snprintf(seed, sizeof seed, "%u", b->r->seed);
    size_t n = 0;
    for (const char *at = b->s->trial->command; *at && n + 1 < COMMAND_TEXT;) {
        size_t i = 0;
        while (i < sizeof known / sizeof known[0] && strncmp(at, known[i].name, strlen(known[i].name)))
            i++;
        if (i == sizeof known / sizeof known[0]) {
            text[n++] = *at++;
            continue;
        }
        n += (size_t)snprintf(text + n, COMMAND_TEXT - n, "%s", known[i].text);
        at += strlen(known[i].name);
    }
    text[n < COMMAND_TEXT ? n : COMMAND_TEXT - 1] = 0;
    return n < COMMAND_TEXT;
}

static bool open_bus(struct bench *b)
{
    char spec[ADDRESS + 4] = "udp:", me[ADDRESS], why[BUS_REASON];
    const char *peer[] = {me};
    address(spec + 4, 20000), address(me, 20001);
    if (!bus_open(&b->bus, spec, peer, 1, &b->plant.scene.app.scene, why))
        return fail(b->r, "the plant's socket: %s%s", why, "");
    const char *reason = udp_begin_lockstep(&b->bus.udp, 1u);
    if (reason)
        return fail(b->r, "the plant's socket: %s%s", reason, "");
    b->bus.hal = b->bus.udp.hal;
    b->lockstep = (struct lockstep){.on = true, .bus = &b->bus, .patience_s = b->s->patience_s};
    if (*b->c->link && !bus_add_faults(&b->bus, b->c->link, b->r->seed, b->plant.scene.config.frame_s, why))
        return fail(b->r, "link: %s%s", why, "");
    b->plant.scene.app.hal = &b->bus.hal;
    return true;
}

/* keep.test, case "bad bus", seed 3: DIR/keep.bad_bus.3.log */
static void log_path(const struct bench *b, const char *end, char path[BENCH_PATH])
{
    const char *slash = strrchr(b->s->trial->file, '/'), *file = slash ? slash + 1 : b->s->trial->file;
    const char *point = strrchr(file, '.');
    int n = snprintf(path, BENCH_PATH, "%s/%.*s.", b->s->log,
                     (int)(point ? point - file : (long)strlen(file)), file);
    for (const char *at = b->c->name; *at && n < BENCH_PATH - 64; at++)
        path[n++] = strchr("/ \t", *at) ? '_' : *at;
    path[n] = 0;
    if (b->c->n_seeds > 1)
        n += snprintf(path + n, (size_t)(BENCH_PATH - n), ".%u", b->r->seed);
    if (b->r->varied)
        n += snprintf(path + n, (size_t)(BENCH_PATH - n), ".%.6g", b->r->varied_value);
    snprintf(path + n, (size_t)(BENCH_PATH - n), "%s", end);
}

static bool start_controller(struct bench *b, FILE **output)
{
    char command[COMMAND_TEXT], folder[BENCH_PATH], path[BENCH_PATH], why[REASON];
    const char *slash = strrchr(b->s->trial->file, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - b->s->trial->file) : 1,
             slash ? b->s->trial->file : ".");
    if (slash == b->s->trial->file)
        snprintf(folder, sizeof folder, "/");
    if (b->s->log) {
        log_path(b, ".log", b->r->log);
        log_path(b, ".controller.txt", path);
        *output = fopen(path, "w");
        if (!*output || !bus_record(&b->bus, b->r->log, 0, why))
            return fail(b->r, "--log: cannot write %.400s%s", *output ? b->r->log : path, "");
    }
    if (!fill(b, command))
        return fail(b->r, "the command is too long%s%s", "", "");
    return child_start(&b->child, command, folder, *output, why) ? true : fail(b->r, "%s%s", why, "");
}

/* ---- the run ---- */

/* Whether the file says what is expected when the controller ends its session by itself. */
static bool stop_is_expected(const struct bench *b)
{
    for (int i = 0; i < b->c->n_expects; i++)
        if (b->c->expect[i].what.kind == METRIC_STOPPED)
            return true;
    return false;
}

static void one_frame(struct bench *b)
{
    struct app *a = &b->plant.scene.app;
    bus_set_frame(&b->bus, a->frame, b->plant.scene.config.frame_s, 0);
    app_frame(a);
    uint32_t timeouts = a->count[DIAG_TIMEOUTS];
    if (b->was_enabled && !a->enabled && timeouts == b->timeouts && b->link.stopped_s < 0.0)
        b->link.stopped_s = plant_time(&a->plant);
    b->was_enabled = a->enabled;
    b->timeouts = timeouts;
    b->link.malformed = (double)b->bus.udp.malformed;
    bench_plant_frame(&b->plant, &b->link);
    b->frames++;
}

static bool controller_ended(struct bench *b)
{
    char how[CHILD_REASON], when[64];
    const struct app *a = &b->plant.scene.app;
    if (child_look(&b->child))
        return false;
    if (b->link.stopped_s >= 0.0 && stop_is_expected(b))
        return true;
    child_describe(&b->child, how);
    if (a->plant.now.tick)
        snprintf(when, sizeof when, "at %g s of plant time", plant_time(&a->plant));
    else
        snprintf(when, sizeof when, "before plant time ran");
    fail(b->r, "the controller ended %s: it %s", when, how);
    return true;
}

/* One bus frame; false when the run is over, with an error or without. */
static bool turn(struct bench *b)
{
    char why[REASON], reason[REASON];
    if (!bench_plant_act(&b->plant, reason))
        return fail(b->r, "%s%s", reason, "");
    switch (lockstep_await(&b->lockstep, false, why)) {
    case LOCKSTEP_SILENT:
        return fail(b->r, "%s%s", why, "");
    case LOCKSTEP_WAITS:
        return !controller_ended(b);
    default:
        one_frame(b);
        if (b->frames % LOOK_FRAMES == 0)
            (void)child_look(&b->child);
        return b->plant.scene.app.plant.now.tick < b->end_tick;
    }
}

/* Why plant time did not reach its end in all the bus frames that it may take. */
static void explain_stand(struct bench *b)
{
    const struct app *a = &b->plant.scene.app;
    char when[64], state[64];
    if (b->link.stopped_s >= 0.0 && stop_is_expected(b))
        return;
    snprintf(when, sizeof when, "%g", plant_time(&a->plant));
    snprintf(state, sizeof state, "%s%s", bench_plant_state(&b->plant),
             b->link.stopped_s >= 0.0 ? ", the controller ended its session" : "");
    if (a->plant.now.tick == 0)
        fail(b->r, "plant time never ran (%s): the controller must enable and start the plant%s", state, "");
    else
        fail(b->r, "plant time did not go on from %s s (%s)", when, state);
}

static void run(struct bench *b)
{
    const struct app_config *c = &b->plant.scene.config;
    uint64_t frames = (uint64_t)ceil(b->c->over_s / c->frame_s - 1e-9),
             limit = SLOWER * frames + (uint64_t)(START_S / c->frame_s);
    b->end_tick = frames * c->substeps;
    b->link.stopped_s = -1.0;
    while (b->frames < limit && turn(b))
        ;
    if (b->r->verdict != VERDICT_ERROR && b->plant.scene.app.plant.now.tick < b->end_tick)
        explain_stand(b);
}

/* The plant goes on, unrecorded and unjudged, so that a controller can end its session. */
static void let_go(struct bench *b)
{
    char why[BUS_REASON], left[64];
    double end_s = clock_now_s() + grace_s;
    child_ask(&b->child);
    while (child_look(&b->child) && clock_now_s() < end_s)
        if (lockstep_await(&b->lockstep, false, why) == LOCKSTEP_BEGINS)
            app_frame(&b->plant.scene.app);
    int n = child_end(&b->child);
    snprintf(left, sizeof left, "%d", n);
    if (n && b->r->verdict != VERDICT_ERROR)
        fail(b->r, "the controller left %s processes behind, which were ended%s", left, "");
}

static void end_record(struct bench *b)
{
    char why[BUS_REASON];
    if (!bus_end_record(&b->bus, why) && b->r->verdict != VERDICT_ERROR)
        fail(b->r, "--log: %s%s", why, "");
    b->plant.scene.app.hal = &b->bus.hal;
}

void bench_run(const struct bench_setting *s, struct bench_result *r)
{
    static struct bench b; /* large: not on the stack */
    char why[REASON];
    FILE *output = NULL;
    memset(&b, 0, sizeof b);
    b.s = s;
    b.r = r;
    b.c = &s->trial->cases[r->i_case];
    double begin_s = clock_now_s();
    if (!bench_plant_open(&b.plant, s->trial, b.c, r->varied ? &r->varied_value : NULL, why))
        fail(r, "%s%s", why, "");
    else if (open_bus(&b) && start_controller(&b, &output))
        run(&b);
    end_record(&b);
    r->plant_s = plant_time(&b.plant.scene.app.plant);
    r->took_s = clock_now_s() - begin_s;
    bench_plant_judge(&b.plant, b.c, r);
    let_go(&b);
    if (output && fclose(output) && r->verdict != VERDICT_ERROR)
        fail(r, "--log: cannot write what the controller printed%s%s", "", "");
    bus_close(&b.bus);
    bench_plant_close(&b.plant);
}
