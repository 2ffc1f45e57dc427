/* fit.c - the command contactplant fit: a scene from a measured rig, and what the data cannot tell. */
#include "host_sim/fit/fit.h"

#include "host_sim/cli/clock.h"
#include "host_sim/commands.h"
#include "host_sim/fit/fitted.h"
#include "host_sim/fit/judge.h"
#include "host_sim/fit/levels.h"
#include "host_sim/fit/progress.h"
#include "host_sim/fit/read.h"
#include "host_sim/fit/show/picture.h"
#include "host_sim/replay/decode_signals.h"
#include "host_sim/fit/tell.h"

static const struct option fit_options[] = {
    {"sweep", "FILE", "a measured response curve, or rows of contactplant sweep; repeatable", OPTION_READS,
     .many = true},
    {"ring", "FILE", "a free motion of the rig: time and displacement; repeatable", OPTION_READS,
     .many = true},
    {"series", "FILE", "a motion under a drive: time, displacement and force; repeatable", OPTION_READS,
     .many = true},
    {"log", "FILE", "a log of the plant or rig, of run --log, candump -L or Wireshark (pcapng); repeatable",
     OPTION_READS, .many = true},
    {"base-id", "ID", "of --log: first of the plant's 64 CAN identifiers (0x200)", OPTION_INTEGER, 0.0,
     536870848.0, .initial = "0x200"},
    {"extended", NULL, "of --log: 29-bit identifiers", OPTION_FLAG, .initial = NULL},
    {"thermal", "FILE",
     "of an AFM lever: the spectrum of its thermal motion, as contactplant thermal writes it", OPTION_READS,
     .initial = NULL},
    {"curve", "FILE", "of an AFM lever: a force curve, .csv or .tab, as contactplant approach writes it",
     OPTION_READS, .initial = NULL},
    {"plan", NULL, "before measuring: which curves would tell the unknowns, and how well", OPTION_FLAG,
     .initial = NULL},
    {"free", "NAME,..",
     "the unknowns: numbers of the plant, gain.force, gain.sensor, delay, offset (all numbers of the plant)",
     OPTION_TEXT, .initial = NULL},
    {"hold", "NAME=VALUE", "a number that is known, with its unit; repeatable", OPTION_TEXT, .many = true},
    {"out", "FILE", "the fitted scene, with the intervals as comments", OPTION_WRITES, .initial = NULL},
    {"svg", "FILE", "a picture of data, fit, residuals and profiles", OPTION_WRITES, .initial = NULL},
    {"report", "FILE", "the same as a page, which opens in a browser without a network", OPTION_WRITES,
     .initial = NULL},
    {"force", NULL, "writes --out though the fit is refused", OPTION_FLAG, .initial = NULL},
    {.name = NULL},
};

static const struct usage fit_usage = {
    .name = "fit",
    .words = "SCENE",
    .summary = "Finds the numbers of a scene from measurements of the rig: value, intervals of 68 and 95 "
               "%, and what\n"
               "the data give only together. A fit that cannot be believed is refused with its reasons, and "
               "status 1.",
    .words_help = "SCENE is a scene file or preset; its numbers are where the fit starts.\n",
    .examples =
        "  contactplant fit rig.ini --sweep small.csv --sweep large.csv --out fitted.ini --report fit.html\n"
        "  contactplant fit rig.ini --sweep small.csv --hold \"preload=64 N\"\n"
        "  contactplant fit rig.ini --ring decay.csv --free stiffness,preload,damping --hold "
        "\"mass=6.1 kg\"\n"
        "  contactplant fit rig.ini --log bench.log --interface can0\n"
        "  contactplant fit tapping --thermal heat.csv --out lever.ini\n"
        "  contactplant fit soft --thermal heat.csv --curve curve.tab --out lever.ini\n"
        "  contactplant fit rig.ini --plan --free stiffness,preload,damping\n"
        "  contactplant fit rig.ini --sweep small.csv --free mass,stiffness,damping,delay\n",
    .min_words = 1,
    .max_words = 1,
    .table = {fit_options, decode_log_options},
};

static int conclude(struct fit_setup *s, const struct fit_result *r, const struct judged *j)
{
    bool force = options_given(&s->o, "force");
    for (int i = 0; i < j->n; i++)
        fprintf(stderr, "contactplant fit: %s\n", j->reason[i]);
    if (options_given(&s->o, "out") && (!j->n || force)) {
        int status = fitted_write(s, r, j);
        return status ? status : j->n ? STATUS_FAILED : STATUS_DONE;
    }
    if (j->n && options_given(&s->o, "out"))
        fprintf(stderr, "contactplant fit: --out is not written; --force writes it\n");
    return j->n ? STATUS_FAILED : STATUS_DONE;
}

/* Fits, tells and writes. Returns the exit status. */
static int fit_and_tell(struct fit_setup *s)
{
    static struct judged j;
    struct fit_result r;
    bool found = starts_fit(s, &r);
    progress_clear(s);
    if (!found)
        return options_failure(
            s->o.usage, clock_interrupted()
                            ? "interrupted before the fit from the first start had ended: nothing is found"
                            : "no plant near this start runs at these frequencies; give another scene");
    judge_fit(s, &r, &j);
    tell_fit(s, &r, &j, stdout);
    int status = picture_write(s, &r, &j), concluded = conclude(s, &r, &j);
    return status ? status : concluded;
}

int cmd_fit(int argc, char **argv)
{
    static struct fit_setup s;
    int status;
    s = (struct fit_setup){.n = 0};
    if (!options_parse(&s.o, &fit_usage, argc, argv, &status))
        return status;
    status = fit_read(&s);
    clock_catch_signals();
    if (!status)
        status = options_given(&s.o, "plan") ? levels_tell(&s) : fit_and_tell(&s);
    fit_free(&s);
    return status;
}
