/* watch.c - see watch.h. */
#include "firmware/watch.h"

const char *watch_start(struct watch *w, const struct watch_limits *l, const struct model *m)
{
    *w = (struct watch){.limits = *l};
    if (!model_observable(m, l->observable))
        return "watch: no such observable";
    if (!(l->low < l->high))
        return "watch: the lower limit is not below the upper one";
    w->active = true;
    return NULL;
}

double watch_read(const struct plant *pl, int observable)
{
    const struct model *m = pl->model;
    double output[MODEL_OUTPUTS];
    if (observable == MODEL_EIGENFREQUENCY)
        return m->eigenfrequency(pl->p) * scale_of(&pl->scale, QUANTITY_FREQUENCY);
    if (observable == MODEL_TIME)
        return plant_time(pl);
    if (observable >= m->n_outputs) {
        int i = observable - m->n_outputs;
        return pl->x[i] * scale_of(&pl->scale, m->state_signal[i].quantity);
    }
    m->output(pl->p, pl->excitation.at[2], pl->x, output);
    return output[observable] * scale_of(&pl->scale, m->output_signal[observable].quantity);
}

bool watch_tick(struct watch *w, const struct plant *pl)
{
    if (!w->active)
        return false;
    double value = watch_read(pl, w->limits.observable);
    bool was = w->outside;
    w->outside = !(value >= w->limits.low && value <= w->limits.high);
    if (!w->outside || was)
        return false;
    if (!w->tripped) {
        w->tripped = w->pending = true;
        w->tick = pl->now.tick;
        w->value = value;
    }
    return true;
}

void watch_clear(struct watch *w)
{
    w->outside = w->tripped = w->pending = false;
}
