/* test_sweep_meter.c - harmonics, mean and extremes of outputs that bend or jump at the contact, against
 * closed forms.
 *
 * A tip whose sample has next to no stiffness (k0 = 1e-9 of the lever's) moves as a linear lever, x = m +
 * A cos(theta + phi). Its penetration is a cosine cut off at zero, its force the 3/2 power of that, its
 * flag a rectangle. Their harmonics are
 *
 *     c_n = (2/pi) integral_0^alpha g(m + A cos psi) cos(n psi) dpsi,  alpha = acos(-m/A)
 *
 * They are computed here by Simpson's rule in s, psi = alpha (1 - s^2), where every g is smooth. */
#include "host_sim/maps/sweep/sweep_meter.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include "firmware/plant/plant_change.h"
#include "models/afm_tip.h"
#include "models/math/elementary.h"
#include "models/shaft_bearing.h"
#include "tests/unit/test.h"

enum {
    PERIODS = 6,
    HARMONICS = 4,
    OUTPUT_DISPLACEMENT = 0,
    OUTPUT_PENETRATION = 2,
    OUTPUT_FORCE = 3,
    OUTPUT_FLAG = 4
};

#define OMEGA   0.7
#define DAMPING 0.05
#define GAP     0.5  /* m, of the shaft */
#define K0      1e-9 /* N/m^1.5; the lever has 1 N/m, the indentation is 1 m */

static double scratch[METHOD_SCRATCH];
static const uint32_t harmonic[HARMONICS] = {1, 2, 3, 5};

/* The motion under f cos(theta): middle, amplitude, phase. */
struct motion {
    double middle, amplitude, phase;
};

static struct motion exact_motion(double f)
{
    double re = 1.0 - OMEGA * OMEGA, im = DAMPING * OMEGA;
    return (struct motion){1.0, f / hypot(re, im), -atan2(im, re)};
}

/* ---- the exact harmonics ---- */

static double output_at(int output, double eta)
{
    switch (output) {
    case OUTPUT_DISPLACEMENT:
        return eta;
    case OUTPUT_PENETRATION:
        return eta;
    case OUTPUT_FORCE:
        return K0 * eta * sqrt(eta);
    default:
        return 1.0;
    }
}

/* c_n over cos(n (theta + phi)); the mean for n = 0. */
static double exact_harmonic(int output, const struct motion *x, int n)
{
    enum { PANELS = 4000 };
    bool clipped = output != OUTPUT_DISPLACEMENT && x->amplitude > x->middle;
    double alpha = clipped ? acos(-x->middle / x->amplitude) : ELEMENTARY_PI, sum = 0.0;
    for (int i = 0; i <= PANELS; i++) {
        double s = (double)i / PANELS, psi = alpha * (1.0 - s * s);
        double eta = x->middle + x->amplitude * cos(psi);
        double g = output_at(output, output == OUTPUT_DISPLACEMENT ? eta : fmax(eta, 0.0));
        sum += (i == 0 || i == PANELS ? 1.0 : (i % 2 ? 4.0 : 2.0)) * g * cos(n * psi) * 2.0 * alpha * s;
    }
    return sum / (3.0 * PANELS) * (n == 0 ? 1.0 : 2.0) / ELEMENTARY_PI;
}

/* ---- the meter ---- */

static void measure(int output, double f, double turns, int ticks, int periods, struct sweep_measured *r)
{
    struct plant pl;
    struct sweep_meter m;
    double si[MODEL_PARAMETERS], paper[MODEL_PARAMETERS] = {0};
    struct harmonic drive[MODEL_INPUTS];
    struct motion x = exact_motion(f);
    paper[TIP_PAPER_BETA] = 1.5 * K0;
    paper[TIP_PAPER_C] = DAMPING;
    paper[TIP_PAPER_SIGN] = -1.0;
    afm_tip.from_paper(paper, si, drive);
    const struct plant_config c = {.model = &afm_tip,
                                   .si = si,
                                   .method = &taylor,
                                   .tick_s = 2.0 * ELEMENTARY_PI / OMEGA / ticks,
                                   .dilation = 1.0,
                                   .tol = 1e-12,
                                   .scratch = scratch};
    const char *why = plant_init(&pl, &c);
    *r = (struct sweep_measured){.mean = (double)NAN};
    if (why)
        return;
    double angle = 2.0 * ELEMENTARY_PI * turns + x.phase;
    plant_drive_start(&pl, TIP_FORCE, f, OMEGA / (2.0 * ELEMENTARY_PI), 2.0 * ELEMENTARY_PI * turns);
    plant_set_state(&pl,
                    (const double[]){x.middle + x.amplitude * cos(angle), -x.amplitude * OMEGA * sin(angle)});
    sweep_meter_start(&m, output, harmonic, HARMONICS, (int64_t)ticks * periods, turns_of(turns),
                      UINT64_MAX / (uint64_t)ticks);
    if (!sweep_meter_run(&m, &pl, r) || !sweep_meter_run(&m, &pl, r))
        r->mean = (double)NAN;
}

