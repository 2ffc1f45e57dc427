/* random.c - contactplant random: statistics of a scene under noise; see random.h. */
#include "host_sim/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "firmware/plant_scene.h"
#include "host_sim/commands.h"
#include "host_sim/jobs.h"
#include "host_sim/scene_check.h"

static const struct option own[] = {
    {"seeds", "N", "realisations, each with seeds of its own (100)", OPTION_INTEGER, 2, RANDOM_SEEDS,
     .initial = "100"},
    {"over", "TIME", "that each one is looked at (the scene's)", OPTION_TEXT, .initial = NULL},
    {"settle", "TIME", "before that (a tenth of it, or until the damping leaves 1e-2)", OPTION_TEXT,
     .initial = NULL},
    {"observable", "OUTPUT", "what is looked at (the scene's)", OPTION_TEXT, .initial = NULL},
    {"range", "LOW:HIGH", "of the observable (its mean and six standard deviations to both sides)",
     OPTION_TEXT, .initial = NULL},
    {"bins", "N", "equal parts of the range (60)", OPTION_INTEGER, 2, RANDOM_BINS, .initial = "60"},
    {"set", "NAME=VALUE", "a number of the scene, with its unit; repeatable", OPTION_TEXT, .many = true},
    {"method", "NAME", "integration method (the scene's)", OPTION_TEXT, .initial = NULL},
    {"tol", "E", "its tolerance (the scene's)", OPTION_NUMBER, 1e-15, 1e-1, .initial = NULL},
    {"svg", "FILE", "a picture of the rows in --out", OPTION_TEXT, .initial = NULL},
    {.name = NULL},
};

static const struct usage usage = {
    .name = "random",
    .words = "SCENE",
    .summary =
        "Statistics of a scene with noise over many realisations: density of the observable, crossing rates "
        "of "
        "levels,\nlength of exceedances, contact loss, with standard errors and beside Nayak's and the "
        "Gaussian closed form\nwhere they hold. Rows of realisations go to --out, and then what they say "
        "together to standard output.",
    .words_help = SCENE_WORDS_HELP,
    .examples =
        "  contactplant random nayak-random --out rows.csv --svg random.svg >random.csv\n"
        "  contactplant random rig --set force.amplitude=0 --set \"force.noise=20 N\" --out noise.csv\n"
        "  contactplant random nayak-random --seeds 1000 --shard 2/8 --out rows2.csv\n",
    .min_words = 1,
    .max_words = 1,
    .table = {own, jobs_options},
};

/* ---- one realisation ---- */

/* Edges of bins in [from, to) are crossed upwards. */
static void cross(const struct random_runs *r, double from, double to, double *up)
{
    double width = (r->high - r->low) / r->n_bins;
    int first = (int)fmax(0.0, ceil((fmin(from, r->high) - r->low) / width));
    for (int i = first; i <= r->n_bins && random_edge(r, i) < to; i++)
        if (random_edge(r, i) >= from)
            up[i] += 1.0;
}

/* A sample more behind y[0], y[1]: the step up to it, and a top or bottom at y[1] that stands out between samples. */
static void add(const struct random_runs *r, const double y[3], double *row)
{
    double *up = &row[RANDOM_BIN + r->n_bins + 1], bend = y[2] - 2.0 * y[1] + y[0];
    double slope = 0.5 * (y[2] - y[0]), top = y[1] - 0.5 * slope * slope / bend;
    if (y[2] > y[1])
        cross(r, y[1], y[2], up);
    if (bend < 0.0 && y[1] >= y[0] && y[1] > y[2])
        cross(r, y[1], top, up);
    if (bend > 0.0 && y[1] <= y[0] && y[1] < y[2])
        cross(r, top, y[1], up);
    double middle = y[2] - 0.5 * (r->low + r->high), bin = (y[2] - r->low) / (r->high - r->low) * r->n_bins;
    row[RANDOM_MEAN] += y[2];
    row[RANDOM_SQUARE] += middle * middle;
    row[RANDOM_BIN + (int)fmin(r->n_bins, fmax(-1.0, floor(bin)))] += 1.0;
}

