/* test_choose_lever.c - contactplant choose on AFM levers: the reduced models, heat, conditions and costs.
 * tests/choose/choose_levers.c judges certificates of random levers by another integrator. */
#include <math.h>
#include <string.h>
#include "host_sim/choose/choose_climb.h"
#include "host_sim/choose/choose_ladder.h"
#include "host_sim/choose/choose_search.h"
#include "host_sim/choose/choose_watch.h"
#include "models/afm_lever.h"
#include "models/hertz_rig.h"
#include "tests/unit/test.h"

static struct choose_certificate certificate;

static void certify_lever(const struct scene *s, bool heat)
{
    bool escaped;
    memset(&certificate, 0, sizeof certificate);
    certificate.title = "test";
    certificate.scene = *s;
    certificate.heat = heat;
    check_no_error("a certificate", choose_search(&certificate, NULL, &escaped));
}

/* The preset `tapping` with four modes, so high that it never touches. */
static struct scene far_lever(void)
{
    struct scene s = scenes_find("tapping")->scene;
    s.value[LEVER_MODES] = 4.0;
    s.value[LEVER_HEIGHT] = 60e-9;
    s.substeps = 256;
    s.over = 1e-3;
    s.cost_s = 0.0;
    return s;
}

TEST(choose_lever_ladder)
{
    struct choose_candidate candidate[CHOOSE_CANDIDATES];
    struct scene s = far_lever();
    check_int("four modes: 1 to 4 without attraction, 1 to 3 with it, itself", choose_ladder(&s, candidate),
              8);
    check_string("the cheapest", candidate[0].name, "afm_lever, 1 mode, no attraction");
    check_string("fewer modes with attraction", candidate[5].name, "afm_lever, 2 modes");
    check_near("no attraction", candidate[1].scene.value[LEVER_HAMAKER], 0.0, 0.0);
    /* k_1/k of a beam, docs/reference/afm_lever.md */
    check_near("one mode has the first mode's stiffness", candidate[0].scene.value[LEVER_K],
               2.0 * 1.03019694736, 1e-10);
    check_near("two modes have the lever's", candidate[1].scene.value[LEVER_K], 2.0, 0.0);
    s.value[LEVER_HAMAKER] = s.value[LEVER_HAMAKER_OUT] = 0.0;
    s.value[LEVER_MODES] = 1.0;
    check_int("a point mass over a sample without attraction: itself", choose_ladder(&s, candidate), 1);
}

/* Far from the sample its attraction does not matter, and two modes have the deflection that is asked for. */
TEST(choose_lever_far)
{
    struct scene s = far_lever();
    certify_lever(&s, false);
    const struct choose_verdict *v = &certificate.verdict[certificate.choice],
                                *full = &certificate.verdict[certificate.n_candidates - 1];
    check_true("certified", certificate.met && certificate.in_time && !certificate.statistics);
    check_string("the choice", v->candidate.name, "afm_lever, 2 modes, no attraction");
    check_below("it costs less than the full model", choose_frame_cost(&v->attempt[certificate.method], 0),
                0.3 * choose_frame_cost(&full->attempt[full->best], 0));
    check_near("heat is off", certificate.scene.value[LEVER_TEMPERATURE], 0.0, 0.0);
    const struct scene_watch *w = choose_watched(&certificate);
    check_is("a gap is watched", (int)w->observable, ==, LEVER_GAP);
    double closest = (v->attempt[certificate.method].reach[0]) * 1e-6 / 30.0;
    check_below("nearer than the motion came", w->below, closest);
    check_above("but not at the sample", w->below, 0.05 * closest);
}

/* With the sample in reach the lever taps: there attraction matters. */
TEST(choose_lever_near)
{
    struct scene s = far_lever();
    s.value[LEVER_MODES] = 1.0;
    s.value[LEVER_HEIGHT] = 8e-9;
    s.tolerance = 0.01;
    certify_lever(&s, false);
    check_true("certified", certificate.met);
    check_true("it touches", certificate.switches > 0.0);
    check_string("the choice", certificate.verdict[certificate.choice].candidate.name, "afm_lever");
    check_true("without attraction it is refused", *certificate.verdict[0].refused != '\0');
}

/* With heat no two steps have equal motions, so statistics are compared, over different sequences. */
TEST(choose_lever_heat)
{
    struct scene s = far_lever();
    s.value[LEVER_MODES] = 1.0;
    s.value[LEVER_Q] = 5.0;
    s.drive[LEVER_FORCE].amplitude = 0.0;
    s.over = 2e-3;
    s.tolerance = 0.1;
    certify_lever(&s, true);
    check_true("statistics", certificate.statistics && certificate.heat);
    check_near("its temperature stays", certificate.scene.value[LEVER_TEMPERATURE], 295.0, 0.0);
    /* equipartition: k <x^2> = k_B T; deflection of a point mass is x */
    double rms = certificate.mean[STATISTIC_RMS] * certificate.span, x = sqrt(1.380649e-23 * 295.0 / 2.0);
    check_near("rms by equipartition, within what the runs say", rms, x,
               certificate.spread[STATISTIC_RMS] * certificate.span);
}

/* Behind the last sequence of the heat comes the first. */
TEST(choose_lever_last_seed)
{
    struct scene s = far_lever();
    s.value[LEVER_MODES] = 1.0;
    s.value[LEVER_Q] = 5.0;
    s.value[LEVER_SEED] = 4294967295.0;
    s.drive[LEVER_FORCE].amplitude = 0.0;
    s.tolerance = 0.1;
    certify_lever(&s, true);
    check_true("statistics", certificate.statistics && certificate.heat);
    check_above("they scatter", certificate.spread[STATISTIC_RMS], 0.0);
}

static double cost(double modes, double near)
{
    struct scene s = far_lever();
    struct choose_work w = {.scene = &s, .drives = 1, .series = {.near = near}};
    s.value[LEVER_MODES] = modes;
    return choose_cost_step(&w, 5, 0);
}

TEST(choose_lever_cost)
{
    check_string("the method", choose_method[5]->name, "modal");
    check_above("a tick costs more with each mode", cost(2.0, 0.0), cost(1.0, 0.0));
    check_above("and near the sample", cost(1.0, 1.0), 2.0 * cost(1.0, 0.0));
    check_near("by the share of such ticks", cost(3.0, 0.5), 0.5 * (cost(3.0, 0.0) + cost(3.0, 1.0)), 1e-9);
    check_true("rk4 is not tried", !choose_takes(&afm_lever, 0));
    check_true("nor modal on others", !choose_takes(&hertz_rig, 5));
}
