/* stability.c - the command contactplant stability: Floquet tongues, energy and contact switches over two
 * numbers. */
#include "host_sim/maps/stability/stability.h"

#include <math.h>
#include <stdlib.h>
#include "host_sim/commands.h"
#include "host_sim/maps/stability/stability_cell.h"
#include "host_sim/maps/stability/stability_figure.h"
#include "host_sim/maps/stability/stability_read.h"
#include "host_sim/maps/stability/stability_tell.h"

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
        const char *why =
            (s->map == STABILITY_FLOQUET ? stability_floquet_cell : stability_contact_cell)(s, &scene, cell);
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
    static const struct maps_finding found = {.tell = stability_tell, .draw = stability_draw};
    return status ? status : maps_conclude(&s->m, NULL, &found, s);
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
