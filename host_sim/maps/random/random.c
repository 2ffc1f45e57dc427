/* random.c - the command contactplant random: statistics of a scene under noise. */
#include "host_sim/maps/random/random.h"

#include <stdlib.h>
#include "host_sim/commands.h"
#include "host_sim/maps/random/random_read.h"
#include "host_sim/maps/random/random_realise.h"
#include "host_sim/maps/random/random_report.h"

static const struct option random_options[] = {
    {"seeds", "N", "realisations, each with seeds of its own (100)", OPTION_INTEGER, 2, RANDOM_SEEDS,
     .initial = "100", .identity = IDENTITY_INSIDE},
    {"over", "TIME", "how long each one is measured (the scene's)", OPTION_TEXT, .initial = NULL,
     .identity = IDENTITY_INSIDE},
    {"settle", "TIME", "how long it settles before (a tenth of --over, and until the damping leaves 1e-2)",
     OPTION_TEXT, .initial = NULL, .identity = IDENTITY_INSIDE},
    {"observable", "OUTPUT", "the output that is measured (the scene's)", OPTION_TEXT, .initial = NULL,
     .identity = IDENTITY_INSIDE},
    {"range", "FROM:TO", "range of the observable (its mean and six standard deviations to both sides)",
     OPTION_TEXT, .initial = NULL, .identity = IDENTITY_INSIDE},
    {"bins", "N", "number of equal parts of the range (60)", OPTION_INTEGER, 2, RANDOM_BINS, .initial = "60",
     .identity = IDENTITY_INSIDE},
    {"statistics", "FILE", "the statistics of all realisations as CSV", OPTION_WRITES, .initial = NULL,
     .identity = IDENTITY_OUTSIDE},
    {.name = NULL},
};

const struct usage random_usage = {
    .name = "random",
    .words = "SCENE",
    .summary = "Computes statistics of a scene with noise over many realisations: density of the observable, "
               "crossing\n"
               "rates of levels, length of exceedances and contact loss, with standard errors. Nayak's and "
               "the Gaussian\n"
               "closed form stand beside them where they hold. Rows of realisations go to --out, their "
               "statistics to\n"
               "--statistics.",
    .words_help = SCENE_WORDS_HELP,
    .examples =
        "  contactplant random nayak-random --out rows.csv --svg random.svg --statistics random.csv\n"
        "  contactplant random rig --set force.amplitude=0 --set \"force.noise=20 N\" --out noise.csv\n"
        "  contactplant random nayak-random --seeds 1000 --shard 2/8 --out rows2.csv\n",
    .min_words = 1,
    .max_words = 1,
    .table = {random_options, maps_options, maps_outputs, jobs_options},
};

static bool compute(void *context, int job, FILE *rows)
{
    const struct random_runs *r = context;
    static double row[RANDOM_BIN + 2 * RANDOM_BINS + 2];
    const char *why = random_realise(r, job, r->over, row);
    if (why)
        return fputs(why, rows) < 0;
    rows_write(&r->m.rows, row, true, rows);
    return true;
}

static int run(struct random_runs *r)
{
    struct jobs j = {.n = r->n, .compute = compute, .context = r};
    int status = maps_compute(&r->m, &j);
    return status ? status : random_report(r);
}

int cmd_random(int argc, char **argv)
{
    struct random_runs r = {.n = 0};
    int status;
    if (!options_parse(&r.m.o, &random_usage, argc, argv, &status))
        return status;
    status = random_read(&r);
    status = status ? status : run(&r);
    free(r.m.identity);
    free(r.scratch);
    return status;
}