/* The largest error of mean and harmonics, over the largest of them. */
static double error_of(int output, double f, double turns, int ticks)
{
    struct sweep_measured r;
    struct motion x = exact_motion(f);
    measure(output, f, turns, ticks, PERIODS, &r);
    double mean = exact_harmonic(output, &x, 0), worst = fabs(r.mean - mean), largest = fabs(mean);
    if (isnan(r.mean))
        return r.mean;
    for (int i = 0; i < HARMONICS; i++) {
        double c = exact_harmonic(output, &x, (int)harmonic[i]), angle = harmonic[i] * x.phase;
        double re = r.amplitude[i] * cos(r.phase[i]) - c * cos(angle);
        double im = r.amplitude[i] * sin(r.phase[i]) - c * sin(angle);
        worst = fmax(worst, hypot(re, im));
        largest = fmax(largest, fabs(c));
    }
    return worst / largest;
}

static double worst_of(int output, int ticks)
{
    double worst = 0.0;
    for (int i = 0; i < 12 && !isnan(worst); i++) {
        double error = error_of(output, 0.65 + 0.25 * i, 0.0831 * i, ticks);
        worst = error > worst || isnan(error) ? error : worst;
    }
    return worst;
}

/* Amplitudes from just above the middle to six times it,
 * phases all round: switches stand everywhere in a tick. */
TEST(sweep_meter_sums)
{
    struct motion x = exact_motion(1.9);
    double alpha = acos(-x.middle / x.amplitude);
    check_near("the quadrature: mean of a cut cosine", exact_harmonic(OUTPUT_PENETRATION, &x, 0),
               (x.middle * alpha + x.amplitude * sin(alpha)) / ELEMENTARY_PI, 1e-10);
    check_near("the quadrature: third harmonic of a rectangle", exact_harmonic(OUTPUT_FLAG, &x, 3),
               2.0 * sin(3.0 * alpha) / (3.0 * ELEMENTARY_PI), 1e-10);
    check_below("displacement, 96 ticks", worst_of(OUTPUT_DISPLACEMENT, 96), 1e-7);
    check_below("penetration, which bends", worst_of(OUTPUT_PENETRATION, 96), 2e-6);
    check_below("force, of power 3/2", worst_of(OUTPUT_FORCE, 96), 5e-6);
    check_below("the flag, which jumps", worst_of(OUTPUT_FLAG, 96), 5e-6);
    struct sweep_measured r;
    measure(OUTPUT_PENETRATION, 1.9, 0.3, 96, PERIODS, &r);
    check_near("lowest penetration: apart", r.lowest, 0.0, 1e-12);
    check_near("highest", r.highest / (x.middle + x.amplitude), 1.0, 1e-7);
    check_near("peak force", r.peak_force / output_at(OUTPUT_FORCE, x.middle + x.amplitude), 1.0, 1e-7);
    check_near("part of the time apart", r.out_of_contact, 1.0 - alpha / ELEMENTARY_PI, 1e-8);
    measure(OUTPUT_DISPLACEMENT, 1.9, 0.3, 96, PERIODS, &r);
    check_near("lowest displacement", r.lowest / (x.middle - x.amplitude), 1.0, 1e-7);
}

/* The one highest point of a period, wherever in the half it stands: up to a tick before its end. */
TEST(sweep_meter_extremes)
{
    struct motion x = exact_motion(1.9);
    struct sweep_measured r;
    double worst = 0.0, worst_force = 0.0;
    for (int i = 1; i < 48; i++) {
        double highest = x.middle + x.amplitude;
        measure(OUTPUT_PENETRATION, 1.9, i / 48.0 - x.phase / (2.0 * ELEMENTARY_PI), 96, 1, &r);
        worst = fmax(worst, fabs(r.highest / highest - 1.0));
        worst_force = fmax(worst_force, fabs(r.peak_force / output_at(OUTPUT_FORCE, highest) - 1.0));
    }
    check_below("highest point", worst, 1e-7);
    check_below("peak force", worst_force, 1e-7);
}

/* Four times as many ticks: what the correction leaves falls
 * as the fourth power, and the sums alone fell as the second. */
