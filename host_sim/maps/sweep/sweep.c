/* sweep.c - contactplant sweep: response curves with jumps, as CSV and as a picture; see sweep.h. */
#include "host_sim/maps/sweep/sweep.h"

#include "host_sim/commands.h"

#include <stdlib.h>

static const struct option own[] = {
    {"sweep", "NAME=FROM:TO:N",
     "N values of a number of the scene, up and down; :log behind it for equal ratios "
     "(the slowest drive's frequency from half to twice the scene's, 200)",
     OPTION_TEXT, .initial = NULL},
    {"family", "NAME=FROM:TO:N", "all of it for N values of another number: a curve each", OPTION_TEXT,
     .initial = NULL},
    {"set", "NAME=VALUE", "a number of the scene, with its unit; repeatable", OPTION_TEXT, .many = true},
    {"settle", "PERIODS", "of the drive before each point is measured (in which the damping leaves 1e-4)",
     OPTION_INTEGER, 0, 1e6, .initial = NULL},
    {"measure", "PERIODS", "measured, in two halves: the second one is told (12, more for subharmonics)",
     OPTION_INTEGER, 4, 1000, .initial = NULL},
    {"harmonics", "N,N/M,..", "of the drive, to lock in to (1,2,3)", OPTION_TEXT, .initial = "1,2,3"},
    {"bracket", "E", "width of a jump's bracket over its place (1e-4)", OPTION_NUMBER, 1e-9, 1e-1,
     .initial = "1e-4"},
    {"method", "NAME", "integration method (the scene's)", OPTION_TEXT, .initial = NULL},
    {"tol", "E", "its tolerance (the scene's, 1e-9 at most)", OPTION_NUMBER, METHOD_TOL_MIN, METHOD_TOL_MAX,
     .initial = NULL},
    {"svg", "FILE", "a picture of the rows in --out", OPTION_TEXT, .initial = NULL},
    {.name = NULL},
};

static const struct usage usage = {
    .name = "sweep",
    .words = "[SCENE]",
    .summary =
        "Response curves: steps a number of the scene up and down, carries the motion from step to step, "
        "and\n"
        "prints amplitude and phase of harmonics, time out of contact and peak force. Jumps are located by\n"
        "bisection: rows jump_from and jump_to. NAME is a key of the scene (damping, force.frequency, "
        "omega).",
    .words_help = SCENE_WORDS_HELP,
    .examples = "  contactplant sweep rig --out rig.csv --svg rig.svg\n"
                "  contactplant sweep rig --sweep \"force.frequency=100 Hz:300 Hz:400\" --harmonics 1,2,1/2\n"
                "  contactplant sweep rig --sweep force.amplitude=1:60:100 --family \"force.frequency=180 "
                "Hz:240 Hz:7\"\n"
                "  contactplant sweep bbp-fig2-force --sweep omega=0.7:1.1:80 --out fig3.csv\n",
    .max_words = 1,
    .table = {own, jobs_options},
};

static void warn(const struct sweep *s)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    scenes_resolve(&s->scene, si, drive);
    if (scene_load_warns(s->origin, s->scene.model))
        scene_load_warn(usage.name, s->scene.model, si, drive);
}

static int run(struct sweep *s)
{
    const struct jobs j = {.options = &s->o,
                           .identity = s->identity,
                           .columns = s->columns,
                           .n = s->family.n ? s->family.n : 1,
                           .compute = sweep_chain,
                           .parts = 2 * s->range.n,
                           .ends = sweep_chain_ends,
                           .resume = sweep_resume,
                           .context = s};
    warn(s);
    int status = jobs_run(&j);
    bool drawn = options_given(&s->o, "svg");
    return status || !drawn ? status : sweep_chart(s, options_text(&s->o, "out", 0));
}

int cmd_sweep(int argc, char **argv)
{
    struct sweep s = {.n_harmonics = 0};
    int status;
    if (!options_parse(&s.o, &usage, argc, argv, &status))
        return status;
    status = sweep_read(&s);
    status = status ? status : run(&s);
    free(s.identity);
    free(s.work);
    return status;
}
