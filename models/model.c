/* model.c - observables and promotion of any model; see model.h. */
#include "models/model.h"

#include <stddef.h>
#include "models/math/elementary.h"

bool model_same_name(const char *a, const char *b)
{
    while (*a && *a == *b)
        a++, b++;
    return *a == *b;
}

static const struct signal eigenfrequency = {
    "eigenfrequency", "Hz", "eigenfrequency of the closed contact at rest, the fastest if there are several",
    QUANTITY_FREQUENCY, NULL};

static const struct signal drive_frequency = {"drive_frequency", "Hz",
                                              "the highest of the harmonic drives that sound, 0 in silence",
                                              QUANTITY_FREQUENCY, NULL};

static const struct signal time_signal = {"time", "s", "time of the plant since its start", QUANTITY_TIME,
                                          NULL};

static const struct signal changes = {
    "changes", "", "commands that changed drives, parameters or state since the start", QUANTITY_RATIO, NULL};

static bool is_output(const struct model *m, const char *name)
{
    for (int i = 0; i < m->n_outputs; i++)
        if (model_same_name(m->output_signal[i].name, name))
            return true;
    return false;
}

int model_observable_state(const struct model *m, int i)
{
    int number = m->n_outputs;
    if (i >= MODEL_DRIVE_FREQUENCY) /* the last states of the AFM lever have no number */
        return -1;
    for (int k = 0; k < m->n_states; k++)
        if (!is_output(m, m->state_signal[k].name) && number++ == i)
            return k;
    return -1;
}

const struct signal *model_observable(const struct model *m, int i)
{
    int state = model_observable_state(m, i);
    if (state >= 0)
        return &m->state_signal[state];
    if (i == MODEL_DRIVE_FREQUENCY)
        return &drive_frequency;
    if (i == MODEL_TIME)
        return &time_signal;
    if (i == MODEL_CHANGES)
        return &changes;
    if (i == MODEL_EIGENFREQUENCY)
        return &eigenfrequency;
    return i >= 0 && i < m->n_outputs ? &m->output_signal[i] : NULL;
}

const char *model_climb_refused(const struct model *from, const struct model *to)
{
    if (!from->full)
        return "this is a full model already: there is nothing to climb to";
    if (!from->climb)
        return "an averaged model cannot climb: its state is the slow motion, what the fast drive adds is "
               "not in it";
    if (to != from->full)
        return "not the full model that this reduced model stands for";
    return NULL;
}

/* A function, because inlined it would take 1 kB more. */
double scale_of(const struct scale *s, enum quantity q)
{
    /* Time stands apart: with it the switch would be a jump table on RISC-V, which the check of the stack
     * cannot follow. */
    if (q == QUANTITY_TIME)
        return s->time_s;
    switch (q) {
    case QUANTITY_LENGTH:
        return s->length_m;
    case QUANTITY_VELOCITY:
        return s->length_m / s->time_s;
    case QUANTITY_FORCE:
        return s->force_N;
    case QUANTITY_FREQUENCY:
        return 1.0 / (2.0 * ELEMENTARY_PI * s->time_s);
    case QUANTITY_RATIO:
    case QUANTITY_TIME:
        break;
    }
    return 1.0;
}
