/* control.c - a controller, to be copied: opens a session, starts the plant, shakes it near its resonance,
 * and keeps contact with a PI controller that streams a force. Its only ways to the plant are the messages of
 * firmware/bus/wire.h. */
#include "host_sim/cli/clock.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/cli/trouble.h"
#include "host_sim/commands.h"
#include "host_sim/live/explain.h"
#include "host_sim/live/lockstep.h"
#include "host_sim/live/remote.h"

#include <math.h>
#include <stdio.h>

enum { FORCE = 0 };                                /* input */
enum { HEARTBEAT = 10, LEAD = 2, FIRE_LEAD = 20 }; /* frames */

/* The penetration's mean and deviation are those of so long:
 * smooth, where the smallest sample of an aliased wave jumps. */
static const double memory_s = 0.02;
/* It presses fast and lets go slowly: near the resonance a fast release swings for ever. */
static const double press_per_s = 2.3, release_per_s = 0.5;
static const double plant_patience_s = 5.0; /* a plant that says nothing may wait for a processor */

static const struct option control_options[] = {
    {"duration", "S", "seconds of plant time (10)", OPTION_NUMBER, 0.1, 1e6, .initial = "10"},
    {"force", "N", "amplitude of the slow drive (1/20 of the preload); 0 leaves the drives alone",
     OPTION_NUMBER, 0.0, 1e6, .initial = NULL},
    {"frequency", "HZ", "frequency of the slow drive (0.965 of the resonance)", OPTION_NUMBER, 0.0, 1e6,
     .initial = NULL},
    {"keep", "SHARE", "smallest penetration to keep, as a share of the static one (0.5)", OPTION_NUMBER, 0.0,
     1.0, .initial = "0.5"},
    {.name = "lockstep",
     .meaning = "the plant waits for each sample: equal numbers on any machine. With contactplant run "
                "--lockstep it is faster than real time"},
    {"patience", "S", "with --lockstep: seconds that a plant may be silent (10; 0: for ever)", OPTION_NUMBER,
     0.0, 1e9, .initial = "10"},
    {.name = NULL},
};

static const struct usage control_usage = {
    .name = "control",
    .words = "[SCENE]",
    .summary =
        "A worked example of a controller. It enables and starts the plant, drives it near resonance and\n"
        "streams a force that keeps contact. Give the SCENE and options that contactplant run got.",
    .words_help = SCENE_WORDS_HELP,
    .examples =
        "  contactplant control --duration 5 --force 20 --frequency 200 --keep 0.5\n"
        "  contactplant control --lockstep --duration 60            beside contactplant run --lockstep\n"
        "  contactplant control --bus can:can0 --base-id 0x240\n",
    .max_words = 1,
    .table = {control_options, bus_options, scene_options},
};

/* Where the link may have lost a command, it is said again after so long, until plant_patience_s is over. */
static const double command_again_s = 0.005, start_again_s = 0.05;

/* The CONTACT of that tick; in lockstep it is asked for. */
static bool next_contact(struct client *c, uint64_t tick, bool lockstep)
{
    double wait_s = lockstep ? command_again_s : plant_patience_s;
    bool came = false;
    for (double waited_s = 0.0; !came && waited_s < plant_patience_s && client_in_session(c);
         waited_s += wait_s) {
        if (lockstep)
            client_control(c, CONTROL_STEP, 1);
        came = client_wait_contact(c, tick, wait_s);
    }
    return came;
}

/* Plant time runs, or in lockstep stands until it is asked for. */
static bool start_plant(struct client *c, bool lockstep)
{
    bool came = false;
    for (double waited_s = 0.0; !came && waited_s < plant_patience_s && !c->silent;
         waited_s += start_again_s) {
        client_control(c, lockstep ? CONTROL_PAUSE : CONTROL_START, c->latest.frame);
        came = client_wait_state(c, lockstep ? STATE_PAUSED : STATE_RUNNING, start_again_s);
        client_enable(c, true);
    }
    return came;
}

/* The loop itself, one sample a plant frame; in lockstep the plant waits for each. Ends early with the
 * session. Returns the last force. */
