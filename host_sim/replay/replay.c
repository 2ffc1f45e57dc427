/* replay.c - a recorded log through the plant again: the same commands in the same frames must give the
 * same bytes. */
#include "firmware/plant/plant_report.h"
#include "host_sim/replay/replay_source.h"
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/replay/decode_signals.h"
#include "host_sim/cli/options.h"
#include "host_sim/scene/scene.h"
#include "host_sim/cli/selftest.h"
#include "host_sim/out/plural.h"
#include "firmware/bus/diag.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const struct option replay_options[] = {
    {.name = "timed", .meaning = "run at the pace of the recording, not as fast as possible"},
    {.name = "promote", .meaning = "give it if the recorded run had it"},
    {.name = NULL},
};

static const struct usage replay_usage = {
    .name = "replay",
    .words = "LOG [SCENE]",
    .summary =
        "Runs the commands of a recorded log through the plant again and compares its messages with the\n"
        "recorded ones byte for byte (timing and self-test excluded). If they differ it names the first\n"
        "difference and exits with 1. Give the SCENE and options of the recorded run; give its --overrun\n"
        "policy as --setting overrun_policy=0 (catch_up), 1 (skip), 2 (freeze) or 3 (stop).",
    .words_help =
        "LOG is a log of contactplant run --log, or one that candump -L recorded on the bus. Start candump\n"
        "before the plant, and leave the setting sync_every at 1: the plant's SYNCs show its "
        "frames.\n" SCENE_WORDS_HELP,
    .examples = "  contactplant run --log run.log --duration 10 & contactplant control --duration 8\n"
                "  contactplant replay run.log\n"
                "  contactplant replay field.log --set preload_N=100 --rate 2000 --base-id 0x240\n",
    .min_words = 1,
    .words_read = 1,
    .max_words = 2,
    .table = {replay_options, decode_log_options, scene_options},
};

enum {
    DEFERRED_MAX = 256
}; /* commands of a log taken on the bus that are found one frame later than they stand */

struct again {
    const struct options *o;
    struct scene_app scene;
    struct replay replay;
    const char *difference;
    uint64_t frames;
    uint64_t deferred[DEFERRED_MAX]; /* their lines */
    uint32_t n_deferred;
};

/* Messages that depend on the machine and not on the plant. */
static bool is_timing(const struct message *m)
{
    if (m->kind != WIRE_HEALTH)
        return m->kind == WIRE_SELF_TEST;
    int item = (int)m->value[HEALTH_ITEM];
    return (item >= DIAG_COMPUTE_MAX_US && item <= DIAG_LATENESS_MAX_FRAME) || item == DIAG_LAST_RUN;
}

/* The frame that is loaded; where an overrun before it leads to another one, that: 1, 0 at the end, -1 bad
 * log. */
static int turn(struct again *g)
{
    struct app *a = &g->scene.app;
    (void)!app_overrun(a, g->replay.missed); /* the log says itself what was due */
    int got = a->frame != g->replay.frame ? replay_frame(&g->replay, a->frame) : 1;
    if (got <= 0)
        return got;
    app_frame(a);
    g->frames++;
    g->difference = replay_check(&g->replay);
    return g->difference == NULL;
}

static int run_all(struct again *g)
{
    bool timed = options_given(g->o, "timed");
    int64_t start = clock_now_ns();
    int got = 1;
    while (got > 0 && !clock_interrupted()) {
        uint64_t frame = g->scene.app.frame;
        if (timed)
            clock_sleep_until_ns(start + llround((double)frame * g->scene.config.frame_s * 1e9));
        got = replay_frame(&g->replay, frame);
        if (got > 0)
            got = turn(g);
    }
    return got;
}

