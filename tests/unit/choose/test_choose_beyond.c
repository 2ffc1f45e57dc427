/* test_choose_beyond.c - how far a certificate's one mode of the shaft is good: four times where the shaft is
 * linear, else as far as runs of our own find the same. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/choose/choose.h"
#include "host_sim/choose/choose_run.h"
#include "host_sim/choose/choose_search.h"
#include "models/shaft_views.h"
#include "tests/unit/test.h"

static struct choose_certificate certificate;
static double times; /* as the certificate says how much larger its largest drives were */

/* The factor of its condition on the mode's position, which may be watched. */
static double factor_of(const struct scene *s)
{
    bool escaped;
    memset(&certificate, 0, sizeof certificate);
    certificate.title = "test";
    certificate.scene = *s;
    certificate.choice = -1;
    if (choose_search(&certificate, NULL, &escaped) || !certificate.met) {
        check_true("a certificate", 0);
        return 0.0;
    }
    check_string("of", certificate.verdict[certificate.choice].attempt[certificate.method].scene.model->name,
                 "shaft_bearing_mode");
    for (int i = 0; i < certificate.n_conditions; i++)
        if (!strcmp(certificate.condition[i].name, "mode")) {
            const char *said = strstr(certificate.condition[i].text, "drives up to ");
            times = said ? strtod(said + sizeof "drives up to " - 1, NULL) : 0.0;
            return certificate.condition[i].factor;
        }
    check_true("a condition on position", 0);
    return 0.0;
}

/* Open gaps, or so soft that they are as good as open, under a force at the middle. */
static struct scene soft_shaft(double amplitude)
{
    struct scene s;
    scenes_default(&s, &shaft_bearing);
    s.value[SHAFT_KG1] = s.value[SHAFT_KG3] = 2e4;
    s.frame_s = 1e-3;
    s.substeps = 4.0;
    s.drive[1] = (struct scene_drive){.amplitude = amplitude, .frequency_Hz = 12.0};
    s.observable = 0.0;
    s.over = 1.0;
    s.tolerance = 0.05;
    return s;
}

/* No gap closes up to four times the drives, the most that is tried: everything grows alike, to whichever
 * side it goes farther, by whatever method the scene has. */
TEST(choose_beyond_linear)
{
    struct scene up = soft_shaft(0.1), down = soft_shaft(-0.1), noisy = soft_shaft(0.1),
                 rough = soft_shaft(0.1);
    noisy.drive[1].noise = 0.05;
    rough.method = "rk4";
    check_near("up", factor_of(&up), 4.0, 1e-6);
    check_near("as it says", times, 4.0, 0.0);
    check_near("down", factor_of(&down), 4.0, 1e-6);
    check_near("with noise", factor_of(&noisy), 4.0, 1e-6);
    check_near("by a method that the full shaft would not take", factor_of(&rough), 4.0, 1e-6);
}

/* Drives that come from a paper's parameters. */
TEST(choose_beyond_paper)
{
    struct scene s = scenes_find("shaft-fig16-705")->scene;
    s.over = 0.5;
    s.tolerance = 0.05;
    s.value[SHAFT_PAPER_P1 + 1] *= 0.1;
    check_near("factor", factor_of(&s), 4.0, 1e-6);
}

/* Mode and shaft under drives this many times as large,
 * the shaft's first position moved: their difference. */
static double error_at(double larger, double nudge)
{
    struct scene candidate = certificate.verdict[certificate.choice].attempt[certificate.method].scene,
                 full = certificate.scene;
    struct choose_record truth, r;
    full.method = "exact";
    double *amplitude_r = full.paper ? &candidate.value[SHAFT_PAPER_P1 + 1] : &candidate.drive[1].amplitude;
    double *amplitude_f = full.paper ? &full.value[SHAFT_PAPER_P1 + 1] : &full.drive[1].amplitude;
    *amplitude_r *= larger;
    *amplitude_f *= larger;
    check_no_error("both run", choose_run(&full, &certificate.sweep, nudge, &truth));
    check_no_error("both run", choose_run(&candidate, &certificate.sweep, 0.0, &r));
    double error = choose_difference(&r, &truth, choose_span(&truth, 0.0));
    choose_record_free(&truth);
    choose_record_free(&r);
    return error;
}

/* Steps of 2^(1/4) up to which that difference stays within the tolerance. */
static int steps_good(double nudge)
{
    int steps = 0;
    while (steps < 8 && error_at(pow(2.0, 0.25 * (steps + 1)), nudge) <= certificate.scene.tolerance)
        steps++;
    return steps;
}

/* The shaft of figure 16 is near its gaps: a drive somewhat larger, by steps of 2^(1/4), closes them. */
TEST(choose_beyond_touch)
{
    struct scene s = scenes_find("shaft-fig16-705")->scene;
    s.over = 0.5;
    s.tolerance = 0.08;
    s.value[SHAFT_PAPER_P1 + 1] *= 3.0;
    check_above("factor", factor_of(&s), 1.0);
    int steps = steps_good(0.0);
    check_is("some steps, not all", steps, >, 0);
    check_is("some steps, not all", steps, <, 8);
    check_near("steps that the certificate took", 4.0 * log2(times), steps, 0.03);
}

/* A shaft that beats on both bearings alike: beyond some force its symmetric motion is unstable, which
 * nothing shows in a run of perfect symmetry. */
TEST(choose_beyond_symmetry)
{
    struct scene s = soft_shaft(4.0);
    s.value[SHAFT_KG1] = s.value[SHAFT_KG3] = 9e4;
    s.drive[1].frequency_Hz = 27.0;
    s.over = 1.27;
    s.tolerance = 0.1;
    check_above("factor", factor_of(&s), 1.0);
    int steps = steps_good(1e-9);
    check_is("some steps", steps, >, 0);
    check_near("steps that the certificate took", 4.0 * log2(times), steps, 0.03);
    check_is("perfect symmetry would seem to hold farther", steps_good(0.0), >, steps);
}

/* Not good beyond the motion itself: that one stays within the watch, whichever way it goes farther. */
TEST(choose_beyond_none)
{
    struct scene s = scenes_find("shaft")->scene;
    s.over = 0.5;
    s.tolerance = 0.02;
    s.drive[1].amplitude = 20.0;
    s.drive[1].frequency_Hz = 36.0;
    check_near("one way", factor_of(&s), 1.0, 0.0);
    for (int i = 0; i < SHAFT_INPUTS; i++)
        s.drive[i].amplitude = -s.drive[i].amplitude;
    check_near("the other", factor_of(&s), 1.0, 0.0);
}

/* The budget for a step does not limit the runs that judge. A scene whose frame is nearly full gets a
 * certificate, and an equal one. */
TEST(choose_beyond_cost)
{
    struct scene s = soft_shaft(0.1);
    s.cost_s = 0.9 * s.frame_s / s.substeps;
    check_near("factor", factor_of(&s), 4.0, 1e-6);
}
