/* basin.c - the command contactplant basin: which attractors a plant has, and how many starts lead to
 * each. */
#include "host_sim/maps/basin/basin.h"
#include "host_sim/commands.h"
#include "host_sim/maps/basin/basin_read.h"
#include "host_sim/maps/basin/basin_report.h"
#include "host_sim/maps/basin/basin_rows.h"

#include <stdlib.h>

static const struct option basin_options[] = {
    {"starts", "N", "number of starts (1000)", OPTION_INTEGER, 1, BASIN_STARTS_MAX, .initial = "1000",
     .identity = IDENTITY_INSIDE},
    {"seed", "S", "seed of the starts' places (1)", OPTION_INTEGER, 0, 4294967295.0, .initial = "1",
     .identity = IDENTITY_INSIDE},
    {"box", "NAME=FROM:TO",
     "where a state starts (4 gaps or static compressions around rest, and the speeds of that energy); "
     "repeatable",
     OPTION_TEXT, .many = true, .identity = IDENTITY_INSIDE},
    {"periods", "N", "forcing periods that a motion may take to settle (20000)", OPTION_INTEGER, 1, 100000000,
     .initial = "20000", .identity = IDENTITY_INSIDE},
    {"method", "NAME",
     "integration method, or batch_taylor, the power series of many starts side by side (the scene's; auto: "
     "batch_taylor for one Hertzian contact under at most two frequencies of force and one of stiffness, "
     "else exact or taylor)",
     OPTION_TEXT, .initial = NULL, .identity = IDENTITY_INSIDE},
    {"steps", "N", "steps in a forcing period (the fewest, by doubling from 8, that the method takes)",
     OPTION_INTEGER, 1, 1000000, .initial = NULL, .identity = IDENTITY_INSIDE},
    {"rows", "FILE", "compute nothing: tell the attractors of the rows in FILE", OPTION_READS,
     .initial = NULL, .identity = IDENTITY_OUTSIDE},
    {.name = NULL},
};

const struct usage basin_usage = {
    .name = "basin",
    .words = "[SCENE]",
    .summary =
        "Lets a plant settle from many starts, a Latin hypercube over a box of its states, and tells which\n"
        "attractors they reach: period, fingerprint, share with its 95 % interval, mirror images.\n"
        "A row a start; with --out the table of attractors follows on standard output.",
    .words_help = SCENE_WORDS_HELP
    "The scene's own start is not used. Its drives must share a period, and have no noise.\n",
    .examples =
        "  contactplant basin shaft-fig16-705 --starts 10000 --out map.csv --svg map.svg\n"
        "  contactplant basin my.ini --box position=-20um:20um --box velocity=-10mm/s:10mm/s --out mine.csv\n"
        "  contactplant basin shaft-fig16-705 --starts 10000 --shard 2/8 --out part2.csv\n"
        "  contactplant basin shaft-fig16-705 --rows map.csv --report map.html\n",
    .max_words = 1,
    .table = {basin_options, maps_outputs, jobs_options},
};

/* Job i: a block of starts. A start has the numbers of its row; the model's units are computed from there. */
static bool compute(void *context, int i, FILE *rows)
{
    const struct basin *b = context;
    struct basin_row row[BASIN_BLOCK] = {{.start = 0}};
    double x[BASIN_BLOCK][MODEL_STATES] = {{0.0}};
    struct basin_motion motion[BASIN_BLOCK];
    int first = i * BASIN_BLOCK, n = b->starts.n - first < BASIN_BLOCK ? b->starts.n - first : BASIN_BLOCK;
    for (int k = 0; k < n; k++) {
        basin_starts_get(&b->starts, first + k, x[k]);
        basin_show(b, x[k], row[k].x);
        basin_take(b, row[k].x, x[k]);
    }
    const char *why = basin_motion_find(&b->plant, &b->patience, n, x, motion);
    if (why)
        return fprintf(rows, "%s", why) < 0;
    for (int k = 0; k < n; k++) {
        row[k].start = first + k;
        row[k].motion = motion[k];
        basin_show(b, motion[k].end, row[k].end);
        rows_write(&b->m.rows, &row[k], true, rows);
    }
    return true;
}

static bool ends(void *context, int i, const char *row)
{
    const struct basin *b = context;
    int end = (i + 1) * BASIN_BLOCK;
    return atoi(row) == (end < b->starts.n ? end : b->starts.n) - 1;
}

/* 0, or the exit status after a line. */
static int check_files(const struct basin *b, const char *rows)
{
    const struct usage *u = b->m.o.usage;
    const char *out = options_text(&b->m.o, "out", 0);
    if (rows && (out || options_given(&b->m.o, "shard")))
        return options_misuse(u, "--rows reads rows and writes none; take --out and --shard away");
    return maps_check_files(&b->m, rows ? rows : out);
}

static int run(struct basin *b)
{
    const char *rows = options_text(&b->m.o, "rows", 0);
    struct jobs j = {
        .n = (b->starts.n + BASIN_BLOCK - 1) / BASIN_BLOCK, .compute = compute, .ends = ends, .context = b};
    int status = check_files(b, rows);
    if (!status && !rows)
        status = maps_compute(&b->m, &j);
    return status ? status : basin_report(b, rows);
}

int cmd_basin(int argc, char **argv)
{
    struct basin b = {.m = {.identity = NULL}};
    int status;
    if (!options_parse(&b.m.o, &basin_usage, argc, argv, &status))
        return status;
    status = basin_read(&b);
    status = status ? status : run(&b);
    basin_starts_free(&b.starts);
    free(b.m.identity);
    return status;
}
