/* stability_cell.c - see stability_cell.h. */
#include "host_sim/maps/stability/stability_cell.h"

#include <math.h>
#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "firmware/plant/plant_report.h"
#include "host_sim/cli/ticks.h"
#include "host_sim/maps/stability/stability_floquet.h"
#include "host_sim/scene/plant_of_scene.h"
#include "models/math/elementary.h"

static const double truth_tol = 1e-11, truth_rad = 0.2;

const char *stability_floquet_cell(const struct stability *s, const struct scene *scene, double *cell)
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

const char *stability_contact_cell(const struct stability *s, const struct scene *scene, double *cell)
{
    static double scratch[METHOD_SCRATCH];
    double step = scene->frame_s;
    struct maps_point q;
    struct outcome truth, method;
    maps_resolve(scene, &q);
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
