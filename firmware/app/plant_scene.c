/* plant_scene.c - see plant_scene.h. */
#include "firmware/app/plant_scene.h"

#include "models/math/elementary.h"

static void begin_drive(struct plant *pl, int i, const struct harmonic *d, const struct scene_drive *noise)
{
    double step = pl->tick_s / pl->dilation; /* real seconds */
    if (d->amplitude != 0.0)
        plant_drive_start(pl, i, d->amplitude, d->omega / (2.0 * ELEMENTARY_PI * pl->dilation), d->phase);
    if (noise->noise > 0.0)
        plant_noise(pl, i, noise->noise, (uint32_t)scenes_noise_steps(noise, step),
                    (uint32_t)noise->noise_seed, 0.0);
}

void plant_scene_begin(struct plant *pl, const struct scene *s, const double *si,
                       const struct harmonic *drive)
{
    double x[MODEL_STATES];
    for (int i = 0; i < pl->model->n_inputs; i++)
        begin_drive(pl, i, &drive[i], &s->drive[i]);
    scenes_begin(s, si, drive, x);
    plant_set_state(pl, x);
}

bool plant_scene_watch(const struct scene *s, double dilation, struct watch_limits *l)
{
    const struct scene_watch *w = &s->watch;
    if (w->on == 0.0)
        return false;
    int i = (int)w->observable;
    enum quantity q = model_observable(s->model, i)->quantity;
    double unit = scenes_watch_unit(s);
    if (q == QUANTITY_VELOCITY || q == QUANTITY_FREQUENCY)
        unit /= dilation;
    if (q == QUANTITY_TIME)
        unit *= dilation;
    *l = (struct watch_limits){i, w->below * unit, w->above * unit};
    return true;
}
