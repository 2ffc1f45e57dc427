/* send.c - one command line, or a chain of them, from the shell to a plant, and its answers by name. */
#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/live/explain.h"
#include "host_sim/live/send.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct option send_options[] = {
    {"hold", "S", "keep the session alive this long after the last command (0)", OPTION_NUMBER, 0.0, 1e6,
     .initial = "0"},
    {"tick", "T", "fire: at this plant tick", OPTION_NUMBER, 0.0, 1.8e19, .initial = NULL},
    {"in", "FRAMES", "fire: at the start of this many frames after the last one seen (10)", OPTION_INTEGER,
     1.0, 1e6, .initial = "10"},
    {"model", "NAME", "the plant's model or scene, as given to contactplant run (hertz_rig)", OPTION_TEXT,
     .initial = NULL},
    {.name = NULL},
};

static const struct usage send_usage = {
    .name = "send",
    .words = "COMMAND [ARGUMENTS] [+ COMMAND [ARGUMENTS]]...",
    .summary =
        "Sends commands to a plant and prints its answers. It joins the session that is open, or opens one.\n"
        "It sends heartbeats only while it runs: if nobody else is in the session, the plant's time-out\n"
        "reaction follows (see --hold). Exits with 1 when the plant refuses or does not answer. Give the\n"
        "--base-id and --substeps of the plant.",
    .words_help =
        "commands:\n"
        "  enable                       opens a session, or joins it\n"
        "  disable                      turns the drives off and closes the session\n"
        "  start                        lets plant time run\n"
        "  stop                         turns the drives off, stops plant time and ends the session\n"
        "  pause                        stops plant time; drives and state are kept\n"
        "  step N                       runs N frames, while paused\n"
        "  run-until TICK               runs to this tick, a frame's end, while paused\n"
        "  reset                        brings the plant to rest and clears faults; when not running\n"
        "  arm INPUT [amplitude=A] [frequency=HZ] [phase=RAD] [ramp=S]\n"
        "            [noise=DEVIATION] [noise_hold=TICKS] [noise_seed=N]\n"
        "                               prepares a harmonic drive and noise for fire; with units\n"
        "                               (amplitude=3 N phase=90 deg) or SI\n"
        "  fire                         applies all drives armed on this command line, at --tick or --in\n"
        "  stream INPUT VALUE           sends one sample, SI or with its unit, for the next frame but one\n"
        "  set NAME=VALUE...            sets parameters and settings, all or none: mass_kg=5\n"
        "                               in SI, or mass=5 kg\n"
        "  read NAME                    prints one parameter or setting\n"
        "  capture arm | trigger | stop | read [FIRST COUNT]\n"
        "                               controls the burst capture; read prints CSV, once the burst is full\n"
        "INPUT is force, fast_force, base or stiffness for hertz_rig; contactplant list shows all names.\n",
    .examples = "  contactplant send enable + start --hold 10\n"
                "  contactplant send start + arm force amplitude=5 N frequency=200 Hz ramp=0.5 s + fire --in "
                "20 --hold 10\n"
                "  contactplant send start + arm force noise=5 noise_hold=4 noise_seed=7 + fire --hold 10\n"
                "  contactplant send set damping_N_s_per_m=300 motion_every=2 + read damping_N_s_per_m\n"
                "  contactplant send pause + step 100\n"
                "  contactplant send stop\n"
                "  contactplant send --bus can:can0 start + capture arm + capture trigger --hold 1\n"
                "  contactplant send --bus can:can0 capture read > burst.csv\n",
    .min_words = 1,
    .max_words = OPTIONS_WORDS,
    .table = {send_options, bus_options, scene_options},
};

/* ---- the chain ---- */

static const struct send_verb *find_verb(const struct sender *s, const char *name)
{
    const char *names[SEND_VERBS];
    for (int i = 0; i < SEND_VERBS; i++) {
        names[i] = send_verb[i].name;
        if (!strcmp(names[i], name))
            return &send_verb[i];
    }
    char advice[OPTIONS_ADVICE];
    options_misuse(s->o->usage, "unknown command \"%s\"%s", name,
                   options_advise(name, strlen(name), names, SEND_VERBS, NULL, advice, sizeof advice));
    return NULL;
}

/* Words of the command that begins at i: up to the next "+" or the end. */
static int words_at(const struct options *o, int i)
{
    int n = 0;
    while (i + n < o->n_words && strcmp(o->word[i + n], "+"))
        n++;
    return n;
}

/* After a stop of our own the next command needs a session
 * that knows of it; somebody else's stop ends the chain. */
static bool go_on(struct sender *s)
{
    bool stopped = s->stopped;
    s->stopped = false;
    if (!stopped || client_open(&s->station.client, true, SEND_SILENCE_S))
        return true;
    options_failure(
        s->o->usage,
        "no session after stop: the plant refuses one, or is silent; look with contactplant monitor");
    return false;
}

/* Checks the command of n words at i, or runs it. */
static int one_command(struct sender *s, int i, int n, bool run)
{
    const char *const *word = &s->o->word[i];
    if (n == 0)
        return options_misuse(s->o->usage, "a command is missing beside +; write one on both sides");
    const struct send_verb *v = find_verb(s, word[0]);
    if (!v)
        return STATUS_MISUSED;
    if (n - 1 < v->min_words || n - 1 > v->max_words)
        return options_misuse(s->o->usage, "%s: too %s words behind it: %d", v->name,
                              n - 1 < v->min_words ? "few" : "many", n - 1);
    if (run)
        return go_on(s) ? v->run(s, n - 1, word + 1) : STATUS_FAILED;
    return v->check ? v->check(s, n - 1, word + 1) : 0;
}

static int all_commands(struct sender *s, bool run)
{
    int status = 0, i = 0;
    do {
        int n = words_at(s->o, i);
        status = one_command(s, i, n, run);
        i += n + 1;
    } while (!status && !clock_interrupted() && i <= s->o->n_words);
    fflush(stdout);
    return status;
}

static int hold(struct sender *s)
{
    double end = clock_now_s() + options_number(s->o, "hold");
    const struct client *c = &s->station.client;
    while (clock_now_s() < end && !clock_interrupted()) {
        send_expect(s, WIRE_ENABLE);
        send_wait(s, SEND_HEARTBEAT_S);
        if (!client_in_session(c) || c->latest.session != c->session)
            return options_failure(s->o->usage, "the session ended before --hold did");
    }
    return STATUS_DONE;
}

static int converse(struct sender *s)
{
    struct client *c = &s->station.client;
    c->heard = send_hear;
    c->heard_context = s;
    if (!client_open(c, true, SEND_SILENCE_S)) {
        char why[EXPLAIN_REASON];
        explain_no_session(&s->station.client, why);
        return options_failure(s->o->usage, "%s", why);
    }
    int status = all_commands(s, true);
    bool closed = s->stopped || c->latest.state == STATE_OFF; /* by the command stop or disable */
    return status || closed ? status : hold(s);
}

/* Every command is checked before any is sent: their words need the model's names. */
static int prepare_commands(struct sender *s)
{
    int status = station_open(&s->station, s->o, BUS_SENDER, OPTIONS_WORDS);
    return status ? status : all_commands(s, false);
}

int cmd_send(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &send_usage, argc, argv, &status))
        return status;
    struct sender *s = calloc(1, sizeof *s);
    if (!s)
        return options_failure(&send_usage, "out of memory");
    s->o = &o;
    status = prepare_commands(s);
    status = status ? status : converse(s);
    station_close(&s->station);
    free(s->burst);
    free(s);
    return status;
}
