/* series.c - see series.h. */
#include "host_sim/fit/motion/series.h"

#include <math.h>
#include "firmware/plant/plant_report.h"

enum { CONTACT_TICKS = 8, FINE = 5, TICKS_MOST = 10000 };

/* Ticks in a step: enough of them in a period of contact and drive. */
static const char *set_up(const struct orbit_task *t, const struct record *r, struct plant *pl, int *ticks)
{
    double contact_Hz;
    const char *why = orbit_contact(t, &contact_Hz);
    if (why)
        return why;
    double periods = r->step_s * fmax(contact_Hz, r->tone.amplitude > 0.0 ? r->tone.frequency_Hz : 0.0);
    double wanted = fmax(1.0, ceil((t->method->order > 0 ? FINE : 1) * CONTACT_TICKS * periods));
    if (!(wanted <= TICKS_MOST))
        return "the steps are too long beside the contact";
    *ticks = (int)wanted;
    return orbit_plant(t, r->step_s / *ticks, pl);
}

/* The drive behind time i. */
static void drive(struct plant *pl, const struct orbit_task *t, const struct record *r, int i, double gain,
                  int ticks)
{
    if (r->input >= 0 && r->u)
        plant_sample(pl, t->input, gain * r->u[i + 1], r->jumps ? 0 : (uint64_t)ticks);
}

bool series_run(const struct orbit_task *t, const struct record *r, const double *x, double gain,
                double phase_rad, double *y)
{
    struct plant pl;
    double own[MODEL_STATES], output[MODEL_OUTPUTS];
    int ticks;
    if (set_up(t, r, &pl, &ticks))
        return false;
    for (int i = 0; i < t->model->n_states; i++)
        own[i] = x[i] / scale_of(&pl.scale, t->model->state_signal[i].quantity);
    plant_set_state(&pl, own);
    if (r->input >= 0 && r->u)
        plant_sample(&pl, t->input, gain * r->u[0], 0);
    if (r->tone.amplitude > 0.0)
        plant_drive_start(&pl, t->input, gain * r->tone.amplitude, r->tone.frequency_Hz, phase_rad);
    for (int i = 0; i < r->n; i++) {
        plant_output(&pl, output);
        y[i] = output[t->output];
        if (i + 1 == r->n)
            break;
        drive(&pl, t, r, i, gain, ticks);
        if (orbit_stopped(t) || !plant_run(&pl, (uint64_t)ticks))
            return false;
    }
    return true;
}