TEST(sweep_meter_order)
{
    static const struct {
        int output;
        double least;
        const char *name;
    } c[] = {{OUTPUT_PENETRATION, 3.7, "order, penetration"},
             {OUTPUT_FORCE, 3.1, "order, force"},
             {OUTPUT_FLAG, 3.6, "order, flag"}};
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++)
        check_above(c[i].name, 0.5 * log2(worst_of(c[i].output, 48) / worst_of(c[i].output, 192)),
                    c[i].least);
}

/* Apart for a hundredth of a tick up to half of one, inside a tick and
 * across its end; the sample that is there shortens the first by 5e-6. */
TEST(sweep_meter_brief)
{
    static const double brief[] = {0.01, 0.02, 0.1, 0.5};
    double worst = 0.0, f = hypot(1.0 - OMEGA * OMEGA, DAMPING * OMEGA);
    for (size_t i = 0; i < sizeof brief / sizeof brief[0]; i++)
        for (int k = 0; k < 8 && !isnan(worst); k++) {
            double apart = f / cos(brief[i] * ELEMENTARY_PI / 96), tick = 20.0 + k / 8.0;
            double turns = 0.5 - tick / 96 - exact_motion(apart).phase / (2.0 * ELEMENTARY_PI);
            double error = error_of(OUTPUT_FLAG, apart, turns, 96);
            worst = error > worst || isnan(error) ? error : worst;
        }
    check_below("flag of a contact that is open for less than a tick", worst, 1e-5);
}

/* A shaft without supports and next to no gap springs, pushed along, its masses in proportion: x =
 * -cos(theta) gaps times `size` at both ends. Gap 3 is wider by a part `wider`, so that it closes a moment
 * after gap 1, which has the larger penetration. */
static double pair_error(double size, double wider, double turns)
{
    enum { TICKS = 96 };
    static const double si[] = {1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, GAP, GAP, 1e-9, 1e-9};
    double own[MODEL_PARAMETERS], worst = 0.0, largest = 0.0;
    struct plant pl;
    struct sweep_meter m;
    struct sweep_measured r;
    memcpy(own, si, sizeof si);
    own[SHAFT_G3] += wider * GAP;
    const struct plant_config c = {.model = &shaft_bearing,
                                   .si = own,
                                   .method = &exact,
                                   .tick_s = 2.0 * ELEMENTARY_PI / OMEGA / TICKS,
                                   .dilation = 1.0,
                                   .tol = 1e-12,
                                   .force = true,
                                   .scratch = scratch};
    const char *why = plant_init(&pl, &c);
    if (why)
        puts(why);
    if (why)
        return (double)NAN;
    for (int i = 0; i < SHAFT_INPUTS; i++)
        plant_drive_start(&pl, i, GAP * size * OMEGA * OMEGA * si[i], OMEGA / (2.0 * ELEMENTARY_PI),
                          2.0 * ELEMENTARY_PI * turns);
    double x = -size * cos(2.0 * ELEMENTARY_PI * turns), v = size * OMEGA * sin(2.0 * ELEMENTARY_PI * turns);
    plant_set_state(&pl, (const double[]){x, x, x, v, v, v});
    sweep_meter_start(&m, OUTPUT_PENETRATION, harmonic, HARMONICS, (int64_t)TICKS * PERIODS, turns_of(turns),
                      UINT64_MAX / TICKS);
    if (!sweep_meter_run(&m, &pl, &r))
        return (double)NAN;
    for (int i = 0; i < HARMONICS; i++) {
        double truth =
            exact_harmonic(OUTPUT_PENETRATION, &(struct motion){-1.0, size, 0.0}, (int)harmonic[i]);
        truth *= harmonic[i] % 2 ? 0.0 : 2.0 * GAP; /* on both sides */
        worst =
            fmax(worst, hypot(r.amplitude[i] * cos(r.phase[i]) - truth, r.amplitude[i] * sin(r.phase[i])));
        largest = fmax(largest, fabs(truth));
    }
    return worst / largest;
}

/* Two contacts that switch at once, or the second one a moment after the first. */
TEST(sweep_meter_pairs)
{
    static const double wider[] = {0.0, 1e-7, 1e-5, 1e-4, 1e-3};
    for (size_t i = 0; i < sizeof wider / sizeof wider[0]; i++) {
        double worst = 0.0;
        for (int k = 0; k < 8 && !isnan(worst); k++) {
            double error = pair_error(1.8, wider[i], 0.0831 * k);
            worst = error > worst || isnan(error) ? error : worst;
        }
        check_below(check_name("gap 3 wider by %g: penetration of both", wider[i]), worst, 2e-6);
    }
}
