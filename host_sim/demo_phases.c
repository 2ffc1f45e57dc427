/* demo_phases.c - the controller's side of the demonstration: enable, drive, keep contact, disturb, fall silent. */
#include "host_sim/demo.h"
#include "host_sim/clock.h"
#include "models/hertz_rig.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Plant time at which each phase ends. */
static const double phase_end_s[DEMO_PHASES] = {0.7, 4.0, 6.5, 8.5, 10.0};

/* Why these values: a drive 3.5 % below the resonance meets the contact's softening and jumps into contact loss at
 * some 4 % of the preload; 15 % more settles there, and about two thirds of the preload as static force lifts the
 * resonance far enough away to fall back. The fast base then takes most of the static compression as amplitude. */
static const double slow_ratio = 0.965; /* drive over contact resonance */
static const double slow_max = 0.08;    /* of the preload: end of the ramp, which stops where contact is lost */
static const double slow_ramp_s = 5.0;
static const double slow_excess = 1.15; /* over the amplitude at which contact was lost */
static const double fast_ratio = 8.0;
static const double fast_base = 0.83; /* of the static compression */
static const double fast_ramp_s = 0.2;

/* The controller, in units of the preload and the static compression. */
static const double set_point = 0.5; /* minimum penetration over the last DEMO_RECENT frames */
static const double gain = 0.3;
static const double gain_per_s = 3.0;
static const double command_max = 0.95;

enum {
    STREAM_LEAD = 5, /* frames between a sample's sending and its use: what a busy host may be late */
    STREAM_BURST = 16,
    FIRE_LEAD = 50, /* frames */
    FIRE_TRIES = 5,
    LOSS_ROWS = 5 /* rows with contact loss until it counts as lost for good */
};

static const double poll_pause_s = 200e-6;
static const double silence_limit_s = 2.0; /* of the plant */
static const double answer_limit_s = 3.0;

static bool fail(struct demo *d, const char *format, ...) __attribute__((format(printf, 2, 3)));
static bool fail(struct demo *d, const char *format, ...)
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
    printf("%s%-10s t %6.2f s | displacement %6.2f .. %5.2f um | drive %4.2f N | control %5.1f N | contact loss %4.1f %% | "
           "age %3.0f frames | overruns %.0f%s",
           d->tty ? "\r" : "", demo_phase_name[r->phase], row->t_s, 1e6 * row->displacement_min,
           1e6 * row->displacement_max, row->drive_N, isnan(row->command_N) ? 0.0 : row->command_N, 100.0 * row->loss,
           row->age_frames, d->client.latest.health[DIAG_OVERRUNS], d->tty ? "\033[K" : "\n");
    fflush(stdout);
}

/* ---- one turn of the loop ---- */

enum turn { TURN_IDLE, TURN_FRAME, TURN_ENDED };

static enum turn lost_plant(struct demo *d)
{
    if (!demo_child_runs(&d->child))
        fail(d, "the plant ended by itself; its own words are in plant.txt");
    else
        fail(d, "nothing was heard of the plant for %.0f s; its own words are in plant.txt", silence_limit_s);
    return TURN_ENDED;
}

/* Hears what has arrived and keeps the session alive; sleeps a little when there was nothing. */
static enum turn turn(struct demo *d)
{
    double now = clock_now_s();
    d->stall_s = fmax(d->stall_s, now - d->turn_s);
    d->turn_s = now;
    if (clock_interrupted())
        return TURN_ENDED;
    client_poll(&d->client);
    if (d->client.latest.count[WIRE_SYNC] == d->n_syncs) {
        if (now - d->heard_s > silence_limit_s)
            return lost_plant(d);
        clock_sleep_s(poll_pause_s);
        return TURN_IDLE;
    }
    d->n_syncs = d->client.latest.count[WIRE_SYNC];
    d->heard_s = now;
    note_time(d);
    heartbeat(d);
    show(d);
    return TURN_FRAME;
}

