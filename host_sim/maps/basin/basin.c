/* basin.c - contactplant basin: which attractors a plant has, and how many starts lead to each. */
#include "host_sim/maps/basin/basin.h"
#include "host_sim/commands.h"
#include "host_sim/maps/jobs.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const struct option own[] = {
    {"starts", "N", "how many (1000)", OPTION_INTEGER, 1, BASIN_STARTS_MAX, .initial = "1000"},
    {"seed", "S", "of the starts' places (1)", OPTION_INTEGER, 0, 4294967295.0, .initial = "1"},
    {"box", "STATE=LO:HI",
     "where a state starts, with unit (4 gaps or static compressions around rest, and the speeds of that "
     "energy); "
     "repeatable",
     OPTION_TEXT, .many = true},
    {"periods", "N", "forcing periods that a motion may take to settle (20000)", OPTION_INTEGER, 1, 100000000,
     .initial = "20000"},
    {"method", "NAME",
     "integration method, or batch_taylor, the power series of many starts side by side (the scene's; auto: "
     "batch_taylor for one Hertzian contact under at most two frequencies of force and one of stiffness, "
     "else "
     "exact or taylor)",
     OPTION_TEXT, .initial = NULL},
    {"steps", "N", "steps in a forcing period (the fewest, by doubling from 8, that the method takes)",
     OPTION_INTEGER, 1, 1000000, .initial = NULL},
    {"report", "FILE", "no new rows: attractors and counts of those in FILE", OPTION_TEXT, .initial = NULL},
    {"svg", "FILE", "picture: start positions and velocities, coloured by attractor", OPTION_TEXT,
     .initial = NULL},
    {.name = NULL},
};

static const struct usage usage = {
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
        "  contactplant basin shaft-fig16-705 --report map.csv --svg again.svg\n",
    .max_words = 1,
    .table = {own, jobs_options},
};

/* Start i, SI as the rows tell it, and in model units from there. */
static void get_start(const struct basin *b, int i, double *si, double *x)
{
    basin_starts_get(&b->starts, i, si);
    for (int k = 0; k < b->plant.model->n_states; k++) {
        si[k] *= basin_unit(b, k, NULL);
        x[k] = si[k] / basin_unit(b, k, NULL);
    }
}

/* Job i: a block of starts. */
static bool compute(void *context, int i, FILE *rows)
{
    const struct basin *b = context;
    double start[BASIN_BLOCK][MODEL_STATES] = {{0.0}}, x[BASIN_BLOCK][MODEL_STATES] = {{0.0}};
    struct basin_motion motion[BASIN_BLOCK];
    int first = i * BASIN_BLOCK, n = b->starts.n - first < BASIN_BLOCK ? b->starts.n - first : BASIN_BLOCK;
    for (int k = 0; k < n; k++)
        get_start(b, first + k, start[k], x[k]);
    const char *why = basin_motion_find(&b->plant, &b->patience, n, x, motion);
    if (why)
        return fprintf(rows, "%s", why) < 0;
    for (int k = 0; k < n; k++)
        basin_rows_write(b, first + k, start[k], &motion[k], rows);
    return true;
}

static bool ends(void *context, int i, const char *row)
{
    const struct basin *b = context;
    int end = (i + 1) * BASIN_BLOCK;
    return atoi(row) == (end < b->starts.n ? end : b->starts.n) - 1;
}

/* 0, or the exit status after a line: found out before the work, not after it. */
static int check_files(const struct basin *b)
{
    const char *svg = options_text(b->o, "svg", 0), *out = options_text(b->o, "out", 0);
    bool whole = out && !strcmp(options_text(b->o, "shard", 0), "1/1");
    if (options_given(b->o, "report") && (out || options_given(b->o, "shard")))
        return options_misuse(b->o->usage,
                              "--report reads rows and writes none; take --out and --shard away");
    if (!svg)
        return 0;
    if (!whole && !options_given(b->o, "report"))
        return options_misuse(b->o->usage, "--svg %s: needs all rows: give --out and no --shard, or --report",
                              svg);
    if (scene_load_same(svg, whole ? out : options_text(b->o, "report", 0)))
        return options_misuse(b->o->usage, "--svg %s has the rows; choose another", svg);
    if (scene_load_is(b->origin, b->name, svg))
        return options_misuse(b->o->usage, "--svg %s is the scene itself; choose another", svg);
    FILE *f = fopen(svg, "a");
    if (!f)
        return options_misuse(b->o->usage, "--svg %s: %s; give a file that can be written", svg,
                              strerror(errno));
    return fclose(f) ? options_failure(b->o->usage, "--svg %s: %s", svg, strerror(errno)) : 0;
}

static int run(struct basin *b)
{
    const char *out = options_text(b->o, "out", 0), *svg = options_text(b->o, "svg", 0);
    const char *rows = options_text(b->o, "report", 0);
    int status = check_files(b);
    if (status || rows)
        return status ? status : basin_report(b, rows, svg);
    if (scene_load_warns(b->origin, b->plant.model)) {
        double si[MODEL_PARAMETERS];
        struct harmonic drive[MODEL_INPUTS];
        scenes_resolve(&b->scene, si, drive);
        scene_load_warn(b->o->usage->name, b->plant.model, si, drive);
    }
    const struct jobs j = {.options = b->o,
                           .identity = b->identity,
                           .columns = b->columns,
                           .n = (b->starts.n + BASIN_BLOCK - 1) / BASIN_BLOCK,
                           .compute = compute,
                           .ends = ends,
                           .context = b};
    status = jobs_run(&j);
    bool whole = out && !strcmp(options_text(b->o, "shard", 0), "1/1");
    return status == STATUS_DONE && whole ? basin_report(b, out, svg) : status;
}

int cmd_basin(int argc, char **argv)
{
    struct options o;
    static struct basin b;
    int status;
    if (!options_parse(&o, &usage, argc, argv, &status))
        return status;
    status = basin_read(&b, &o);
    status = status ? status : run(&b);
    basin_free(&b);
    return status;
}
