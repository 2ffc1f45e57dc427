/* series.c - see series.h. */
#include "host_sim/fit/motion/series.h"

#include <math.h>
#include "models/math/elementary.h"

enum { CONTACT_TICKS = 8, FINE = 5, TICKS_MOST = 10000 };

/* Ticks in a step: enough of them in a period of the contact. */
static const char *set_up(const struct orbit_task *t, double step_s, struct plant *pl, int *ticks)
{
    double p[MODEL_DERIVED];
    struct scale scale;
    int which;
    const char *why = plant_check(t->model, t->si, &which);
    if (why)
        return why;
    t->model->prepare(t->si, p, &scale);
    double periods = step_s * t->model->eigenfrequency(p) / (2.0 * ELEMENTARY_PI * scale.time_s);
    double wanted = fmax(1.0, ceil((t->method->order > 0 ? FINE : 1) * CONTACT_TICKS * periods));
    if (!(wanted <= TICKS_MOST))
        return "the steps are too long beside the contact";
    *ticks = (int)wanted;
    const struct plant_config c = {.model = t->model,
                                   .si = t->si,
                                   .method = t->method,
                                   .tick_s = step_s / *ticks,
                                   .dilation = 1.0,
                                   .tol = t->tol,
                                   .no_ledger = true,
                                   .scratch = t->scratch};
    return plant_init(pl, &c);
}

bool series_run(const struct orbit_task *t, const double *x, double step_s, int n, const double *u, double *y)
{
    struct plant pl;
    double own[MODEL_STATES], output[MODEL_OUTPUTS];
    int ticks;
    if (set_up(t, step_s, &pl, &ticks))
        return false;
    for (int i = 0; i < t->model->n_states; i++)
        own[i] = x[i] / scale_of(&pl.scale, t->model->state_signal[i].quantity);
    plant_set_state(&pl, own);
    if (u)
        plant_sample(&pl, t->input, u[0], 0);
    for (int i = 0; i < n; i++) {
        plant_output(&pl, output);
        y[i] = output[t->output];
        if (u && i + 1 < n)
            plant_sample(&pl, t->input, u[i + 1], (uint64_t)ticks);
        if (i + 1 < n && !plant_run(&pl, (uint64_t)ticks))
            return false;
    }
    return true;
}
