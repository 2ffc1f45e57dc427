/* choose.c - contactplant choose: the certificate of a scene. */
#include "host_sim/choose/choose.h"
#include "firmware/plant/drive.h"
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_json.h"
#include "host_sim/choose/choose_print.h"
#include "host_sim/choose/choose_search.h"
#include "host_sim/choose/choose_tell.h"
#include "host_sim/cli/options_nearest.h"
#include "host_sim/commands.h"
#include "host_sim/cli/options.h"
#include "host_sim/choose/choose_html.h"
#include "host_sim/choose/choose_steps.h"
#include "host_sim/scene/scene_app.h"
#include "host_sim/scene/scene_check.h"
#include "host_sim/scene/scene_load.h"

#include <math.h>
#include <string.h>

enum { STEPS_MAX = 1000 /* in a sweep */, SWEEP_TEXT = 256 };

static const struct option choose_options[] = {
    {"on", "MACHINE",
     "the machine that keeps the deadline and whose cost counts: host, mps2-an500, mps2-an386, "
     "xlnx-zcu102-r5 (host)",
     OPTION_TEXT, .initial = "host"},
    {"sweep", "NAME=FROM:TO:N", "check through N frequencies of a drive (force.frequency) and back",
     OPTION_TEXT, .initial = NULL},
    {"tolerance", "E", "relative error of the observable (the scene's)", OPTION_NUMBER, 1e-15, 1e-1,
     .initial = NULL},
    {"observable", "NAME", "an output of the model (the scene's)", OPTION_TEXT, .initial = NULL},
    {"heat", NULL, "a lever keeps its temperature; statistics are compared then (it is cold)", OPTION_FLAG,
     .initial = NULL},
    {"json", "FILE", "the certificate as JSON", OPTION_WRITES, .initial = NULL},
    {"out", "FILE", "the chosen scene as a file to run", OPTION_WRITES, .initial = NULL},
    {"report", "FILE", "a page with certificate and charts, which opens in a browser without a network",
     OPTION_WRITES, .initial = NULL},
    {.name = NULL},
};

static const struct usage choose_usage = {
    .name = "choose",
    .words = "SCENE",
    .summary =
        "Finds the cheapest model, method and step that keep the scene's tolerance within its deadline, by\n"
        "running them beside the full model. Prints a certificate: the choice, its error, why, what it "
        "costs, what\n"
        "would void it, and why each other model was refused. Exits with 0 only when tolerance and deadline "
        "are\n"
        "met; with 1 when nothing meets them, and shows the closest; with 2 for a mistake in the command or "
        "a file\n"
        "that cannot be written; with 3 when the full model escapes in the time asked.",
    .words_help = "SCENE is a preset (contactplant list scenes) or a scene file (docs/guide/scenes.md).\n",
    .examples = "  contactplant choose rig\n"
                "  contactplant choose rig --tolerance 0.05 --out fast.ini && contactplant run fast.ini\n"
                "  contactplant choose shaft --json shaft.json --report shaft.html\n"
                "  contactplant choose rig --sweep force.frequency=100:200:20\n"
                "  contactplant choose rig --on mps2-an500\n",
    .min_words = 1,
    .max_words = 1,
    .table = {choose_options},
};

static bool find_machine(const struct options *o, struct choose_certificate *c)
{
    const char *names[CHOOSE_MACHINES];
    for (int i = 0; i < CHOOSE_MACHINES; i++)
        names[i] = choose_machine[i].name;
    c->machine = options_find(o, "on", names, CHOOSE_MACHINES, "no such machine");
    if (c->machine >= 0 && !(choose_machine[c->machine].ns[0] > 0.0))
        options_misuse(o->usage,
                       "--on %s: it is an emulated board of no known processor, so no deadline can be judged "
                       "on it; every certificate shows its instructions; choose another",
                       names[c->machine]);
    return c->machine >= 0 && choose_machine[c->machine].ns[0] > 0.0;
}

static bool find_observable(const struct options *o, struct choose_certificate *c)
{
    const struct model *m = c->scene.model;
    const char *names[MODEL_OUTPUTS];
    char lacking[80];
    if (!options_text(o, "observable", 0))
        return true;
    for (int i = 0; i < m->n_outputs; i++)
        names[i] = m->output_signal[i].name;
    snprintf(lacking, sizeof lacking, "%s has no such output", m->name);
    int found = options_find(o, "observable", names, m->n_outputs, lacking);
    c->scene.observable = fmax(found, 0.0);
    return found >= 0;
}

/* The input of INPUT=.. or INPUT.frequency=..: one that the scene drives, or -1. */
static int find_input(const struct choose_certificate *c, const char *name, size_t n)
{
    static const char frequency[] = ".frequency";
    const size_t more = sizeof frequency - 1;
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    if (n > more && !strncmp(name + n - more, frequency, more))
        n -= more;
    scenes_resolve(&c->scene, si, drive);
    for (int i = 0; i < c->scene.model->n_inputs; i++) {
        const char *own = c->scene.model->input_signal[i].name;
        if (strlen(own) == n && !strncmp(own, name, n) && fabs(drive[i].amplitude) > 0.0)
            return i;
    }
    return -1;
}

