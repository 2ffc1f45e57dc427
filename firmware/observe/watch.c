/* watch.c - see watch.h. */
#include "firmware/observe/watch.h"
#include "firmware/plant/plant_report.h"

const char *watch_start(struct watch *w, const struct watch_limits *l, const struct model *m)
{
    *w = (struct watch){.limits = *l};
    if (!model_observable(m, l->observable))
        return "watch: no such observable";
    if (!(l->low < l->high))
        return "watch: the lower limit is not below the upper one";
    w->state = model_observable_state(m, l->observable);
    w->active = true;
    return NULL;
}

/* Hz. A frequency without amplitude is none. */
static double drive_frequency(const struct plant *pl)
{
    double most = 0.0; /* turns per tick */
    for (int i = 0; i < pl->model->n_inputs; i++) {
        const struct drive *d = &pl->drive[i];
        double turns = d->amplitude != 0.0 ? drive_turns_per_tick(d) : 0.0;
        most = turns > most ? turns : most;
    }
    return most / pl->tick_s;
}

/* state: that is this observable, -1: it is none. */
static double read(const struct plant *pl, int observable, int state)
{
    const struct model *m = pl->model;
    double output[MODEL_OUTPUTS];
    if (state >= 0)
        return pl->x[state] * scale_of(&pl->scale, m->state_signal[state].quantity);
    if (observable == MODEL_EIGENFREQUENCY)
        return m->eigenfrequency(pl->p) * scale_of(&pl->scale, QUANTITY_FREQUENCY);
    if (observable == MODEL_TIME)
        return plant_time(pl);
    if (observable == MODEL_CHANGES)
        return pl->counts.changes;
    if (observable == MODEL_DRIVE_FREQUENCY)
        return drive_frequency(pl);
    m->output(pl->p, pl->segment.at[2], pl->x, output);
    return output[observable] * scale_of(&pl->scale, m->output_signal[observable].quantity);
}

double watch_read(const struct plant *pl, int observable)
{
    return read(pl, observable, model_observable_state(pl->model, observable));
}

bool watch_tick(struct watch *w, const struct plant *pl)
{
    if (!w->active)
        return false;
    double value = read(pl, w->limits.observable, w->state);
    bool was = w->outside;
    w->outside = !(value >= w->limits.low && value <= w->limits.high);
    if (!w->outside || was)
        return false;
    if (!w->tripped) {
        w->tripped = true;
        w->number++;
        w->tick = pl->now.tick;
        w->value = value;
    }
    return true;
}

void watch_clear(struct watch *w)
{
    w->outside = w->tripped = false;
}
