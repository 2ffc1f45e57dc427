/* plant_of_scene.c - see plant_of_scene.h. */
#include "host_sim/scene/plant_of_scene.h"

#include "firmware/app/plant_scene.h"
#include "firmware/plant/plant_change.h"
#include "host_sim/scene/scene_check.h"

void point_of_scene(const struct scene *s, struct scene_point *q)
{
    scenes_resolve(s, q->si, q->drive);
    s->model->prepare(q->si, q->p, &q->scale);
}

struct plant_config plant_config_of_scene(const struct scene *s, const double *si, double *scratch)
{
    return (struct plant_config){.model = s->model,
                                 .si = si,
                                 .method = method_find(s->method),
                                 .tick_s = s->frame_s / s->substeps,
                                 .dilation = s->dilation,
                                 .tol = s->tolerance,
                                 .scratch = scratch};
}

struct plant_config plant_config_of_real_scene(const struct scene *s, const double *si, double tick_s,
                                               double *scratch)
{
    struct plant_config c = plant_config_of_scene(s, si, scratch);
    c.tick_s = tick_s > 0.0 ? tick_s : scene_check_step(s);
    c.dilation = 1.0;
    return c;
}

const char *plant_of_scene(struct plant *pl, const struct plant_config *c, const struct scene *s,
                           const struct harmonic *drive)
{
    const char *why = plant_init(pl, c);
    if (!why)
        plant_scene_begin(pl, s, c->si, drive);
    return why;
}