static double keep_contact(struct client *c, const struct scene_app *s, uint64_t frames, double keep,
                           bool lockstep)
{
    double preload_N = s->app.plant.scale.force_N, rest_m = s->app.plant.scale.length_m;
    double mean_m = 0.0, square_m2 = 0.0, force_N = 0.0; /* the penetration's */
    uint64_t last = c->latest.tick, end = last + frames * s->config.substeps;
    for (uint64_t n = 0; last < end && !clock_interrupted(); n++) {
        if (!next_contact(c, last + 1, lockstep) || !client_in_session(c))
            break;
        last = c->latest.contact_tick;
        double x = c->latest.penetration_m, share = fmax(1.0 / (double)(n + 1), s->config.frame_s / memory_s);
        mean_m += share * (x - mean_m);
        square_m2 += share * ((x - mean_m) * (x - mean_m) - square_m2);
        double error_N = preload_N * (keep - (mean_m - sqrt(2.0 * square_m2)) / rest_m);
        double rate_N_per_s = (error_N > 0.0 ? press_per_s : release_per_s) * error_N;
        force_N = fmax(0.0, fmin(force_N + rate_N_per_s * s->config.frame_s, preload_N)); /* never pulls */
        client_stream(c, FORCE, last / s->config.substeps + (lockstep ? 0 : LEAD), force_N);
        if (n % HEARTBEAT == 0)
            client_enable(c, true);
    }
    return force_N;
}

/* A plant in its fault state takes nothing but a reset. */
static int refuse(const struct options *o, const struct client *c, const char *why)
{
    char faults[TROUBLE_TEXT];
    trouble_note_faults(c->latest.faults, faults);
    if (c->latest.state != STATE_FAULT)
        return options_failure(o->usage, "%s", why);
    return options_failure(o->usage,
                           "the plant is in its state fault%s; contactplant send reset clears it, and "
                           "contactplant help --errors explains the names",
                           faults);
}

static int control(const struct options *o, struct client *c, const struct scene_app *s)
{
    char why[EXPLAIN_REASON];
    const struct scale *scale = &s->app.plant.scale; /* preload and static penetration */
    bool lockstep = options_given(o, "lockstep");
    double amplitude_N = options_given(o, "force") ? options_number(o, "force") : 0.05 * scale->force_N;
    double frequency_Hz =
        options_given(o, "frequency") ? options_number(o, "frequency") : 0.965 * scene_resonance_Hz(s);
    if (!client_open(c, false, plant_patience_s)) {
        explain_no_session(c, why);
        return options_failure(o->usage, "%s", why);
    }
    if (!start_plant(c, lockstep))
        return refuse(o, c, "the plant does not start; contactplant send reset clears a fault");
    if (amplitude_N > 0.0) {
        client_arm(c, FORCE, amplitude_N, frequency_Hz, 0.0, 1.0);
        client_fire(c, 1u << FORCE, false, c->latest.tick + (uint64_t)FIRE_LEAD * s->config.substeps, 0.0);
    }
    uint64_t frames = ticks_begun(options_number(o, "duration"), s->config.frame_s);
    double force_N = keep_contact(c, s, frames, options_number(o, "keep"), lockstep);
    printf("streamed force %.9g N, penetration %.9g m, contact loss %.3g, refused as late %llu\n", force_N,
           c->latest.penetration_m, c->latest.contact_loss, (unsigned long long)c->latest.reply[CAUSE_LATE]);
    bool lost = !client_in_session(c), stopped = c->latest.reaction == REACTION_STOP;
    client_control(c, CONTROL_STOP, 0); /* the plant takes it from anybody; it ends the session, too */
    if (!client_wait_state(c, STATE_STOPPED, plant_patience_s))
        return refuse(o, c, "the plant did not confirm the stop; send it again with contactplant send stop");
    if (lost)
        return options_failure(o->usage, "the plant ended the session: %s",
                               stopped ? "somebody stopped it"
                                       : "it heard no heartbeat for timeout_frames; raise that setting if "
                                         "the link or this machine is slow");
    return STATUS_DONE;
}

/* Over UDP a plant in lockstep takes one word a bus frame;
 * over CAN, and for another plant, it is CONTROL step alone. */
static int follow(const struct options *o, struct remote *t)
{
    bool lockstep = options_given(o, "lockstep");
    if (!lockstep && options_given(o, "patience"))
        return options_misuse(o->usage, "--patience needs --lockstep");
    if (!lockstep || t->bus.kind != BUS_UDP)
        return STATUS_DONE;
    const char *reason = lockstep_follow(&t->link, &t->bus, options_number(o, "patience"));
    return reason ? options_failure(o->usage, "%s", reason) : STATUS_DONE;
}

int cmd_control(int argc, char **argv)
{
    static struct remote remote; /* large: not on the stack */
    struct options o;
    int status;
    if (!options_parse(&o, &control_usage, argc, argv, &status))
        return status;
    status = remote_open(&remote, &o, BUS_CONTROLLER, 0);
    status = status ? status : follow(&o, &remote);
    status = status ? status : control(&o, &remote.client, &remote.scene);
    remote_close(&remote);
    return status;
}