static int report(const struct again *g, int got)
{
    const struct replay *r = &g->replay;
    if (got < 0)
        return options_failure(g->o->usage, "%s", r->reason);
    if (!r->compared && (r->passed_over || !g->difference))
        return options_failure(g->o->usage,
                               "nothing in the log is of this plant; see --base-id and --extended");
    if (g->difference)
        return options_failure(g->o->usage, "%s; plant tick %llu, %llu message%s %s equal before%s",
                               g->difference, (unsigned long long)g->scene.app.plant.now.tick,
                               (unsigned long long)r->compared, plural((double)r->compared),
                               r->compared == 1 ? "was" : "were",
                               g->o->n_words > 1 ? "" : "; if the recorded run had a SCENE, give it");
    printf("equal: %llu frame%s, %llu command%s, %llu message%s compared, %llu report%s on the machine "
           "excluded, "
           "%llu line%s of others passed over; hash %016llx\n",
           (unsigned long long)g->frames, plural((double)g->frames), (unsigned long long)r->commands,
           plural((double)r->commands), (unsigned long long)r->compared, plural((double)r->compared),
           (unsigned long long)r->excluded_lines, plural((double)r->excluded_lines),
           (unsigned long long)r->passed_over, plural((double)r->passed_over),
           (unsigned long long)plant_hash(&g->scene.app.plant));
    if (r->log.on_bus)
        printf("taken on the bus: %u commands reached it while the plant was in a frame already and count to "
               "the next\n",
               g->n_deferred);
    return STATUS_DONE;
}

/* From the plant's first frame to the log's end or the first difference: 0 with run_all's result, else an
 * exit status. */
static int attempt(struct again *g, int *got)
{
    int status = scene_open(&g->scene, g->o, 1, &g->replay.hal);
    if (status)
        return status;
    const char *reason = replay_open(&g->replay, g->o->word[0], options_text(g->o, "interface", 0),
                                     &g->scene.app.scene, g->scene.config.frame_s, is_timing);
    if (reason)
        return options_failure(g->o->usage, "%s", reason);
    struct selftest_result r;
    if (g->replay.log.marked && !selftest_of_host(&r))
        return options_failure(g->o->usage, "out of memory");
    if (g->replay.log.marked)
        app_take_selftest(&g->scene.app, &r);
    replay_defer(&g->replay, g->deferred, g->n_deferred);
    g->difference = NULL;
    g->frames = 0;
    *got = run_all(g);
    replay_close(&g->replay);
    return 0;
}

/* Once more with this command one frame later. True when that led beyond the difference of `frame`. */
static bool defer_helps(struct again *g, uint64_t line, uint64_t frame, int *got)
{
    scene_free(&g->scene);
    g->deferred[g->n_deferred++] = line;
    if (attempt(g, got))
        return false;
    if (*got >= 0 && (!g->difference || g->replay.frame > frame))
        return true;
    g->n_deferred--;
    return false;
}

/* A difference in a log taken on the bus may be a command that stands one frame too early: tries the last
 * doubtful ones. */
static bool resolve(struct again *g, int *got)
{
    const struct log_bus *b = &g->replay.bus;
    uint64_t doubtful[LOG_BUS_DOUBTFUL], frame = g->replay.frame;
    uint64_t n = b->n_doubtful < LOG_BUS_DOUBTFUL ? b->n_doubtful : LOG_BUS_DOUBTFUL;
    for (uint64_t i = 0; i < n; i++)
        doubtful[i] = b->doubtful[(b->n_doubtful - 1 - i) % LOG_BUS_DOUBTFUL];
    for (uint64_t i = 0; i < n && g->n_deferred < DEFERRED_MAX && !clock_interrupted(); i++)
        if (defer_helps(g, doubtful[i], frame, got))
            return true;
    if (n) { /* none did: the difference as it was */
        scene_free(&g->scene);
        attempt(g, got);
    }
    return false;
}

static int replay(struct again *g)
{
    int got;
    clock_catch_signals();
    int status = attempt(g, &got);
    while (!status && g->difference && g->replay.log.on_bus && resolve(g, &got))
        ;
    if (!status && got >= 0 && g->replay.compared)
        plant_log_tell(&g->replay.log, g->o->usage->name);
    return status ? status : report(g, got);
}

int cmd_replay(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &replay_usage, argc, argv, &status))
        return status;
    struct again *g = calloc(1, sizeof *g);
    if (!g)
        return options_failure(&replay_usage, "out of memory");
    g->o = &o;
    status = replay(g);
    scene_free(&g->scene);
    free(g);
    return status;
}
