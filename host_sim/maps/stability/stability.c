/* stability.c - the command contactplant stability: Floquet tongues, energy and contact switches over two
 * numbers. */
#include "host_sim/maps/stability/stability.h"

#include <math.h>
#include <stdlib.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/commands.h"
#include "host_sim/maps/stability/stability_floquet.h"
#include "host_sim/maps/stability/stability_read.h"
#include "host_sim/maps/stability/stability_report.h"
#include "host_sim/scene/plant_of_scene.h"
#include "models/math/elementary.h"

static const struct option stability_options[] = {
    {"map", "floquet|contact",
     "floquet: multipliers of the modulated contact; contact: energy and switches (floquet)", OPTION_TEXT,
     .initial = "floquet", .identity = IDENTITY_INSIDE},
    {"x", "NAME=FROM:TO:N",
     "the number across; :log behind it for equal ratios (the modulation's frequency from 0.25 to 2.5 times "
     "the contact's, 200; or the step)",
     OPTION_TEXT, .initial = NULL, .identity = IDENTITY_INSIDE},
    {"y", "NAME=FROM:TO:N",
     "the number upwards (the modulation from 0 to all of the stiffness, 100; or the stiffness)", OPTION_TEXT,
     .initial = NULL, .identity = IDENTITY_INSIDE},
    {"step", "TIME", "step of the method (the scene's)", OPTION_TEXT, .initial = NULL,
     .identity = IDENTITY_INSIDE},
    {"periods", "N", "periods of the contact at rest that --map contact runs (50)", OPTION_INTEGER, 2, 1e6,
     .initial = "50", .identity = IDENTITY_INSIDE},
    {.name = NULL},
};

const struct usage stability_usage = {
    .name = "stability",
    .words = "[SCENE]",
    .summary = "Maps over two numbers of a scene. floquet: where a modulated stiffness makes the contact's "
               "rest unstable,\nin the plant and in the method with its step, and where the two differ. "
               "contact: where the method makes\nor loses energy, and misses contact switches. NAME is a key "
               "of the scene (damping, force.frequency,\nomega) or step.",
    .words_help = SCENE_WORDS_HELP,
    .examples = "  contactplant stability hertz_rig --method rk4 --step \"0.7 ms\" --out tongues.csv --svg "
                "tongues.svg\n"
                "  contactplant stability kb-fig16-cubic --x Omega=0.5:3:200 --y r=0:1:100 --out tip.csv\n"
                "  contactplant stability rig --map contact --method rk4 --set force.amplitude=60 --out "
                "steps.csv --svg steps.svg\n",
    .max_words = 1,
    .table = {stability_options, maps_options, maps_outputs, jobs_options},
};

/* ---- a cell ---- */

static const double truth_tol = 1e-11, truth_rad = 0.2;

/* Each fills cell[FLOQUET_COLUMNS or CONTACT_COLUMNS], of which y and x are given. NULL, or why there is
 * none. */
static const char *floquet_cell(const struct stability *s, const struct scene *scene, double *cell)
{
    struct stability_tangent t;
    int periods, steps;
    const char *why = stability_tangent_of(scene, &t);
    if (why)
        return why;
    stability_steps(&t, scene->frame_s / t.time_s, &periods, &steps);
    cell[FLOQUET_RATIO] = t.omega / sqrt(t.stiffness);
    cell[FLOQUET_STEPS] = (double)steps / periods;
    cell[FLOQUET_PLANT] = stability_exact(&t);
    cell[FLOQUET_METHOD] = stability_multiplier(&t, s->m.method, s->m.tol, periods, steps);
    return NULL;
}

/* ---- the scene's motion ---- */

struct outcome {
    double energy; /* highest stored energy of the second half above that of rest, J */
    uint32_t switches;
};

