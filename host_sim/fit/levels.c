/* levels.c - see levels.h. */
#include "host_sim/fit/levels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/cli/clock.h"
#include "host_sim/cli/unit.h"
#include "host_sim/fit/motion/linear.h"
#include "host_sim/fit/plan.h"
#include "host_sim/fit/solve/unknown.h"
#include "host_sim/fit/tell.h"
#include "host_sim/out/plural.h"
#include "host_sim/out/utf8.h"
#include "models/math/elementary.h"

enum { POINTS = 45, LEVELS = 5 };
static const double low = 0.6, high = 1.25; /* ends of the curves over the resonance */
static const double noise = 0.01;
static const double slowest = 1e-3; /* resonance, over the eigenfrequency of the closed contact */
/* The motion of the linear plant at its resonance, in the model's unit of length: a rig's static compression.
 */
static const double motion[LEVELS] = {0.03, 0.1, 0.3, 1.0, 3.0};

/* The size of the linear response at this frequency; 0: there is none. */
static double respond_at(const struct orbit_task *t, double frequency_Hz)
{
    double re, im;
    return linear_response(t, frequency_Hz, &re, &im) ? sqrt(re * re + im * im) : 0.0;
}

/* The highest peak of the linear response between a share of the closed contact's eigenfrequency, which is
 * the fastest, and 1.1 of it; without a peak, that eigenfrequency. A shaft with open gaps moves far below. */
static double find_peak(const struct orbit_task *t, double eigenfrequency_Hz)
{
    double at = eigenfrequency_Hz, highest = 0.0, before = HUGE_VAL, here = HUGE_VAL;
    for (double f = slowest * eigenfrequency_Hz; f < 1.1 * eigenfrequency_Hz; f *= 1.0 + 1e-3) {
        double next = respond_at(t, f);
        if (here > before && here >= next && here > highest) {
            highest = here;
            at = f / (1.0 + 1e-3);
        }
        before = here;
        here = next;
    }
    return at;
}

/* The resonance, and the drive for a linear motion of 1 there. False: the drive does not move the output. */
static bool find_resonance(struct fit_setup *s, double *frequency_Hz, double *drive)
{
    struct orbit_task t = s->task;
    double p[MODEL_DERIVED];
    struct scale scale;
    t.amplitude = 1.0;
    t.output = s->scene.observable;
    t.model->prepare(t.si, p, &scale);
    *frequency_Hz = find_peak(&t, t.model->eigenfrequency(p) / (2.0 * ELEMENTARY_PI * scale.time_s));
    double motion_of_1 = respond_at(&t, *frequency_Hz);
    *drive =
        motion_of_1 > 0.0 ? scale_of(&scale, t.model->output_signal[t.output].quantity) / motion_of_1 : 0.0;
    return motion_of_1 > 0.0;
}

/* A curve of this drive behind those that are there. */
static bool add_curve(struct fit_setup *s, double frequency_Hz, double drive)
{
    int c = s->data.n;
    struct curve *curve = &s->data.curve[c];
    *curve = (struct curve){
        .path = "plan", .amplitude = drive, .output = s->scene.observable, .has_phase = true, .n = POINTS};
    curve->point = calloc(POINTS, sizeof *curve->point);
    s->point[c] = calloc(POINTS, sizeof *s->point[c]);
    s->data.n = s->n_active = c + 1;
    s->n_residuals += 2 * POINTS;
    for (int i = 0; curve->point && i < POINTS; i++)
        curve->point[i] = (struct curve_point){
            .frequency_Hz = frequency_Hz * (low + (high - low) * i / (POINTS - 1)), .sigma = 1.0};
    return curve->point && s->point[c];
}

static void drop_curves(struct fit_setup *s)
{
    for (int c = 0; c < s->data.n; c++) {
        free(s->point[c]);
        s->point[c] = NULL;
        s->smooth[c] = false;
    }
    curves_free(&s->data);
    s->n_active = s->n_residuals = 0;
}

/* lost: points that do not count. */
static void print_row(const struct fit_setup *s, const struct fit_result *r, bool known, int lost,
                      const char *drives)
{
    printf("  %-*s", utf8_field(drives, 22), drives);
    for (int k = 0; k < s->n; k++) {
        char text[UNIT_TEXT];
        const char *width = known ? tell_width(&s->unknown[k], r->sd[k], text) : "no motion";
        printf(" %-*s", utf8_field(width, 13), width);
    }
    if (known && lost)
        printf(" without %d point%s, where no settled motion is found", lost, plural(lost));
    putchar('\n');
}

/* One row: a curve at drive b, and one at drive a if that is above 0. */
static int tell_row(struct fit_setup *s, const double *u, double frequency_Hz, double a, double b)
{
    struct fit_result r = {.chi2 = 0.0};
    const char *unit = s->scene.model->input_signal[0].unit;
    char text[2][UNIT_TEXT], drives[2 * UNIT_TEXT + 8];
    unit_tell(a, 2, unit, text[0]);
    unit_tell(b, 2, unit, text[1]);
    snprintf(drives, sizeof drives, a > 0.0 ? "%s and %s" : "%s%s", a > 0.0 ? text[0] : "", text[1]);
    memcpy(r.u, u, sizeof r.u);
    bool room = (!(a > 0.0) || add_curve(s, frequency_Hz, a)) && add_curve(s, frequency_Hz, b);
    int lost = room ? plan_fill(s, u, noise) : -1;
    bool known = lost >= 0 && starts_spread(s, &r);
    drop_curves(s);
    if (clock_interrupted())
        return options_failure(s->o.usage, "interrupted: the rows after these are left out");
    print_row(s, &r, known, lost, drives);
    return room ? 0 : options_failure(s->o.usage, "out of memory");
}

int levels_tell(struct fit_setup *s)
{
    double u[FIT_UNKNOWNS] = {0.0}, frequency = 0.0, drive = 0.0;
    int status = 0;
    for (int k = 0; k < s->n; k++)
        u[k] = unknown_u(&s->unknown[k], s->unknown[k].start);
    s->noise_known = true;
    if (!find_resonance(s, &frequency, &drive))
        return options_misuse(s->o.usage, "%s: a small %s does not move %s; give another observable in [ask]",
                              s->name, s->scene.model->input_signal[0].name,
                              s->scene.model->output_signal[s->scene.observable].name);
    printf("%s: standard deviations from curves of %d points, %.4g to %.4g Hz, swept up, noise %g %%\n",
           s->name, POINTS, low * frequency, high * frequency, 100.0 * noise);
    printf("  %-22s", "drive");
    for (int k = 0; k < s->n; k++)
        printf(" %-13s", s->unknown[k].name);
    putchar('\n');
    for (int i = 0; i < LEVELS && !status; i++)
        status = tell_row(s, u, frequency, 0.0, motion[i] * drive);
    for (int i = 1; i < LEVELS && !status; i++)
        status = tell_row(s, u, frequency, motion[0] * drive, motion[i] * drive);
    return status;
}
