/* sweep.c - the command contactplant sweep: response curves with jumps, as CSV and as a picture. */
#include "host_sim/maps/sweep/sweep.h"

#include "host_sim/commands.h"
#include "host_sim/maps/sweep/sweep_chain.h"
#include "host_sim/maps/sweep/sweep_read.h"
#include "host_sim/maps/sweep/sweep_report.h"

#include <stdlib.h>

static const struct option sweep_options[] = {
    {"sweep", "NAME=FROM:TO:N",
     "N values of a number of the scene, up and down; :log behind it for equal ratios "
     "(the slowest drive's frequency from half to twice the scene's, 200)",
     OPTION_TEXT, .initial = NULL, .identity = IDENTITY_INSIDE},
    {"family", "NAME=FROM:TO:N", "the sweep for N values of another number, a curve for each", OPTION_TEXT,
     .initial = NULL, .identity = IDENTITY_INSIDE},
    {"settle", "PERIODS", "drive periods before each point is measured (until the damping leaves 1e-4)",
     OPTION_INTEGER, 0, 1e6, .initial = NULL, .identity = IDENTITY_INSIDE},
    {"measure", "PERIODS",
     "drive periods measured, in two halves: rows have the second (12, more for subharmonics)",
     OPTION_INTEGER, 4, 1000, .initial = NULL, .identity = IDENTITY_INSIDE},
    {"harmonics", "N,N/M,..", "harmonics of the drive to measure (1,2,3)", OPTION_TEXT, .initial = "1,2,3",
     .identity = IDENTITY_INSIDE},
    {"bracket", "E", "width of a jump's bracket, relative to its place (1e-4)", OPTION_NUMBER, 1e-9, 1e-1,
     .initial = "1e-4", .identity = IDENTITY_INSIDE},
    {.name = NULL},
};

const struct usage sweep_usage = {
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
    .table = {sweep_options, maps_options, maps_outputs, jobs_options},
};

int cmd_sweep(int argc, char **argv)
{
    struct sweep s = {.n_harmonics = 0};
    int status;
    if (!options_parse(&s.m.o, &sweep_usage, argc, argv, &status))
        return status;
    status = sweep_read(&s);
    struct jobs j = {.n = s.family.values.n ? s.family.values.n : 1,
                     .compute = sweep_chain,
                     .parts = 2 * s.range.values.n,
                     .ends = sweep_chain_ends,
                     .resume = sweep_resume,
                     .context = &s};
    status = status ? status : maps_compute(&s.m, &j);
    status = status ? status : maps_conclude(&s.m, NULL, &sweep_finding, &s);
    free(s.m.identity);
    free(s.scratch);
    return status;
}