static int refuse_input(const struct options *o, const struct choose_certificate *c, const char *name,
                        size_t n)
{
    const struct model *m = c->scene.model;
    const char *names[MODEL_INPUTS];
    char text[MODEL_INPUTS][48];
    int count = 0;
    bool dotted = memchr(name, '.', n) != NULL;
    for (int i = 0; i < m->n_inputs; i++) {
        snprintf(text[count], sizeof *text, "%s%s", m->input_signal[i].name, dotted ? ".frequency" : "");
        names[count] = text[count];
        count += find_input(c, text[count], strlen(text[count])) >= 0;
    }
    return options_misuse(o->usage, "--sweep %.*s: no input of %s that the scene drives%s", (int)n, name,
                          m->name, options_advise(name, n, names, count, count ? NULL : "it drives none"));
}

/* INPUT=FROM:TO:N; versions before wrote commas. */
static bool find_sweep(const struct options *o, struct choose_certificate *c)
{
    static const struct range_rules rules = {.named = true,
                                             .unit = "Hz",
                                             .bare = true,
                                             .min = 1e-12,
                                             .max = 1e12,
                                             .n_min = 1,
                                             .n_max = STEPS_MAX,
                                             .order = RANGE_ANY_ORDER};
    const char *given = options_text(o, "sweep", 0);
    char text[SWEEP_TEXT], why[RANGE_REASON];
    if (!given)
        return true;
    snprintf(text, sizeof text, "%s", given);
    for (char *comma = strchr(text, ','); comma; comma = strchr(comma, ','))
        *comma = ':';
    if (!range_read(text, &rules, &c->sweep.Hz, why))
        return options_misuse(o->usage, "--sweep %s: %s", given, why) < 0;
    c->sweep.input = find_input(c, text, strcspn(text, "="));
    return c->sweep.input >= 0 || refuse_input(o, c, text, strcspn(text, "=")) < 0;
}

/* The scene with what the options change, checked anew: a sweep by its highest frequency. */
static bool read(const struct options *o, struct choose_certificate *c)
{
    char why[SCENE_REASON], reason[SCENE_CHECK_REASON];
    c->title = o->word[0];
    bool other = options_given(o, "tolerance");
    enum scene_origin origin = (other ? scene_load_unstepped : scene_load)(c->title, &c->scene, why);
    if (origin == SCENE_OF_NOTHING)
        options_misuse(o->usage, "%s", why);
    else if (origin == SCENE_OF_MODEL)
        options_misuse(o->usage, "%s alone asks nothing; give a preset (contactplant list scenes) or a file",
                       c->title);
    if (origin == SCENE_OF_NOTHING || origin == SCENE_OF_MODEL)
        return false;
    const char *refused = scene_refuses_stages(&c->scene);
    if (refused) {
        options_misuse(o->usage, "%s: %s", c->title, refused);
        return false;
    }
    c->heat = options_given(o, "heat");
    if (other)
        c->scene.tolerance = options_number(o, "tolerance");
    if (!find_machine(o, c) || !find_observable(o, c) || !find_sweep(o, c))
        return false;
    struct scene fast = c->scene;
    fast.tolerance =
        fmax(fast.tolerance, 1e-12); /* a method's own bounds are no bounds on what may be asked */
    double Hz = choose_swept_Hz(c);
    if (scene_check(&fast, reason))
        options_misuse(o->usage, "%s: %s", c->title, reason);
    else if (Hz * scene_check_step(&fast) * DRIVE_TICKS_MIN > 1.0 + 1e-9)
        options_misuse(o->usage, "--sweep: " DRIVE_TICKS_TOO_FEW "it; at most %.6g Hz",
                       1.0 / (DRIVE_TICKS_MIN * scene_check_step(&fast)));
    else
        return true;
    return false;
}

static void warn(const struct choose_certificate *c)
{
    const char *warning[CHOOSE_WARNINGS];
    int n = choose_warnings(c, warning);
    for (int i = 0; i < n; i++)
        fprintf(stderr, "contactplant choose: warning: %s\n", warning[i]);
}

static int write_file(const struct options *o, const char *option, const struct choose_certificate *c,
                      void (*write)(FILE *, const struct choose_certificate *))
{
    if (!options_given(o, option))
        return STATUS_DONE;
    FILE *f = options_compose(o, option);
    if (!f)
        return STATUS_MISUSED;
    write(f, c);
    return options_close(o, option, f, NULL) ? STATUS_MISUSED : STATUS_DONE;
}

static int write_page(const struct options *o, const struct choose_certificate *c, int argc, char **argv)
{
    const char *path = options_text(o, "report", 0), *why = path ? choose_html(c, path, argc, argv) : NULL;
    return why ? options_misuse(o->usage, "cannot write %s: %s; choose another --report", path, why)
               : STATUS_DONE;
}

int cmd_choose(int argc, char **argv)
{
    struct options o;
    int status;
    bool escaped;
    if (!options_parse(&o, &choose_usage, argc, argv, &status))
        return status;
    static struct choose_certificate c;
    memset(&c, 0, sizeof c);
    if (!read(&o, &c))
        return STATUS_MISUSED;
    warn(&c);
    const char *why = choose_search(&c, stderr, &escaped);
    if (why) {
        options_failure(&choose_usage, "%s: %s", c.title, why);
        return escaped ? STATUS_ESCAPED : STATUS_FAILED;
    }
    choose_print(stdout, &c);
    status = write_file(&o, "json", &c, choose_json);
    if (c.choice >= 0 && !status)
        status = write_file(&o, "out", &c, choose_write);
    status = status ? status : write_page(&o, &c, argc, argv);
    if (status)
        return status;
    return c.met && c.in_time ? STATUS_DONE : STATUS_FAILED;
}
