/* bench.c - see bench.h. */
#include "host_sim/test/bench/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "firmware/plant/plant_report.h"
#include "host_sim/cli/clock.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/live/bus.h"
#include "host_sim/live/lockstep.h"
#include "host_sim/test/bench/bench_plant.h"
#include "host_sim/test/bench/controller.h"

enum {
    LOOK_FRAMES = 64, /* bus frames from one look at the controller's output to the next */
    REASON = 512,     /* room for that of a bus, a plant or a child */
};
static const double grace_s = 1.0; /* that a controller has to end after SIGTERM */

struct bench {
    const struct bench_setting *s;
    const struct test_case *c;
    struct bench_result *r;
    struct bench_plant plant;
    struct bus bus;
    struct lockstep lockstep;
    struct verdict_record record;
    struct controller_place at;
    struct controller controller;
    struct bench_link link;
    bool was_enabled;
    uint32_t timeouts;
    uint64_t end_tick, frames;
};

/* ---- set-up ---- */

/* Every process has an address of its own on loopback,
 * 127.64.0.0 and up: runs side by side need no free port. */
static void address(char text[CONTROLLER_ADDRESS], int port)
{
    unsigned pid = (unsigned)getpid();
    snprintf(text, CONTROLLER_ADDRESS, "127.%u.%u.%u:%d", 64 + (pid >> 16 & 63), pid >> 8 & 255, pid & 255,
             port);
}

/* A controller that connects by itself knows the addresses of contactplant run. */
static void choose_place(struct bench *b)
{
    b->at.lockstep = true;
    if (b->s->test->attached) {
        snprintf(b->at.plant, sizeof b->at.plant, "%s", b->s->bus ? b->s->bus + 4 : "127.0.0.1:20000");
        snprintf(b->at.me, sizeof b->at.me, "%s", b->s->controller);
        fprintf(stderr, "case %s: the plant is at udp:%s and waits for a controller at udp:%s\n", b->c->name,
                b->at.plant, b->at.me);
        return;
    }
    address(b->at.plant, 20000);
    address(b->at.me, 20001);
}

static bool open_memory(struct bench *b)
{
    char why[BUS_REASON];
    if (!bus_open(&b->bus, "memory:", NULL, 0, &b->plant.scene.app.scene, why))
        return controller_fail(b->r, "%s%s", why, "");
    b->at.memory = b->bus.memory.path;
    return true;
}

static bool open_udp(struct bench *b)
{
    char spec[CONTROLLER_ADDRESS + 4], why[BUS_REASON];
    const char *peer[] = {b->at.me};
    snprintf(spec, sizeof spec, "udp:%s", b->at.plant);
    if (!bus_open(&b->bus, spec, peer, 1, &b->plant.scene.app.scene, why))
        return controller_fail(b->r, "the plant's socket: %s%s", why, "");
    const char *reason = udp_begin_lockstep(&b->bus.udp, 1u);
    if (reason)
        return controller_fail(b->r, "the plant's socket: %s%s", reason, "");
    b->bus.hal = b->bus.udp.hal;
    return true;
}

static bool open_bus(struct bench *b)
{
    char why[BUS_REASON];
    choose_place(b);
    if (!(controller_takes_memory(b->s->test) ? open_memory : open_udp)(b))
        return false;
    b->lockstep = (struct lockstep){.on = true, .bus = &b->bus, .patience_s = b->s->patience_s};
    if (bench_has_faults(b->c) &&
        !bus_add_faults(&b->bus, b->c->link, b->r->seed, b->plant.scene.config.frame_s, why))
        return controller_fail(b->r, "link: %s%s", why, "");
    b->plant.link = b->bus.faults;
    b->plant.scene.app.hal = &b->bus.hal;
    return verdict_begin_record(b->s, b->r, &b->bus, &b->record);
}

/* ---- the run ---- */

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
    b->link.malformed = (double)b->bus.udp.malformed + (double)b->bus.memory.malformed;
    bench_plant_frame(&b->plant, &b->link);
    b->frames++;
}

/* One bus frame; false when the run is over, with an error or without. */
static bool turn(struct bench *b)
{
    char why[REASON], reason[REASON], output[CHILD_REASON];
    if (!bench_plant_act(&b->plant, reason))
        return controller_fail(b->r, "%s%s", reason, "");
    switch (lockstep_await(&b->lockstep, false, why)) {
    case LOCKSTEP_SILENT:
        child_describe_output(&b->controller.child, output);
        return controller_fail(b->r, "%s%s", why, output);
    case LOCKSTEP_WAITS:
        child_listen(&b->controller.child);
        return !controller_has_ended(&b->controller, b->c, plant_time(&b->plant.scene.app.plant),
                                     b->link.stopped_s >= 0.0, b->r);
    default:
        one_frame(b);
        if (b->frames % LOOK_FRAMES == 0)
            (void)child_look(&b->controller.child);
        return b->plant.scene.app.plant.now.tick < b->end_tick;
    }
}

static void run(struct bench *b)
{
    const struct app_config *c = &b->plant.scene.config;
    uint64_t frames = ticks_begun(b->c->over_s, c->frame_s),
             limit = BENCH_SLOWER * frames + (uint64_t)(BENCH_START_S / c->frame_s);
    b->end_tick = frames * c->substeps;
    b->link.stopped_s = -1.0;
    while (b->frames < limit && turn(b))
        ;
    if (b->r->verdict != VERDICT_ERROR && b->plant.scene.app.plant.now.tick < b->end_tick)
        controller_explain_stand(b->c, bench_plant_state(&b->plant), plant_time(&b->plant.scene.app.plant),
                                 b->link.stopped_s >= 0.0, b->r);
}

/* The plant goes on, unrecorded and unjudged, so that a controller can end its session. */
static void let_go(struct bench *b)
{
    char why[BUS_REASON];
    double end_s = clock_now_s() + grace_s;
    child_ask(&b->controller.child);
    while (child_group_runs(&b->controller.child) && clock_now_s() < end_s)
        if (lockstep_await(&b->lockstep, false, why) == LOCKSTEP_BEGINS)
            app_frame(&b->plant.scene.app);
    controller_end(&b->controller, b->r);
}

void bench_run(const struct bench_setting *s, struct bench_result *r)
{
    static struct bench b; /* large: not on the stack */
    char why[REASON];
    memset(&b, 0, sizeof b);
    b.record.file = -1;
    b.s = s;
    b.r = r;
    b.c = &s->test->cases[r->i_case];
    b.plant.seed = r->seed;
    double begin_s = clock_now_s();
    if (!bench_plant_open(&b.plant, s->test, b.c, r->varied ? &r->varied_value : NULL, why))
        controller_fail(r, "%s%s", why, "");
    else if (open_bus(&b) && controller_start(&b.controller, s, &b.plant.scene, &b.at, r))
        run(&b);
    verdict_end_record(s, r, &b.bus);
    b.plant.scene.app.hal = &b.bus.hal;
    r->plant_s = plant_time(&b.plant.scene.app.plant);
    r->took_s = clock_now_s() - begin_s;
    bench_plant_judge(&b.plant, b.c, r);
    verdict_compare(s, &b.plant.scene, b.record.path, 0, false, r);
    let_go(&b);
    bus_close(&b.bus);
    if (b.record.file >= 0)
        close(b.record.file);
    bench_plant_close(&b.plant);
}
