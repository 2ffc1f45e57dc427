/* send.c - one command line, or a chain of them, from the shell to a plant, and its answers by name. */
#include "host_sim/cli/clock.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/commands.h"
#include "host_sim/live/explain.h"
#include "host_sim/live/send_verbs.h"
#include "host_sim/scene/scene_load.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = 4096 }; /* letters of a command */

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
    .max_words = SEND_WORDS,
    .table = {send_options, bus_options, scene_options},
};

/* ---- the chain ---- */

struct chain {
    struct sender sender;
    int n;
    struct action action[SEND_WORDS];
};

/* Words of the command that begins at i: up to the next "+" or the end. */
static int words_at(const struct options *o, int i)
{
    int n = 0;
    while (i + n < o->n_words && strcmp(o->word[i + n], "+"))
        n++;
    return n;
}

/* A scene, or a name with a dot, as files have. */
static bool is_scene(const char *word)
{
    static struct scene s;
    char why[SCENE_REASON];
    return strchr(word, '.') || scene_load(word, &s, why) != SCENE_OF_NOTHING;
}

static int unknown_command(const struct options *o, const char *word)
{
    const char *name[ACTION_VERBS];
    int n = action_names(send_verbs, name);
    const char *hint = is_scene(word) ? "a scene is given by --model" : NULL;
    return options_misuse(o->usage, "unknown command \"%s\"%s", word,
                          options_advise(word, strlen(word), name, n, hint));
}

/* The command of n words, which may be part of a number with its unit each. */
static int read_command(struct chain *k, int n, const char *const *word)
{
    const struct options *o = k->sender.o;
    char text[TEXT] = "", why[SCENE_REASON];
    size_t used = 0;
    if (n == 0)
        return options_misuse(o->usage, "a command is missing beside +; write one on both sides");
    enum action_verb verb = action_find(send_verbs, (struct word){word[0], strlen(word[0])});
    if (verb == ACTION_VERBS)
        return unknown_command(o, word[0]);
    for (int i = 1; i < n && used < TEXT; i++)
        used += (size_t)snprintf(text + used, TEXT - used, "%s%s", i > 1 ? " " : "", word[i]);
    if (used >= TEXT)
        return options_misuse(o->usage, "%s: too many letters", word[0]);
    struct action *a = &k->action[k->n++];
    return action_read(send_model(&k->sender), verb, (struct word){text, used}, a, why)
               ? send_check(&k->sender, a)
               : options_misuse(o->usage, "%s", why);
}

/* Every command is read before any is sent. */
static int read_commands(struct chain *k)
{
    const struct options *o = k->sender.o;
    int status = 0, i = 0;
    do {
        int n = words_at(o, i);
        status = read_command(k, n, &o->word[i]);
        i += n + 1;
    } while (!status && i <= o->n_words);
    return status;
}

/* After a stop of our own the next command needs a session
 * that knows of it; somebody else's stop ends the chain. */
static bool go_on(struct sender *s)
{
    bool stopped = s->stopped;
    s->stopped = false;
    if (!stopped || client_open(&s->remote.client, true, SEND_SILENCE_S))
        return true;
    options_failure(
        s->o->usage,
        "no session after stop: the plant refuses one, or is silent; look with contactplant monitor");
    return false;
}

static int run_commands(struct chain *k)
{
    int status = 0;
    for (int i = 0; i < k->n && !status && !clock_interrupted(); i++)
        status = go_on(&k->sender) ? send_run(&k->sender, &k->action[i]) : STATUS_FAILED;
    fflush(stdout);
    return status;
}

static int hold(struct sender *s)
{
    double end = clock_now_s() + options_number(s->o, "hold");
    const struct client *c = &s->remote.client;
    while (clock_now_s() < end && !clock_interrupted()) {
        send_expect(s, WIRE_ENABLE);
        send_wait(s, SEND_HEARTBEAT_S);
        if (!client_in_session(c) || c->latest.session != c->session)
            return options_failure(s->o->usage, "the session ended before --hold did");
    }
    return STATUS_DONE;
}

static int converse(struct chain *k)
{
    struct sender *s = &k->sender;
    struct client *c = &s->remote.client;
    c->heard = send_take;
    c->heard_context = s;
    if (!client_open(c, true, SEND_SILENCE_S)) {
        char why[EXPLAIN_REASON];
        explain_no_session(&s->remote.client, why);
        return options_failure(s->o->usage, "%s", why);
    }
    int status = run_commands(k);
    bool closed = s->stopped || c->latest.state == STATE_OFF; /* by the command stop or disable */
    return status || closed ? status : hold(s);
}

int cmd_send(int argc, char **argv)
{
    struct options o;
    int status;
    if (!options_parse(&o, &send_usage, argc, argv, &status))
        return status;
    struct chain *k = calloc(1, sizeof *k);
    if (!k)
        return options_failure(&send_usage, "out of memory");
    k->sender.o = &o;
    status = remote_open(&k->sender.remote, &o, BUS_SENDER, OPTIONS_WORDS);
    status = status ? status : read_commands(k);
    status = status ? status : converse(k);
    remote_close(&k->sender.remote);
    free(k->sender.burst);
    free(k);
    return status;
}
