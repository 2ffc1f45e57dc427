/* random_realise.c - see random_realise.h. */
#include "host_sim/maps/random/random_realise.h"

#include <math.h>
#include <string.h>
#include "firmware/plant/plant_report.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/scene/plant_of_scene.h"
#include "host_sim/scene/scene_check.h"

/* Counts an up-crossing of each edge in [from, to). */
static void cross(const struct random_runs *r, double from, double to, double *up)
{
    double width = (r->high - r->low) / r->n_bins;
    int first = (int)fmax(0.0, ceil((fmin(from, r->high) - r->low) / width));
    for (int i = first; i <= r->n_bins && random_edge(r, i) < to; i++)
        if (random_edge(r, i) >= from)
            up[i] += 1.0;
}

/* Adds sample y[2], which follows y[0] and y[1]: the step up to it, and the top or bottom beside y[1]. */
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
    struct plant_config c = plant_config_of_real_scene(&sc, si, 0.0, r->scratch);
    c.no_ledger = true;
    return plant_of_scene(pl, &c, &sc, drive);
}

/* Turns sums over ticks into shares and rates. */
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
    double y[3], output[MODEL_OUTPUTS], ticks = ceil(ticks_in(over, scene_check_step(&r->m.scene)));
    int asked = (int)r->m.scene.observable;
    const char *why = begin(r, i, &pl);
    if (why)
        return why;
    memset(row, 0, (size_t)random_columns(r) * sizeof *row);
    row[RANDOM_SEED] = i;
    if (!plant_run(&pl, ticks_begun(r->settle, pl.tick_s)))
        return NULL;
    plant_output(&pl, output);
    y[1] = y[2] = output[asked];
    uint32_t switches = pl.counts.switches;
    plant_begin_record(&pl);
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
