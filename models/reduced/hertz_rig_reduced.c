/* hertz_rig_reduced.c - the reduced models of the Hertz rig; see hertz_rig_reduced.h. */
#include "models/reduced/hertz_rig_reduced.h"

#include <stddef.h>
#include "models/math/elementary.h"

/* Damping, contact force and slow force as in the full rig. */
static void prepare_common(const double *si, double *p, struct scale *scale)
{
    double full[MODEL_DERIVED];
    hertz_rig_prepare(si, full, scale);
    polynomial_begin(p, full[RIG_P_TWO_XI], 2.0 / 3.0, 1.5);
    p[POLYNOMIAL_M + 4 * RIG_FORCE] = 2.0 / 3.0;
}

/* Fast force, and the base's damper. */
static void prepare_fast_inputs(double *p)
{
    p[POLYNOMIAL_M + 4 * RIG_FAST_FORCE] = 2.0 / 3.0;
    p[POLYNOMIAL_R + RIG_BASE] = p[POLYNOMIAL_DAMPING];
    p[POLYNOMIAL_BASE] = -1.0;
    p[POLYNOMIAL_BASE_INPUT] = RIG_BASE;
}

static void prepare_linear(const double *si, double *p, struct scale *scale)
{
    prepare_common(si, p, scale);
    prepare_fast_inputs(p);
    polynomial_put((const double[4]){0.0, -1.0, 0.0, 0.0}, &p[POLYNOMIAL_C]);
    p[POLYNOMIAL_M + 4 * RIG_BASE] = 1.0;
    p[POLYNOMIAL_M + 4 * RIG_STIFFNESS] = -2.0 / 3.0;
    polynomial_find_rest(p);
}

static void prepare_cubic(const double *si, double *p, struct scale *scale)
{
    static const double contact[4] = HERTZ_CUBIC, base[4] = {1.0, 0.5, -0.125, 0.0625};
    double stiffness[4];
    for (int k = 0; k < 4; k++)
        stiffness[k] = -contact[k];
    prepare_common(si, p, scale);
    prepare_fast_inputs(p);
    polynomial_put((const double[4]){0.0, stiffness[1], stiffness[2], stiffness[3]}, &p[POLYNOMIAL_C]);
    polynomial_put(base, &p[POLYNOMIAL_M + 4 * RIG_BASE]);
    polynomial_put(stiffness, &p[POLYNOMIAL_M + 4 * RIG_STIFFNESS]);
    polynomial_find_rest(p);
}

const struct model hertz_rig_linear = {
    .name = "hertz_rig_linear",
    .title = "hertz_rig, linear in state and inputs; no contact loss",
    .prepare = prepare_linear,
    .linear = polynomial_linear,
    POLYNOMIAL_SAME_STATE(hertz_rig, RIG, linear_4, 4),
};

const struct model hertz_rig_cubic = {
    .name = "hertz_rig_cubic",
    .title = "hertz_rig to third order, no contact loss (Bichri et al. 2011 eqs 3, 21, 27)",
    .prepare = prepare_cubic,
    POLYNOMIAL_SAME_STATE(hertz_rig, RIG, cubic_4, 4),
};

/* ---- averaged ---- */

static const struct parameter averaged_parameters[RIG_AVERAGED_PARAMETERS] = {
    HERTZ_RIG_PARAMETERS("base"),
    {"fast_frequency_Hz", "Hz", 0.0, 1e12, 1840.0, "frequency of the fast drive"},
    {"fast_force_N", "N", -1e12, 1e12, 0.0, "fast force amplitude"},
    {"fast_base_m", "m", -1e6, 1e6, 0.0, "fast base amplitude"},
    {"fast_stiffness", "1", -1e6, 1e6, 0.0, "fast relative stiffness amplitude"},
};

/* Slow equation q'' + w2 q + 2 xi q' + b q^2 - g q^3 + G = ... */
struct slow {
    double w2, b, g, G;
};

static const double B = 1.0 / 6.0, G3 = 1.0 / 54.0; /* F = q + B q^2 - G3 q^3 */

/* Fast force of amplitude a, W^-2 in v. */
static struct slow slow_force(double a, double v)
{
    double a2 = a * a, v2 = v * v;
    return (struct slow){1.0 - 1.5 * G3 * a2 * v2, B, G3, 0.5 * B * a2 * v2};
}

/* Fast base motion of amplitude a (unit 2 zs/3). */
static struct slow slow_base(double a, double v, double alpha)
{
    double a2 = a * a, a4 = a2 * a2, v2 = v * v, v3 = v2 * v, c2 = alpha * alpha, d = c2 + v;
    double third = -G3 + a2 * B * B * v / 9.0 + 4.0 * a2 * B * G3 * v + 3.0 * a4 * c2 * G3 * G3 * v2 / 8.0 -
                   2.0 * a2 * B * B * B * v2 / 3.0 - 6.0 * a2 * B * B * G3 * v2 + 2.0 * a2 * B * G3 * v2 +
                   3.0 * a4 * B * B * B * G3 * v3 - 1.5 * a4 * B * B * G3 * v3 +
                   9.0 * a4 * G3 * G3 * v3 / 8.0;
    return (struct slow){1.0 + B * a2 * v2 / 3.0 - 1.5 * G3 * a2 * v * d +
                             0.125 * G3 * a4 * v2 * (c2 + 3.0 * v),
                         B - G3 * a2 * v2 - 0.125 * G3 * a4 * v2 * (c2 * B - 0.5 * v), -third,
                         d * (0.5 * B * a2 * v + 0.375 * G3 * a4 * v2) + a2 * v / 6.0};
}

