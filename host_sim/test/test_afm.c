/* test_afm.c - see test_afm.h. */
#include "host_sim/test/test_afm.h"

#include <math.h>
#include <string.h>
#include "models/math/elementary.h"

enum { OPEN_PERIODS = 2 /* periods of the lever or of z without a force: off the surface */ };
static const double deg_per_rad = 180.0 / ELEMENTARY_PI;

static const struct signal output[VIEW_OUTPUTS] = {
    [VIEW_AMPLITUDE] = {"amplitude", "m", "of the first tone, by the lock-in", QUANTITY_LENGTH, NULL},
    [VIEW_PHASE] = {"phase", "deg", "its phase; -90 at the free resonance", QUANTITY_RATIO, NULL},
    [VIEW_AMPLITUDE_2] = {"amplitude_2", "m", "of the second tone, that of DART", QUANTITY_LENGTH, NULL},
    [VIEW_DEFLECTION] = {"deflection", "m", "reading of the sensor", QUANTITY_LENGTH, NULL},
    [VIEW_Z] = {"z", "m", "true place of the base over its start", QUANTITY_LENGTH, NULL},
    [VIEW_ERROR] = {"error", "m", "of the z loop: how much the tip is too far away", QUANTITY_LENGTH, NULL},
    [VIEW_FORCE] = {"contact_force", "N", "largest in the sample, 0 apart", QUANTITY_FORCE, NULL},
    [VIEW_SURFACE] = {"surface", "m", "height below the tip", QUANTITY_LENGTH, NULL},
    [VIEW_CRASHES] = {"crashes", "1", "so far", QUANTITY_RATIO, NULL},
    [VIEW_PEAK_FORCE] = {"cycle_force", "N", "peak of the last cycle of peak_force, as the loop has it",
                         QUANTITY_FORCE, NULL},
    [VIEW_ADHESION] = {"adhesion", "N", "of the last cycle of peak_force", QUANTITY_FORCE, NULL},
    [VIEW_MODULUS] = {"modulus", "Pa", "of the last cycle, 0: not found", QUANTITY_RATIO, NULL},
    [VIEW_SNAP_IN] = {"snap_in", "N", "deepest force of the last cycle before its peak", QUANTITY_FORCE,
                      NULL},
    [VIEW_BASELINE] = {"baseline", "N", "force of its far half: the zero of the others", QUANTITY_FORCE,
                       NULL},
};

static const struct signal input[VIEW_INPUTS] = {
    [VIEW_IN_FORCE] = {"force", "N", "on the tip", QUANTITY_FORCE, NULL},
    [VIEW_IN_Z] = {"z", "m", "of the base, where no loop sets it", QUANTITY_LENGTH, NULL},
    [VIEW_IN_X] = {"x", "m", "place over the surface", QUANTITY_LENGTH, NULL},
    [VIEW_IN_Y] = {"y", "m", "place over the surface", QUANTITY_LENGTH, NULL},
};

const struct model test_afm_view = {
    .name = "microscope",
    .title = "an AFM lever with the loops of a microscope",
    .n_inputs = VIEW_INPUTS,
    .n_outputs = VIEW_OUTPUTS,
    .n_contacts = 1,
    .input_signal = input,
    .output_signal = output,
};

const char *test_afm_refuse(const struct test_case *c)
{
    for (int i = 0; i < c->n_expects; i++)
        if (c->expect[i].what.kind == METRIC_IMPACT_SPEED || c->expect[i].what.kind == METRIC_WATCH ||
            c->expect[i].what.kind == METRIC_RESIDUAL)
            return "expect: a microscope tells no impact_speed, watch or residual";
    for (int i = 0; i < c->n_acts; i++)
        for (int k = 0; k < c->act[i].what.n; k++)
            if (c->act[i].what.set[k].index < LEVER_PARAMETERS)
                return "at: set: the lever stays as it is; numbers of the microscope may change";
    return NULL;
}

void test_afm_read(const struct station *s, const struct microscope_in *in, double *value)
{
    const double now[VIEW_OUTPUTS + VIEW_INPUTS] = {
        [VIEW_AMPLITUDE] = s->lockin[0].amplitude,
        [VIEW_PHASE] = demodulator_phase(&s->lockin[0]) * deg_per_rad,
        [VIEW_AMPLITUDE_2] = s->lockin[1].amplitude,
        [VIEW_DEFLECTION] = s->out.deflection_m,
        [VIEW_Z] = s->out.z_m,
        [VIEW_ERROR] = s->error_m,
        [VIEW_FORCE] = s->out.peak_N,
        [VIEW_SURFACE] = s->out.surface_m,
        [VIEW_CRASHES] = s->microscope.n_crashes,
        [VIEW_PEAK_FORCE] = s->swing.cycle.peak_N,
        [VIEW_ADHESION] = s->swing.cycle.adhesion_N,
        [VIEW_MODULUS] = s->swing.cycle.modulus_Pa,
        [VIEW_SNAP_IN] = s->swing.cycle.snap_in_N,
        [VIEW_BASELINE] = s->swing.cycle.baseline_N,
        [VIEW_OUTPUTS + VIEW_IN_FORCE] = in->force_N,
        [VIEW_OUTPUTS + VIEW_IN_Z] = in->z_m,
        [VIEW_OUTPUTS + VIEW_IN_X] = in->x_m,
        [VIEW_OUTPUTS + VIEW_IN_Y] = in->y_m,
    };
    memcpy(value, now, sizeof now);
    value[VIEW_OUTPUTS + VIEW_INPUTS] = s->number[STATION_DRIVE] > 0.0 ? s->frequency_Hz : 0.0;
}

static void tell_switch(struct test_afm *t, const struct station *s, uint64_t at, bool touch,
                        struct measurement *m, int n)
{
    struct event e = {.tick = at, .touch = touch, .peak_force = touch ? 0.0 : t->peak_N};
    t->open = !touch;
    for (int i = 0; i < n; i++) {
        measurement_switch(&m[i], (double)at * s->sample_s, t->open);
        measurement_event(&m[i], &e);
    }
    t->peak_N = 0.0;
}

/* The contact opened when it was touched last, which shows a while later. */
void test_afm_watch(struct test_afm *t, const struct station *s, uint64_t sample, struct measurement *m,
                    int n)
{
    double away_s = (double)(sample - t->touched) * s->sample_s, force = s->out.peak_N;
    double turns_Hz = station_swings(s->number) ? s->frequency_Hz : s->f0_Hz;
    if (force > 0.0) {
        if (t->open)
            tell_switch(t, s, sample, true, m, n);
        t->touched = sample;
        t->peak_N = fmax(t->peak_N, force);
    } else if (!t->open && away_s > OPEN_PERIODS / turns_Hz)
        tell_switch(t, s, t->touched, false, m, n);
}