static const char *begin(const struct random_runs *r, int i, struct plant *pl)
{
    struct scene sc = r->m.scene;
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    for (int k = 0; k < sc.model->n_inputs; k++)
        sc.drive[k].noise_seed = (double)(uint32_t)((uint64_t)sc.drive[k].noise_seed + (uint64_t)i);
    scenes_resolve(&sc, si, drive);
    const struct plant_config c = {.model = sc.model,
                                   .si = si,
                                   .method = r->m.method,
                                   .tick_s = scene_check_step(&sc),
                                   .dilation = 1.0,
                                   .tol = r->m.tol,
                                   .work = r->work};
    const char *why = plant_init(pl, &c);
    if (!why)
        plant_scene_begin(pl, &sc, si, drive);
    maps_drop_books(pl);
    return why;
}

/* Sums over ticks into shares and rates. */
static void finish(const struct random_runs *r, const struct plant *pl, uint32_t switches, double ticks,
                   double *row)
{
    for (int i = RANDOM_MEAN; i < RANDOM_BIN + r->n_bins + 1; i++)
        row[i] /= ticks;
    for (int i = RANDOM_BIN + r->n_bins + 1; i < random_columns(r); i++)
        row[i] /= ticks * pl->tick_s;
    row[RANDOM_FINITE] = 1.0;
    row[RANDOM_OPEN] = pl->loss_time / pl->total_time;
    row[RANDOM_TOUCHES] = 0.5 * (pl->counts.switches - switches) / (ticks * pl->tick_s);
}

const char *random_realise(const struct random_runs *r, int i, double over, double *row)
{
    static struct plant pl;
    double y[3], output[MODEL_OUTPUTS], ticks = ceil(over / scene_check_step(&r->m.scene));
    int asked = (int)r->m.scene.observable;
    const char *why = begin(r, i, &pl);
    if (why)
        return why;
    memset(row, 0, (size_t)random_columns(r) * sizeof *row);
    row[RANDOM_SEED] = i;
    if (!plant_run(&pl, (uint64_t)ceil(r->settle / pl.tick_s)))
        return NULL;
    plant_output(&pl, output);
    y[1] = y[2] = output[asked];
    uint32_t switches = pl.counts.switches;
    pl.loss_time = pl.total_time = 0.0;
    for (double n = 0.0; n < ticks; n += 1.0) {
        if (!plant_run(&pl, 1)) {
            memset(&row[RANDOM_FINITE], 0, (size_t)(random_columns(r) - RANDOM_FINITE) * sizeof *row);
            return NULL;
        }
        plant_output(&pl, output);
        y[0] = y[1], y[1] = y[2], y[2] = output[asked];
        add(r, y, row);
    }
    finish(r, &pl, switches, ticks, row);
    return NULL;
}

/* ---- the command ---- */

static bool compute(void *context, int job, FILE *rows)
{
    const struct random_runs *r = context;
    static double row[RANDOM_BIN + 2 * RANDOM_BINS + 2];
    const char *why = random_realise(r, job, r->over, row);
    if (why)
        return fputs(why, rows) < 0;
    for (int i = 0; i < random_columns(r); i++)
        fprintf(rows, i ? ",%.9g" : "%.9g", row[i]);
    return fputc('\n', rows) != EOF;
}

static int run(struct random_runs *r)
{
    const struct jobs j = {.options = &r->o,
                           .identity = r->identity,
                           .columns = r->columns,
                           .n = r->n,
                           .compute = compute,
                           .context = r};
    maps_warn(&r->o, &r->m);
    int status = jobs_run(&j);
    bool whole = options_given(&r->o, "out") && !options_given(&r->o, "shard");
    return status || !whole ? status : random_report(r);
}

int cmd_random(int argc, char **argv)
{
    struct random_runs r = {.identity = NULL};
    int status;
    if (!options_parse(&r.o, &usage, argc, argv, &status))
        return status;
    status = random_read(&r);
    status = status ? status : run(&r);
    free(r.identity);
    free(r.work);
    return status;
}
