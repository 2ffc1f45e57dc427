/* demo_link.c - the controller's end of the bus: one turn of its loop, the session, the status line, getting started. */
#include "firmware/observe/capture.h"
#include "host_sim/cli/clock.h"
#include "host_sim/demo/demo.h"
#include "host_sim/live/explain.h"
#include "models/hertz_rig.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Longer than a desktop keeps a process waiting, short enough to be seen. The plant's default is 100. */
enum { TIMEOUT_FRAMES = 300 };

static const double poll_pause_s = 200e-6;
static const double silence_limit_s = 2.0; /* of the plant */
static const double answer_limit_s = 3.0;

bool demo_fail(struct demo *d, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(d->why, sizeof d->why, format, arguments);
    va_end(arguments);
    return false;
}

static void hear(void *context, const struct frame *f, const struct message *m)
{
    struct demo *d = context;
    (void)f;
    demo_record_hear(&d->record, &d->client.latest, m);
    if (m->kind == WIRE_REPLY && m->value[REPLY_MESSAGE] < WIRE_KINDS)
        d->answer[(int)m->value[REPLY_MESSAGE]] = (int)m->value[REPLY_CAUSE];
}

static void note_time(struct demo *d)
{
    const struct latest *l = &d->client.latest;
    double substeps = l->info[INFO_SUBSTEPS];
    if (isnan(substeps) || isnan(l->info[INFO_FRAME_RATE_HZ]))
        return;
    d->record.tick_s = 1.0 / (substeps * l->info[INFO_FRAME_RATE_HZ]);
    d->t_s = (double)l->tick * d->record.tick_s;
    d->plant_frame = l->tick / (uint64_t)substeps;
}

static void heartbeat(struct demo *d)
{
    const struct latest *l = &d->client.latest;
    if (d->record.phase == DEMO_SILENT || l->frame < d->record.heartbeat_frame + DEMO_ROW_FRAMES)
        return;
    client_enable(&d->client, true);
    d->record.heartbeat_frame = l->frame;
}

/* ---- status line ---- */

static void show(struct demo *d)
{
    double now = clock_now_s();
    const struct demo_record *r = &d->record;
    if (r->n_rows == 0 || now - d->shown_s < (d->tty ? 0.1 : 0.5))
        return;
    const struct demo_row *row = &r->row[r->n_rows - 1];
    d->shown_s = now;
    printf("%s%-10s t %6.2f s | displacement %6.2f .. %5.2f um | drive %4.2f N | control %5.1f N | contact "
           "loss %4.1f %% | "
           "age %3.0f frames | overruns %.0f%s",
           d->tty ? "\r" : "", demo_phase_name[r->phase], row->t_s, 1e6 * row->displacement_min,
           1e6 * row->displacement_max, row->drive_N, isnan(row->command_N) ? 0.0 : row->command_N,
           100.0 * row->loss, row->age_frames, fmax(d->client.latest.health[DIAG_OVERRUNS], 0.0),
           d->tty ? "\033[K" : "\n");
    fflush(stdout);
}

/* ---- one turn of the loop ---- */

static enum demo_turn lost_plant(struct demo *d)
{
    if (!demo_child_runs(&d->child))
        demo_fail(d, "the plant ended by itself");
    else
        demo_fail(d, "nothing was heard of the plant for %.0f s", silence_limit_s);
    return DEMO_ENDED;
}

enum demo_turn demo_turn(struct demo *d)
{
    double now = clock_now_s();
    d->stall_s = fmax(d->stall_s, now - d->turn_s);
    d->turn_s = now;
    if (clock_interrupted())
        return DEMO_ENDED;
    client_poll(&d->client);
    if (d->client.latest.count[WIRE_SYNC] == d->n_syncs) {
        if (now - d->heard_s > silence_limit_s)
            return lost_plant(d);
        clock_sleep_s(poll_pause_s);
        return DEMO_IDLE;
    }
    d->n_syncs = d->client.latest.count[WIRE_SYNC];
    d->heard_s = now;
    note_time(d);
    heartbeat(d);
    show(d);
    return DEMO_FRAME;
}

/* Turns until done() or the time is over: then why says what was missing. */
static bool until(struct demo *d, bool (*done)(const struct demo *d), const char *missing)
{
    double end = clock_now_s() + answer_limit_s;
    while (!done(d)) {
        if (demo_turn(d) == DEMO_ENDED)
            return false;
        if (clock_now_s() > end)
            return demo_fail(d, "%s within %.0f s; the machine may be too busy", missing, answer_limit_s);
    }
    return true;
}

/* ---- getting started ---- */

static bool is_ready(const struct demo *d)
{
    return d->client.latest.state == STATE_READY;
}

static bool is_configured(const struct demo *d)
{
    return d->answer[WIRE_PARAM_COMMIT] >= 0;
}

static bool is_known(const struct demo *d)
{
    return !isnan(d->record.tick_s) && !isnan(d->client.latest.info[INFO_F0_BUS_HZ]);
}

bool demo_is_running(const struct demo *d)
{
    return d->client.latest.state == STATE_RUNNING;
}

/* Faster reports than a 1 Mbit/s bus would carry, and a burst at the next lift-off after it is armed. */
static bool configure(struct demo *d)
{
    static const struct {
        enum setting setting;
        double value;
    } want[] = {
        {SET_STATUS_EVERY, 1.0},
        {SET_HEALTH_EVERY, 1.0},
        {SET_ECHO_EVERY, 1.0},
        {SET_SUMMARY_EVERY, DEMO_ROW_FRAMES},
        {SET_STREAM_LINEAR + RIG_FORCE, 1.0},
        {SET_TIMEOUT_FRAMES, TIMEOUT_FRAMES},
        {SET_REACTION, REACTION_RAMP},
        {SET_REACTION_RAMP_S, 1e-3 * DEMO_REACTION_RAMP_MS},
        {SET_CAPTURE_EVERY_TICKS, 1.0},
        {SET_CAPTURE_SAMPLES, DEMO_BURST},
        {SET_CAPTURE_PRETRIGGER, DEMO_BURST_BEFORE},
        {SET_CAPTURE_TRIGGER, TRIGGER_LIFTOFF},
        {SET_CAPTURE_PER_FRAME, 16.0},
    };
    enum { N = sizeof want / sizeof want[0] };
    unsigned index[N];
    double value[N];
    for (int i = 0; i < N; i++) {
        index[i] = SETTING_FIRST + want[i].setting;
        value[i] = want[i].value;
    }
    client_set(&d->client, N, index, value, COMMIT_NOW);
    if (!until(d, is_configured, "no answer to the settings"))
        return false;
    return d->answer[WIRE_PARAM_COMMIT] == CAUSE_OK ||
           demo_fail(d, "the plant refused the settings of the demonstration");
}

bool demo_begin(struct demo *d)
{
    d->client.heard = hear;
    d->client.heard_context = d;
    memset(d->answer, -1, sizeof d->answer);
    if (!client_open(&d->client, false, answer_limit_s) && !clock_interrupted()) {
        char why[EXPLAIN_REASON];
        explain_no_session(&d->client, why);
        return demo_fail(d, "%s", why);
    }
    d->heard_s = d->turn_s = clock_now_s();
    d->stall_s = 0.0;
    if (!until(d, is_ready, "the plant did not become ready") || !configure(d) ||
        !until(d, is_known, "the plant did not tell its frame rate and resonance"))
        return false;
    client_control(&d->client, CONTROL_START, d->client.latest.frame);
    return until(d, demo_is_running, "the plant did not start");
}