/* Turns until done() or the time is over: then why says what was missing. */
static bool until(struct demo *d, bool (*done)(const struct demo *d), const char *missing)
{
    double end = clock_now_s() + answer_limit_s;
    while (!done(d)) {
        if (turn(d) == TURN_ENDED)
            return false;
        if (clock_now_s() > end)
            return fail(d, "%s within %.0f s; the machine may be too busy, or see plant.txt", missing, answer_limit_s);
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

static bool is_running(const struct demo *d)
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
    return d->answer[WIRE_PARAM_COMMIT] == CAUSE_OK || fail(d, "the plant refused the settings of the demonstration");
}

static bool begin(struct demo *d)
{
    d->client.heard = hear;
    d->client.heard_context = d;
    memset(d->answer, -1, sizeof d->answer);
    d->heard_s = d->turn_s = clock_now_s();
    d->stall_s = 0.0;
    if (!until(d, is_ready, "the plant did not become ready") || !configure(d) ||
        !until(d, is_known, "the plant did not tell its frame rate and resonance"))
        return false;
    client_control(&d->client, CONTROL_START, d->client.latest.frame);
    return until(d, is_running, "the plant did not start");
}

/* ---- the script ---- */

static void next_step(struct demo *d)
{
    d->step++;
    d->step_s = d->t_s;
    d->n_fires = 0;
}

/* Fires one drive at `at_s` or soon, again when refused or not answered. True when it was accepted. */
static bool fire(struct demo *d, int channel, double amplitude, double frequency_Hz, double ramp_s, double at_s)
{
    const double wait_s = 0.2;
    bool accepted = d->n_fires > 0 && d->answer[WIRE_FIRE] == CAUSE_OK;
    bool waiting = d->n_fires > 0 && d->answer[WIRE_FIRE] < 0 && d->t_s < d->step_s + wait_s * d->n_fires;
    if (accepted || waiting || d->n_fires == FIRE_TRIES)
        return accepted;
    double soon_s = (double)(d->plant_frame + FIRE_LEAD) * d->client.latest.info[INFO_SUBSTEPS] * d->record.tick_s;
    d->n_fires++;
    d->answer[WIRE_FIRE] = -1;
    client_arm(&d->client, channel, amplitude, frequency_Hz, 0.0, ramp_s);
    client_fire(&d->client, 1u << channel, false, (uint64_t)llround(fmax(at_s, soon_s) / d->record.tick_s), 0.0);
    return false;
}

static double resonance_Hz(const struct demo *d)
{
    return d->client.latest.info[INFO_F0_BUS_HZ];
}

static void rest(struct demo *d)
{
    const double look_s = 0.5; /* the plant rested long enough to be measured */
    double min, max;
    if (d->step == 0 && d->t_s >= look_s) {
        demo_recent_range(&d->record.penetration, &min, &max);
        d->rest.penetration_m = 0.5 * (min + max);
        demo_recent_range(&d->record.force, &min, &max);
        d->rest.force_N = 0.5 * (min + max);
        next_step(d);
    }
    if (d->step == 1 && fire(d, RIG_FORCE, slow_max * d->rest.force_N, slow_ratio * resonance_Hz(d), slow_ramp_s,
                             phase_end_s[DEMO_REST]))
        next_step(d);
}

static bool is_lost(const struct demo *d)
{
    const struct demo_record *r = &d->record;
    int n = 0;
    for (int i = r->n_rows - LOSS_ROWS; i >= 0 && i < r->n_rows; i++)
        n += r->row[i].loss > 0.0;
    return n == LOSS_ROWS && !isnan(r->first_loss_N);
}

/* Reads the burst out, again while values are missing. */
static void read_burst(struct demo *d)
{
    const double again_s = 0.4;
    if (demo_burst_complete(&d->record) || d->t_s < d->step_s)
        return;
    client_capture(&d->client, CAPTURE_READ, 0, DEMO_BURST);
    d->step_s = d->t_s + again_s;
}

static void slow_drive(struct demo *d)
{
    const double settle_s = 0.25, burst_s = 0.05;
    if (d->step == 0 && is_lost(d))
        next_step(d);
    if (d->step == 1 && fire(d, RIG_FORCE, slow_excess * d->record.first_loss_N, (double)NAN, 0.1, 0.0))
        next_step(d);
    if (d->step == 2 && d->t_s >= d->step_s + settle_s) {
        client_capture(&d->client, CAPTURE_ARM, 0, 0);
        next_step(d);
        d->step_s = d->t_s + burst_s;
    }
    if (d->step == 3)
        read_burst(d);
}

/* Proportional and integral, without wind-up: pushes as hard as it must, and never pulls. */
static double controller(struct demo *d)
{
    double min, max, limit = command_max * d->rest.force_N;
    demo_recent_range(&d->record.penetration, &min, &max);
    double error = (set_point - min / d->rest.penetration_m) * d->rest.force_N;
    double frame_s = 1.0 / d->client.latest.info[INFO_FRAME_RATE_HZ];
    d->integral_N = fmin(fmax(d->integral_N + gain_per_s * error * frame_s, 0.0), limit);
    return fmin(fmax(d->integral_N + gain * error, 0.0), limit);
}

/* One sample for each frame that has none yet, up to STREAM_LEAD ahead. */
static void control(struct demo *d)
{
    uint64_t last = d->plant_frame + STREAM_LEAD, first = d->streamed + 1;
    if (first < d->plant_frame + 2)
        first = d->plant_frame + 2;
    for (int i = 0; i < STREAM_BURST && first <= last; i++, first++) {
        d->record.command_N = controller(d);
        client_stream(&d->client, RIG_FORCE, first, d->record.command_N);
        d->streamed = first;
    }
    d->stream_missed = d->client.latest.health[DIAG_STREAM_MISSED];
}

static void fast_drive(struct demo *d)
{
    control(d);
    if (d->step == 0 && fire(d, RIG_BASE, fast_base * d->rest.penetration_m, fast_ratio * resonance_Hz(d), fast_ramp_s,
                             0.0))
        next_step(d);
}

static void (*const act[DEMO_PHASES])(struct demo *d) = {rest, slow_drive, control, fast_drive, NULL};

/* ---- phases ---- */

/* What must be true when a phase ends. */
static bool check_phase(struct demo *d)
{
    const struct latest *l = &d->client.latest;
    bool refused = d->n_fires == FIRE_TRIES;
    switch (d->record.phase) {
    case DEMO_REST:
        return d->step == 2 || fail(d, "the slow drive could not be fired%s", refused ? ": refused each time" : "");
    case DEMO_DRIVE:
        return d->step >= 2 || fail(d, "contact was not lost under a slow drive of %.2f N", l->drive[RIG_FORCE][0]);
    case DEMO_FAST:
        return d->step == 1 || fail(d, "the fast base drive could not be fired%s", refused ? ": refused each time" : "");
    case DEMO_SILENT:
        return d->record.reaction_frame || fail(d, "the plant did not react to the controller's silence");
    default:
        return true;
    }
}

static enum demo_end run_phase(struct demo *d)
{
    enum demo_phase phase = d->record.phase;
    while (d->t_s < phase_end_s[phase]) {
        enum turn now = turn(d);
        if (now == TURN_ENDED)
            return clock_interrupted() ? DEMO_INTERRUPTED : DEMO_FAILED;
        if (phase != DEMO_SILENT && d->client.latest.reaction != REACTION_NONE) {
            fail(d, "the plant missed the controller's heartbeats: this process was kept waiting for %.0f ms by a busy "
                    "machine", 1e3 * d->stall_s);
            return DEMO_BUSY;
        }
        if (now == TURN_FRAME && act[phase])
            act[phase](d);
    }
    return check_phase(d) ? DEMO_DONE : DEMO_FAILED;
}

enum demo_end demo_converse(struct demo *d)
{
    enum demo_end end = DEMO_DONE;
    if (!begin(d))
        return clock_interrupted() ? DEMO_INTERRUPTED : DEMO_FAILED;
    for (int phase = 0; phase < DEMO_PHASES && end == DEMO_DONE; phase++) {
        d->record.phase = (enum demo_phase)phase;
        d->step = d->n_fires = 0;
        d->step_s = d->t_s;
        if (phase == DEMO_SILENT)
            d->record.command_N = (double)NAN;
        end = run_phase(d);
    }
    return end;
}
