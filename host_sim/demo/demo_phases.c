/* demo_phases.c - the controller's side of the demonstration: enable, drive, keep contact, disturb, fall silent. */
#include "host_sim/demo/demo.h"
#include "firmware/observe/capture.h"
#include "host_sim/cli/clock.h"
#include "models/hertz_rig.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Plant time at which each phase ends. */
static const double phase_end_s[DEMO_PHASES] = {0.7, 4.0, 6.5, 8.5, 10.0};

/* Why these values: a drive 3.5 % below the resonance meets the contact's softening and jumps into contact loss at
 * some 4 % of the preload; 15 % more settles there, and about two thirds of the preload as static force lifts the
 * resonance far enough away to fall back. The fast base then tips it over once more. */
static const double slow_ratio = 0.965; /* drive over contact resonance */
static const double slow_max = 0.08; /* of the preload: end of the ramp, which stops where contact is lost */
static const double slow_ramp_s = 5.0;
static const double slow_excess = 1.15; /* over the amplitude at which contact was lost */
static const double fast_ratio = 8.0;
static const double fast_base = 0.8; /* of the static compression */
static const double fast_ramp_s = 0.2;

/* The controller, in units of the preload and the static compression. */
static const double set_point = 0.5; /* minimum penetration over the last DEMO_RECENT frames */
static const double gain = 0.15;
static const double gain_per_s = 2.3;
static const double command_max = 0.95;

enum {
    STREAM_LEAD = 5, /* frames between a sample's sending and its use: what a busy host may be late */
    STREAM_BURST = 16,
    FIRE_LEAD = 50, /* frames */
    FIRE_TRIES = 5,
    LOSS_ROWS = 5 /* rows with contact loss until it counts as lost for good */
};

/* ---- the script ---- */

static void next_step(struct demo *d)
{
    d->step++;
    d->step_s = d->t_s;
    d->n_fires = 0;
}

/* Fires one drive at `at_s` or soon, again when refused or not answered. True when it was accepted: then *ramp is
 * what the drive does from now on. */
static bool fire(struct demo *d, int channel, double amplitude, double frequency_Hz, double ramp_s,
                 double at_s, struct demo_ramp *ramp)
{
    const double wait_s = 0.2;
    if (d->n_fires > 0 && d->answer[WIRE_FIRE] == CAUSE_OK) {
        *ramp = d->fired;
        return true;
    }
    bool waiting = d->n_fires > 0 && d->answer[WIRE_FIRE] < 0 && d->t_s < d->fire_s + wait_s;
    if (waiting || d->n_fires == FIRE_TRIES)
        return false;
    double soon_s =
        (double)(d->plant_frame + FIRE_LEAD) * d->client.latest.info[INFO_SUBSTEPS] * d->record.tick_s;
    double begin_s = fmax(at_s, soon_s);
    d->fired = (struct demo_ramp){demo_ramp_at(ramp, begin_s), amplitude, begin_s, ramp_s};
    d->fire_s = d->t_s;
    d->n_fires++;
    d->answer[WIRE_FIRE] = -1;
    client_arm(&d->client, channel, amplitude, frequency_Hz, 0.0, ramp_s);
    client_fire(&d->client, 1u << channel, false, (uint64_t)llround(begin_s / d->record.tick_s), 0.0);
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
    if (d->step == 1 && fire(d, RIG_FORCE, slow_max * d->rest.force_N, slow_ratio * resonance_Hz(d),
                             slow_ramp_s, phase_end_s[DEMO_REST], &d->record.drive))
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
    const double hold_ramp_s = 0.1, settle_s = 0.25, burst_s = 0.05;
    if (d->step == 0 && is_lost(d))
        next_step(d);
    if (d->step == 1 && fire(d, RIG_FORCE, slow_excess * d->record.first_loss_N, (double)NAN, hold_ramp_s,
                             0.0, &d->record.drive))
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
    if (d->step == 0 && fire(d, RIG_BASE, fast_base * d->rest.penetration_m, fast_ratio * resonance_Hz(d),
                             fast_ramp_s, 0.0, &d->record.base))
        next_step(d);
}

static void (*const act[DEMO_PHASES])(struct demo *d) = {rest, slow_drive, control, fast_drive, NULL};

/* ---- phases ---- */

/* What must be true when a phase ends. */
static bool check_phase(struct demo *d)
{
    bool refused = d->n_fires == FIRE_TRIES;
    switch (d->record.phase) {
    case DEMO_REST:
        return d->step == 2 ||
               demo_fail(d, "the slow drive could not be fired%s", refused ? ": refused each time" : "");
    case DEMO_DRIVE:
        return d->step >= 2 || demo_fail(d, "contact was not lost under a slow drive of %.2f N",
                                         demo_ramp_at(&d->record.drive, d->t_s));
    case DEMO_FAST:
        return d->step == 1 ||
               demo_fail(d, "the fast base drive could not be fired%s", refused ? ": refused each time" : "");
    case DEMO_SILENT:
        return d->record.reaction_frame ||
               demo_fail(d, "the plant did not react to the controller's silence");
    default:
        return true;
    }
}

static enum demo_end run_phase(struct demo *d)
{
    enum demo_phase phase = d->record.phase;
    while (d->t_s < phase_end_s[phase]) {
        enum demo_turn now = demo_turn(d);
        if (now == DEMO_ENDED)
            return clock_interrupted() ? DEMO_INTERRUPTED : DEMO_FAILED;
        if (phase != DEMO_SILENT && d->client.latest.reaction != REACTION_NONE) {
            demo_fail(
                d,
                "the plant missed the controller's heartbeats: this process was kept waiting for %.0f ms by "
                "a busy "
                "machine",
                1e3 * d->stall_s);
            return DEMO_BUSY;
        }
        if (phase != DEMO_SILENT && !demo_is_running(d)) {
            demo_fail(d, "the plant left its running state (fault bits 0x%02X)", d->client.latest.faults);
            return DEMO_FAILED;
        }
        if (now == DEMO_FRAME && act[phase])
            act[phase](d);
    }
    return check_phase(d) ? DEMO_DONE : DEMO_FAILED;
}

enum demo_end demo_converse(struct demo *d)
{
    enum demo_end end = DEMO_DONE;
    if (!demo_begin(d))
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