/* Fast relative stiffness of amplitude a. */
static struct slow slow_stiffness(double a, double v)
{
    double a2 = a * a, a4 = a2 * a2, v2 = v * v, v3 = v2 * v;
    double third = -G3 + (B * B - 2.0 * G3) * a2 * v + (B * B - 4.0 * B * G3 - 1.5 * G3) * a2 * v2 -
                   (2.25 * B * G3 - 1.125 * G3 * G3 + 0.375 * G3) * a4 * v3;
    return (struct slow){1.0 + (B - 1.5 * G3) * a2 * v2 + (0.5 + B) * a2 * v - 1.125 * G3 * a4 * v3,
                         B + 1.5 * (B - G3) * a2 * v + (B * B + 0.5 * B - 3.0 * G3) * a2 * v2 -
                             1.125 * G3 * (1.0 + B) * a4 * v3,
                         -third, 0.5 * a2 * v + 0.5 * B * a2 * v2 - 0.375 * G3 * a4 * v3};
}

/* The slow equation of the one fast drive that is not silent. */
static struct slow slow_of(const double *si, const struct scale *s, double alpha)
{
    double W = 2.0 * ELEMENTARY_PI * si[RIG_FAST_HZ] * s->time_s, v = 1.0 / (W * W);
    if (si[RIG_FAST_FORCE_N] != 0.0)
        return slow_force(si[RIG_FAST_FORCE_N] / s->force_N, v);
    if (si[RIG_FAST_BASE_M] != 0.0)
        return slow_base(1.5 * si[RIG_FAST_BASE_M] / s->length_m, v, alpha);
    if (si[RIG_FAST_STIFFNESS] != 0.0)
        return slow_stiffness(si[RIG_FAST_STIFFNESS], v);
    return slow_force(0.0, 0.0);
}

static void prepare_averaged(const double *si, double *p, struct scale *scale)
{
    prepare_common(si, p, scale);
    struct slow s = slow_of(si, scale, p[POLYNOMIAL_DAMPING]);
    /* q = (3/2) d */
    polynomial_put((const double[4]){-s.G / 1.5, -s.w2, -1.5 * s.b, 2.25 * s.g}, &p[POLYNOMIAL_C]);
    polynomial_find_rest(p);
}

static const char *check_averaged(const double *si)
{
    double p[MODEL_DERIVED];
    struct scale s;
    int drives =
        (si[RIG_FAST_FORCE_N] != 0.0) + (si[RIG_FAST_BASE_M] != 0.0) + (si[RIG_FAST_STIFFNESS] != 0.0);
    const char *why = hertz_rig_check(si);
    if (why)
        return why;
    if (drives > 1)
        return "averaged over one fast drive only: leave one of fast force, base and stiffness not zero";
    if (drives == 1 && !(si[RIG_FAST_HZ] > 0.0))
        return "the fast drive needs a frequency above 0";
    prepare_averaged(si, p, &s);
    if (!(p[POLYNOMIAL_REST] > 0.0))
        return "no stable equilibrium in contact under this fast drive";
    return NULL;
}

static void averaged_from_paper(const double *q, double *si, struct harmonic *drive)
{
    hertz_rig_unit_scale(q[RIG_PAPER_XI], si);
    si[RIG_FAST_HZ] = q[RIG_PAPER_FAST_OMEGA] / (2.0 * ELEMENTARY_PI);
    si[RIG_FAST_FORCE_N] = q[RIG_PAPER_FORCE];
    si[RIG_FAST_BASE_M] = (2.0 / 3.0) * q[RIG_PAPER_BASE];
    si[RIG_FAST_STIFFNESS] = q[RIG_PAPER_STIFFNESS];
    drive[RIG_FORCE] = (struct harmonic){q[RIG_PAPER_SIGMA], q[RIG_PAPER_OMEGA], q[RIG_PAPER_PHI]};
}

const struct model hertz_rig_averaged = {
    .name = "hertz_rig_averaged",
    .title =
        "slow motion of hertz_rig_cubic under one fast drive (Bichri et al. 2011, coefficients corrected)",
    .n_parameters = RIG_AVERAGED_PARAMETERS,
    .parameter = averaged_parameters,
    .check = check_averaged,
    .prepare = prepare_averaged,
    .from_paper = averaged_from_paper,
    POLYNOMIAL_REDUCED(hertz_rig, RIG, cubic_force, 1),
};
