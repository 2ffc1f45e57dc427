/* afm_tip_reduced.c - the reduced models of the AFM tip; see afm_tip_reduced.h. */
#include "models/reduced/afm_tip_reduced.h"

#include <stddef.h>
#include "models/math/elementary.h"
#include "models/reduced/polynomial.h"

/* Damping, force and contact force as in the full model; returns b = -s (2/3) beta. */
static double prepare_common(const double *si, double *p, struct scale *scale)
{
    double full[MODEL_DERIVED];
    afm_tip_prepare(si, full, scale);
    double b = full[TIP_P_HERTZ];
    polynomial_begin(p, full[TIP_P_DAMPING], 1.0 + b, -si[TIP_SIGN]);
    p[POLYNOMIAL_LEVER] = 1.0;
    p[POLYNOMIAL_M + 4 * TIP_FORCE] = 1.0;
    return b;
}

static void prepare_linear(const double *si, double *p, struct scale *scale)
{
    double b = prepare_common(si, p, scale);
    polynomial_put((const double[4]){0.0, -1.0 - 1.5 * b, 0.0, 0.0}, &p[POLYNOMIAL_C]);
    p[POLYNOMIAL_M + 4 * TIP_STIFFNESS] = -b;
    polynomial_find_rest(p);
}

static void prepare_cubic(const double *si, double *p, struct scale *scale)
{
    static const double contact[4] = HERTZ_CUBIC;
    double b = prepare_common(si, p, scale), force[4];
    for (int k = 0; k < 4; k++)
        force[k] = -1.5 * b * contact[k];
    polynomial_put(force, &p[POLYNOMIAL_M + 4 * TIP_STIFFNESS]);
    polynomial_put((const double[4]){0.0, force[1] - 1.0, force[2], force[3]}, &p[POLYNOMIAL_C]);
    polynomial_find_rest(p);
}

const struct model afm_tip_linear = {
    .name = "afm_tip_linear",
    .title = "afm_tip, linear in state and inputs; no contact loss",
    .prepare = prepare_linear,
    .linear = polynomial_linear,
    POLYNOMIAL_SAME_STATE(afm_tip, TIP, linear_2, 2),
};

const struct model afm_tip_cubic = {
    .name = "afm_tip_cubic",
    .title = "afm_tip to third order, no contact loss (Kirrou & Belhaq 2013 eq 3)",
    .prepare = prepare_cubic,
    POLYNOMIAL_SAME_STATE(afm_tip, TIP, cubic_2, 2),
};

/* ---- averaged ---- */

static const struct parameter averaged_parameters[TIP_AVERAGED_PARAMETERS] = {
    AFM_TIP_PARAMETERS,
    {"fast_frequency_Hz", "Hz", 0.0, 1e12, 90270.0, "frequency of the fast stiffness modulation"},
    {"fast_stiffness", "1", -1e6, 1e6, 0.0, "fast relative stiffness amplitude"},
};

static void prepare_averaged(const double *si, double *p, struct scale *scale)
{
    double B = -1.5 * prepare_common(si, p, scale); /* s beta: the repulsive formulas are those of -beta */
    double W = 2.0 * ELEMENTARY_PI * si[TIP_FAST_HZ] * scale->time_s;
    double e = si[TIP_FAST_STIFFNESS] != 0.0 ? B * si[TIP_FAST_STIFFNESS] / W : 0.0; /* b r/W */
    double v = e != 0.0 ? 1.0 / (W * W) : 0.0, e2 = e * e, e4 = e2 * e2;
    double w1_2 = 1.0 - B + 2.0 * e2 / 3.0 - 5.0 * B * e2 * v / 36.0 - e4 * v / 48.0;
    double rho1 = B / 4.0 - e2 / 3.0 + B * e2 * v / 12.0 + 7.0 * e4 * v / 192.0;
    double rho2 = B / 24.0 - e2 / 48.0 + B * e2 * v / 36.0 - 35.0 * e4 * v / 1152.0;
    double H = -e2 / 3.0 + B * e2 * v / 18.0 + e4 * v / 216.0;
    /* z = -d */
    polynomial_put((const double[4]){H, -w1_2, rho1, -rho2}, &p[POLYNOMIAL_C]);
    polynomial_find_rest(p);
}

static const char *check_averaged(const double *si)
{
    double p[MODEL_DERIVED];
    struct scale s;
    const char *why = afm_tip_check(si);
    if (why)
        return why;
    if (si[TIP_FAST_STIFFNESS] != 0.0 && !(si[TIP_FAST_HZ] > 0.0))
        return "the fast drive needs a frequency above 0";
    prepare_averaged(si, p, &s);
    if (!(p[POLYNOMIAL_REST] > 0.0))
        return "no stable equilibrium in contact under this fast drive";
    return NULL;
}

static void averaged_from_paper(const double *q, double *si, struct harmonic *drive)
{
    struct harmonic full[TIP_INPUTS];
    afm_tip_from_paper(q, si, full);
    si[TIP_FAST_HZ] = q[TIP_PAPER_FAST_OMEGA] / (2.0 * ELEMENTARY_PI);
    si[TIP_FAST_STIFFNESS] = q[TIP_PAPER_R];
    drive[TIP_FORCE] = full[TIP_FORCE];
}

const struct model afm_tip_averaged = {
    .name = "afm_tip_averaged",
    .title = "slow motion of afm_tip_cubic under fast stiffness modulation (Kirrou & Belhaq 2013 eqs 5-9)",
    .n_parameters = TIP_AVERAGED_PARAMETERS,
    .parameter = averaged_parameters,
    .check = check_averaged,
    .prepare = prepare_averaged,
    .from_paper = averaged_from_paper,
    POLYNOMIAL_REDUCED(afm_tip, TIP, cubic_force, 1),
};
