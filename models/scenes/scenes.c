/* scenes.c - resolves a scene into parameters, drives, start and the watched number; see scenes.h. */
#include "models/scenes/scenes.h"

#include <stddef.h>
#include <stdint.h>
#include "models/math/elementary.h"
#include "models/scenes/scenes_table.h"

const struct preset *scenes_find(const char *name)
{
    for (int i = 0; i < SCENES; i++) {
        if (model_same_name(scenes_table[i].name, name))
            return &scenes_table[i];
    }
    return NULL;
}

void scenes_default(struct scene *s, const struct model *m)
{
    *s = (struct scene){.model = m,
                        .method = "auto",
                        .observable = 2, /* penetration */
                        .over = 10.0,
                        .tolerance = 1e-4,
                        .frame_s = 1e-3,
                        .substeps = 64,
                        .dilation = 1.0};
    if (m->modal_form) { /* a lever's period is some microseconds */
        s->dilation = 100.0;
        s->over = 0.01;
    }
    for (int i = 0; i < m->n_parameters; i++)
        s->value[i] = m->parameter[i].initial;
}

bool scenes_dimensionless(const struct scene *s)
{
    const struct model *m = s->model;
    for (int i = 0; s->paper && i < m->n_paper; i++) {
        if (!model_same_name(m->paper[i].unit, "1") && !model_same_name(m->paper[i].unit, "rad"))
            return false;
    }
    return s->paper;
}

void scenes_resolve(const struct scene *s, double *si, struct harmonic *drive)
{
    const struct model *m = s->model;
    for (int i = 0; i < m->n_parameters; i++)
        si[i] = s->value[i];
    for (int i = 0; i < m->n_inputs; i++)
        drive[i] = (struct harmonic){s->drive[i].amplitude, 2.0 * ELEMENTARY_PI * s->drive[i].frequency_Hz,
                                     s->drive[i].phase_rad};
    if (s->paper)
        m->from_paper(s->value, si, drive);
}

/* An input at time 0, model units. */
static struct input first_input(const struct harmonic *d, double unit, double time_s)
{
    double cosine, sine;
    cos_sin(d->phase, &cosine, &sine);
    return (struct input){d->amplitude * cosine / unit, -d->amplitude * d->omega * sine / unit * time_s};
}

void scenes_inputs(const struct model *m, const struct scale *scale, const struct harmonic *drive,
                   struct input *u)
{
    for (int i = 0; i < m->n_inputs; i++)
        u[i] = first_input(&drive[i], scale_of(scale, m->input_signal[i].quantity), scale->time_s);
}

const char *scenes_state_name(const struct scene *s, int i)
{
    const struct signal *g = &s->model->state_signal[i];
    return s->paper ? g->paper_name : g->name;
}

void scenes_show_state(const struct scene *s, const double *p, const struct scale *scale,
                       const struct input *u, const double *x, double *shown)
{
    const struct model *m = s->model;
    if (s->paper)
        m->paper_state(p, u, x, shown);
    for (int i = 0; i < m->n_states && !s->paper; i++)
        shown[i] = x[i] * scale_of(scale, m->state_signal[i].quantity);
}

void scenes_take_state(const struct scene *s, const double *p, const struct scale *scale,
                       const struct input *u, const double *shown, double *x)
{
    const struct model *m = s->model;
    if (s->paper)
        m->state_from_paper(p, u, shown, x);
    for (int i = 0; i < m->n_states && !s->paper; i++)
        x[i] = shown[i] / scale_of(scale, m->state_signal[i].quantity);
}

/* Everything about time 0, model units. */
struct beginning {
    double p[MODEL_DERIVED], x[MODEL_STATES];
    struct scale scale;
    struct input u[MODEL_INPUTS];
};

static void begin(const struct scene *s, const double *si, const struct harmonic *drive, struct beginning *b)
{
    const struct model *m = s->model;
    m->prepare(si, b->p, &b->scale);
    m->rest(b->p, b->x);
    scenes_inputs(m, &b->scale, drive, b->u);
    if (s->started)
        scenes_take_state(s, b->p, &b->scale, b->u, s->start, b->x);
}

void scenes_begin(const struct scene *s, const double *si, const struct harmonic *drive, double *x)
{
    struct beginning b;
    begin(s, si, drive, &b);
    for (int i = 0; i < s->model->n_states; i++)
        x[i] = b.x[i];
}

double scenes_watch_unit(const struct scene *s)
{
    enum quantity q = model_observable(s->model, s->watch.observable)->quantity;
    bool angular = q == QUANTITY_FREQUENCY && scenes_dimensionless(s);
    return angular ? 1.0 / (2.0 * ELEMENTARY_PI) : 1.0;
}

/* Hz, the highest of the harmonic drives that sound. */
static double highest_drive(const struct model *m, const struct harmonic *drive)
{
    double omega = 0.0;
    for (int i = 0; i < m->n_inputs; i++)
        if (drive[i].amplitude != 0.0 && drive[i].omega > omega)
            omega = drive[i].omega;
    return omega / (2.0 * ELEMENTARY_PI);
}

double scenes_watched(const struct scene *s, const double *si, const struct harmonic *drive)
{
    const struct model *m = s->model;
    struct beginning b;
    double output[MODEL_OUTPUTS], value;
    int which = s->watch.observable, state = model_observable_state(m, which);
    begin(s, si, drive, &b);
    if (which == MODEL_TIME || which == MODEL_CHANGES)
        return 0.0;
    if (which == MODEL_DRIVE_FREQUENCY)
        return highest_drive(m, drive) / scenes_watch_unit(s);
    m->output(b.p, b.u, b.x, output);
    value = which == MODEL_EIGENFREQUENCY ? m->eigenfrequency(b.p) : state >= 0 ? b.x[state] : output[which];
    return value * scale_of(&b.scale, model_observable(m, which)->quantity) / scenes_watch_unit(s);
}

double scenes_noise_steps(const struct scene_drive *d, double step)
{
    double steps = d->noise_hold / step + 0.5;
    if (!(steps >= 2.0))
        return 1.0;
    return steps < 1e15 ? (double)(int64_t)steps : steps;
}
