/* demo_script.c - see demo_script.h. */
#include "host_sim/demo/demo_script.h"
#include "firmware/observe/capture.h"
#include "host_sim/cli/clock.h"
#include "host_sim/live/explain.h"
#include "models/hertz_rig.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

enum {
    TIMEOUT_FRAMES =
        300, /* longer than a desktop keeps a process waiting, short enough to be seen; the default is 100 */
    STREAM_LEAD = 5, /* frames between a sample's sending and its use: what a busy host may be late */
    STREAM_BURST = 16,
    FIRE_LEAD = 50, /* frames */
    FIRE_TRIES = 5,
    LOSS_ROWS = 5 /* rows with contact loss until it counts as lost for good */
};
static const double poll_pause_s = 200e-6;
static const double silence_limit_s = 2.0; /* longest silence of the plant */
static const double answer_limit_s = 3.0;

/* The controller, in units of the preload and the static compression. */
static const double set_point = 0.5; /* minimum penetration over the last DEMO_RECENT frames */
static const double gain = 0.15, gain_per_s = 2.3, command_max = 0.95;

/* False, with the reason in why. */
static bool fail(struct demo *d, enum demo_end end, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static bool fail(struct demo *d, enum demo_end end, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(d->why, sizeof d->why, format, arguments);
    va_end(arguments);
    d->end = clock_interrupted() ? DEMO_INTERRUPTED : end;
    return false;
}

/* ---- one turn of the loop: hear, show, keep the session alive, control ---- */

static void hear(void *context, const struct frame *f, const struct message *m)
{
    struct demo *d = context;
    (void)f;
    demo_record_take(&d->record, &d->client.latest, m);
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

static void show(struct demo *d)
{
    double now = clock_now_s();
    const struct demo_record *r = &d->record;
    char age[16] = "-";
    int i = r->n_rows - 1;
    if (i < 0 || now - d->shown_s < (d->tty ? 0.1 : 0.5))
        return;
    d->shown_s = now;
    if (!isnan(r->column[DEMO_AGE][i]))
        snprintf(age, sizeof age, "%.0f", r->column[DEMO_AGE][i]);
    printf("%s%-10s t %6.2f s | displacement %6.2f .. %5.2f µm | drive %4.2f N | control %5.1f N | contact "
           "loss %4.1f %% | age %3s frames | overruns %.0f%s",
           d->tty ? "\r" : "", demo_phase_name[r->phase], r->column[DEMO_TIME][i],
           1e6 * r->column[DEMO_DISPLACEMENT][i], 1e6 * r->column[DEMO_DISPLACEMENT + 1][i],
           r->column[DEMO_SLOW_N][i], isnan(r->column[DEMO_COMMAND][i]) ? 0.0 : r->column[DEMO_COMMAND][i],
           100.0 * r->column[DEMO_LOSS][i], age, fmax(d->client.latest.health[DIAG_OVERRUNS], 0.0),
           d->tty ? "\033[K" : "\n");
    fflush(stdout);
}

/* Proportional and integral, without wind-up: pushes as hard as it must, and never pulls. */
static double controller(struct demo *d)
{
    double min, max, limit = command_max * d->record.rest_N;
    demo_recent_range(&d->record.penetration, &min, &max);
    double error = (set_point - min / d->record.rest_m) * d->record.rest_N;
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

/* Only silence may make the plant react, and nothing may stop it. */
static bool is_well(struct demo *d)
{
    const struct latest *l = &d->client.latest;
    if (!d->started || d->record.phase == DEMO_SILENT)
        return true;
    if (l->reaction != REACTION_NONE)
        return fail(d, DEMO_BUSY,
                    "the plant missed the controller's heartbeats: this process was kept waiting for %.0f ms "
                    "by a busy machine",
                    1e3 * d->stall_s);
    return l->state == STATE_RUNNING ||
           fail(d, DEMO_FAILED, "the plant left its running state (fault bits 0x%02X)", l->faults);
}

/* False: the plant is gone or not well, or the user interrupts. */
static bool turn(struct demo *d)
{
    double now = clock_now_s();
    d->stall_s = fmax(d->stall_s, now - d->turn_s);
    d->turn_s = now;
    if (clock_interrupted())
        return fail(d, DEMO_INTERRUPTED, "interrupted");
    client_poll(&d->client);
    if (d->client.latest.count[WIRE_SYNC] == d->n_syncs) {
        if (now - d->heard_s > silence_limit_s && !child_look(&d->child))
            return fail(d, DEMO_FAILED, "the plant ended by itself");
        if (now - d->heard_s > silence_limit_s)
            return fail(d, DEMO_FAILED, "nothing was heard of the plant for %.0f s", silence_limit_s);
        clock_sleep_s(poll_pause_s);
        return is_well(d);
    }
    d->n_syncs = d->client.latest.count[WIRE_SYNC];
    d->heard_s = now;
    note_time(d);
    heartbeat(d);
    show(d);
    if (!is_well(d))
        return false;
    if (d->record.phase == DEMO_CONTROL || d->record.phase == DEMO_FAST)
        control(d);
    return true;
}

/* Turns until done() or until these seconds have passed here. False: it ended before. */
static bool turn_until(struct demo *d, bool (*done)(const struct demo *), double seconds)
{
    for (double end = clock_now_s() + seconds; !done(d) && clock_now_s() < end;)
        if (!turn(d))
            return false;
    return true;
}

static bool await(struct demo *d, bool (*done)(const struct demo *), const char *missing)
{
    return turn_until(d, done, answer_limit_s) &&
           (done(d) ||
            fail(d, DEMO_FAILED, "%s within %.0f s; the machine may be too busy", missing, answer_limit_s));
}

/* ---- what a step waits for ---- */

static bool is_over(const struct demo *d)
{
    return d->t_s >= d->until_s;
}

static bool is_known(const struct demo *d)
{
    return !isnan(d->record.tick_s) && !isnan(d->client.latest.info[INFO_F0_BUS_HZ]);
}

static bool is_answered(const struct demo *d)
{
    return d->client.reply.came;
}

static bool has_lost_rows(const struct demo *d)
{
    const struct demo_record *r = &d->record;
    int n = 0;
    for (int i = r->n_rows - LOSS_ROWS; i >= 0 && i < r->n_rows; i++)
        n += r->column[DEMO_LOSS][i] > 0.0;
    return n == LOSS_ROWS && !isnan(r->first_loss_N);
}

static bool is_lost(const struct demo *d)
{
    return has_lost_rows(d) || is_over(d);
}

static bool is_read(const struct demo *d)
{
    return demo_burst_complete(&d->record) || is_over(d);
}

/* ---- steps ---- */

struct step {
    enum demo_phase phase;
    bool (*act)(struct demo *d, const struct step *s);
    double until_s;   /* plant time at which it ends, or begins to be true; below 0: after so long */
    const char *what; /* when it fails: this could not be had */
    /* a drive: its amplitude in these units, its frequency over the resonance (0: as it is), and its ramp */
    int channel;
    double amplitude;
    double (*unit)(const struct demo *d);
    double ratio, ramp_s;
};

/* Lets plant time pass. */
static bool pass(struct demo *d, const struct step *s)
{
    (void)s;
    return turn_until(d, is_over, 2.0 * fmax(d->until_s - d->t_s, 0.0) + answer_limit_s);
}

static bool open_session(struct demo *d, const struct step *s)
{
    char why[EXPLAIN_REASON];
    (void)s;
    if (!client_open(&d->client, false, answer_limit_s)) {
        explain_no_session(&d->client, why);
        return fail(d, DEMO_FAILED, "%s", why);
    }
    d->heard_s = d->turn_s = clock_now_s();
    return client_wait_state(&d->client, STATE_READY, answer_limit_s) ||
           fail(d, DEMO_FAILED, "the plant did not become ready");
}

/* Faster reports than a 1 Mbit/s bus would carry, and a burst at the next lift-off after it is armed. */
static bool configure(struct demo *d, const struct step *s)
{
    static const double want[][2] = {{SET_STATUS_EVERY, 1.0},
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
                                     {SET_CAPTURE_PER_FRAME, 16.0}};
    enum { N = sizeof want / sizeof want[0] };
    unsigned index[N];
    double value[N];
    for (int i = 0; i < N; i++) {
        index[i] = SETTING_FIRST + (unsigned)want[i][0];
        value[i] = want[i][1];
    }
    (void)s;
    client_expect(&d->client, WIRE_PARAM_COMMIT);
    client_set(&d->client, N, index, value, COMMIT_NOW);
    if (!await(d, is_answered, "no answer to the settings"))
        return false;
    return d->client.reply.cause == CAUSE_OK ||
           fail(d, DEMO_FAILED, "the plant refused the settings of the demonstration");
}

static bool start(struct demo *d, const struct step *s)
{
    (void)s;
    if (!await(d, is_known, "the plant did not tell its frame rate and resonance"))
        return false;
    client_control(&d->client, CONTROL_START, d->client.latest.frame);
    d->started = client_wait_state(&d->client, STATE_RUNNING, answer_limit_s);
    return d->started || fail(d, DEMO_FAILED, "the plant did not start");
}

/* The plant at rest, measured. */
static bool measure(struct demo *d, const struct step *s)
{
    double min, max;
    if (!pass(d, s))
        return false;
    demo_recent_range(&d->record.penetration, &min, &max);
    d->record.rest_m = 0.5 * (min + max);
    demo_recent_range(&d->record.force, &min, &max);
    d->record.rest_N = 0.5 * (min + max);
    return true;
}

static double preload_N(const struct demo *d)
{
    return d->record.rest_N;
}

static double lost_N(const struct demo *d)
{
    return d->record.first_loss_N;
}

static double compression_m(const struct demo *d)
{
    return d->record.rest_m;
}

/* Fires one drive at its time or soon, again when refused or not answered; from then on the record has its
 * ramp. */
static bool fire(struct demo *d, const struct step *s)
{
    struct demo_ramp *ramp = s->channel == RIG_BASE ? &d->record.base : &d->record.slow;
    double amplitude = s->amplitude * s->unit(d), substeps = d->client.latest.info[INFO_SUBSTEPS],
           Hz = s->ratio > 0.0 ? s->ratio * d->client.latest.info[INFO_F0_BUS_HZ] : (double)NAN;
    for (int i = 0; i < FIRE_TRIES; i++) {
        double soon_s = (double)(d->plant_frame + FIRE_LEAD) * substeps * d->record.tick_s;
        struct demo_ramp fired = {0.0, amplitude, fmax(d->until_s, soon_s), s->ramp_s};
        fired.from = demo_ramp_at(ramp, fired.begin_s);
        client_expect(&d->client, WIRE_FIRE);
        client_arm(&d->client, s->channel, amplitude, Hz, 0.0, s->ramp_s);
        client_fire(&d->client, 1u << s->channel, false, (uint64_t)llround(fired.begin_s / d->record.tick_s),
                    0.0);
        if (!turn_until(d, is_answered, 0.2))
            return false;
        if (is_answered(d) && d->client.reply.cause == CAUSE_OK) {
            *ramp = fired;
            return true;
        }
    }
    return fail(d, DEMO_FAILED, "%s could not be fired: refused each time", s->what);
}

static bool lose(struct demo *d, const struct step *s)
{
    return turn_until(d, is_lost, 2.0 * d->until_s) &&
           (has_lost_rows(d) ||
            fail(d, DEMO_FAILED, "%s of %.2f N", s->what, demo_ramp_at(&d->record.slow, d->t_s)));
}

static bool arm_burst(struct demo *d, const struct step *s)
{
    client_capture(&d->client, CAPTURE_ARM, 0, 0);
    return pass(d, s);
}

/* Reads the burst out, again while values are missing. */
static bool read_burst(struct demo *d, const struct step *s)
{
    const double again_s = 0.4;
    (void)s;
    while (!is_read(d)) {
        client_capture(&d->client, CAPTURE_READ, 0, DEMO_BURST);
        if (!turn_until(d, is_read, again_s))
            return false;
    }
    return true;
}

static bool fall_silent(struct demo *d, const struct step *s)
{
    d->record.command_N = (double)NAN;
    return pass(d, s) && (d->record.reaction_frame || fail(d, DEMO_FAILED, "%s", s->what));
}

/* Why these values: a drive 3.5 % below the resonance meets the softening of the contact. It jumps into
 * contact loss at some 4 % of the preload, so the ramp to 8 % stops there. At 15 % the motion settles. A
 * static force of about two thirds of the preload lifts the resonance far enough away for the motion to
 * fall back. The fast base then tips it over once more. */
static const struct step script[] = {
    {DEMO_REST, open_session, .until_s = 0.0},
    {DEMO_REST, configure, .until_s = 0.0},
    {DEMO_REST, start, .until_s = 0.0},
    {DEMO_REST, measure, .until_s = 0.5},
    {DEMO_REST, fire, 0.7, "the slow drive", RIG_FORCE, 0.08, preload_N, 0.965, 5.0},
    {DEMO_REST, pass, .until_s = 0.7},
    {DEMO_DRIVE, lose, .until_s = 4.0, .what = "contact was not lost under a slow drive"},
    {DEMO_DRIVE, fire, 0.0, "the slow drive", RIG_FORCE, 1.15, lost_N, 0.0, 0.1},
    {DEMO_DRIVE, pass, .until_s = -0.25},
    {DEMO_DRIVE, arm_burst, .until_s = -0.05},
    {DEMO_DRIVE, read_burst, .until_s = 4.0},
    {DEMO_DRIVE, pass, .until_s = 4.0},
    {DEMO_CONTROL, pass, .until_s = 6.5},
    {DEMO_FAST, fire, 0.0, "the fast base drive", RIG_BASE, 0.8, compression_m, 8.0, 0.2},
    {DEMO_FAST, pass, .until_s = 8.5},
    {DEMO_SILENT, fall_silent, .until_s = 10.0,
     .what = "the plant did not react to the controller's silence"},
};

void demo_converse(struct demo *d)
{
    d->client.heard = hear;
    d->client.heard_context = d;
    for (int i = 0; i < (int)(sizeof script / sizeof script[0]) && d->end == DEMO_DONE; i++) {
        const struct step *s = &script[i];
        d->record.phase = s->phase;
        d->until_s = s->until_s < 0.0 ? d->t_s - s->until_s : s->until_s;
        if (!s->act(d, s) && d->end == DEMO_DONE)
            fail(d, DEMO_FAILED, "the demonstration ended in step %d", i + 1);
    }
}