static const char *move(const struct scene *scene, const struct plant_config *c, const struct harmonic *drive,
                        uint64_t ticks, struct outcome *r)
{
    static struct plant pl;
    const char *why = plant_init(&pl, c);
    if (why)
        return why;
    double rest = plant_energy(&pl);
    plant_scene_begin(&pl, scene, c->si, drive);
    *r = (struct outcome){.energy = 0.0};
    for (uint64_t i = 0; i < ticks; i++) {
        if (!plant_run(&pl, 1)) {
            r->energy = (double)INFINITY;
            break;
        }
        if (2 * i >= ticks)
            r->energy = fmax(r->energy, plant_energy(&pl) - rest);
    }
    r->switches = pl.counts.switches;
    return NULL;
}

static const char *contact_cell(const struct stability *s, const struct scene *scene, double *cell)
{
    static double scratch[METHOD_SCRATCH];
    double step = scene->frame_s;
    struct scene_point q;
    struct outcome truth, method;
    point_of_scene(scene, &q);
    double rate = scene->model->eigenfrequency(q.p) / q.scale.time_s, finer = ceil(step * rate / truth_rad);
    uint64_t ticks = ticks_begun(2.0 * ELEMENTARY_PI * s->periods, rate * step);
    struct plant_config c = plant_config_of_real_scene(scene, q.si, step / finer, scratch);
    c.method = &auto_method;
    c.tol = truth_tol;
    c.no_ledger = true;
    const char *why = move(scene, &c, q.drive, ticks * (uint64_t)finer, &truth);
    if (why)
        return why;
    c.method = s->m.method;
    c.tick_s = step;
    c.tol = s->m.tol;
    c.force = true;
    why = move(scene, &c, q.drive, ticks, &method);
    if (why)
        return why;
    cell[CONTACT_STEP] = step * rate;
    cell[CONTACT_SWITCHES] = truth.switches;
    cell[CONTACT_OF_METHOD] = method.switches;
    cell[CONTACT_ENERGY] = method.energy / truth.energy;
    return NULL;
}

/* ---- the map ---- */

static bool compute(void *context, int job, FILE *rows)
{
    const struct stability *s = context;
    struct scene scene = s->m.scene;
    double cell[CONTACT_COLUMNS + FLOQUET_COLUMNS];
    cell[0] = range_value(&s->y.values, job);
    scene_range_set(&scene, &s->y, cell[0]);
    for (int i = 0; i < s->x.values.n; i++) {
        cell[1] = range_value(&s->x.values, i);
        scene_range_set(&scene, &s->x, cell[1]);
        const char *why = (s->map == STABILITY_FLOQUET ? floquet_cell : contact_cell)(s, &scene, cell);
        if (why) {
            rewind(rows);
            fprintf(rows, "at %s = %g and %s = %g: %s", s->y.column, cell[0], s->x.column, cell[1], why);
            return false;
        }
        rows_write(&s->m.rows, cell, true, rows);
        if (s->map == STABILITY_CONTACT) /* a floquet row takes no longer than handing over its cells */
            jobs_piece(rows);
    }
    return true;
}

static bool ends(void *context, int job, const char *row)
{
    const struct stability *s = context;
    double last = range_value(&s->x.values, s->x.values.n - 1), cell[CONTACT_COLUMNS + FLOQUET_COLUMNS];
    (void)job;
    return rows_read(&s->m.rows, row, cell) && fabs(cell[1] - last) <= 1e-9 * fabs(last);
}

static int run(struct stability *s)
{
    struct jobs j = {.n = s->y.values.n,
                     .compute = compute,
                     .parts = s->map == STABILITY_CONTACT ? s->x.values.n : 0,
                     .ends = ends,
                     .context = s};
    int status = maps_compute(&s->m, &j);
    return status ? status : maps_conclude(&s->m, NULL, &stability_finding, s);
}

int cmd_stability(int argc, char **argv)
{
    struct stability s = {.periods = 0};
    int status;
    if (!options_parse(&s.m.o, &stability_usage, argc, argv, &status))
        return status;
    status = stability_read(&s);
    status = status ? status : run(&s);
    free(s.m.identity);
    return status;
}
