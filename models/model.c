/* model.c - what can be said of any model; see model.h. */
#include "models/model.h"

#include <stddef.h>

bool model_same_name(const char *a, const char *b)
{
    while (*a && *a == *b)
        a++, b++;
    return *a == *b;
}

static const struct signal eigenfrequency = {
    "eigenfrequency", "Hz", "of the closed contact at rest, the fastest if there are several",
    QUANTITY_FREQUENCY, NULL};

static const struct signal time_signal = {"time", "s", "of the plant since its start", QUANTITY_TIME, NULL};

const struct signal *model_observable(const struct model *m, int i)
{
    int state = i - m->n_outputs;
    if (i == MODEL_EIGENFREQUENCY)
        return &eigenfrequency;
    if (i == MODEL_TIME)
        return &time_signal;
    if (i < 0 || state >= m->n_states)
        return NULL;
    if (state < 0)
        return &m->output_signal[i];
    for (int k = 0; k < m->n_outputs; k++)
        if (model_same_name(m->output_signal[k].name, m->state_signal[state].name))
            return NULL;
    return &m->state_signal[state];
}

const char *model_climb_refused(const struct model *from, const struct model *to)
{
    if (!from->full)
        return "this is a full model already: there is nothing to climb to";
    if (!from->climb)
        return "an averaged rung cannot climb: its state is the slow motion, what the fast drive adds is not "
               "in "
               "it";
    if (to != from->full)
        return "not the full model that this rung stands for";
    return NULL;
}
