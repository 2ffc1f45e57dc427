/* rk4_float32.c - rk4 for a float32 FPU: derivatives and increments in float; state, time and phase in
 * double.
 *
 * The step is that of rk4.c, in float and on the deviation from rest. Its increments are added to the double
 * state, so rounding of floats does not add up. The inputs come with a double phase and are converted once
 * per tick. There are kernels for one Hertzian contact, a polynomial force and a piecewise linear system.
 *
 * Error: that of rk4, but not below 1e-7 of the largest deviation from rest, at any step and for any time.
 * The shaft, whose stiffness is a difference of large forces, has 3e-6 (docs/why/accuracy.md). Cost: with the
 * rig and one drive a step has 11 double operations. On a Cortex-M4F it takes 860 instructions against 4800
 * of rk4, with the shaft 3300 against 14500. A located switch takes about four steps more, as with rk4. */
#include <float.h>
#include <stddef.h>
#include <string.h>
#include "firmware/method/float32/rk4_float32_forms.h"
#include "firmware/method/float32/rk4_float32_kernels.h"
#include "firmware/method/switch.h"

/* The smallest tolerance that may be asked for: smooth motion stays below it for any time. */
#define TOL_MIN 1e-5
/* Eigenfrequency times step: below, half a step moves the state by less than a float of it can show. */
#define STEP_MIN ((double)FLT_EPSILON)

/* One step as it is computed: the start, the increments, the inputs at three instants. */
struct motion {
    float z[FLOAT32_HALF], v[FLOAT32_HALF], dz[FLOAT32_HALF], dv[FLOAT32_HALF];
    struct load load[3];
    float h;
};

/* The stages of rk4.c over h + rest. `rest` is the part of h that a float loses; the state follows its
 * tangent from the end for that long. The lost parts of the coefficients act from the middle of the step.
 * Both are added to the small part of an increment, beyond its first term, where rounding does not swallow
 * them. The division by 6 stays: a factor 1/6 in float would be off by 3e-8 and act as a damper. */
ALWAYS_INLINE void stages(struct kernel k, const struct float32_form *f, float rest, struct motion *s)
{
    float a1[FLOAT32_HALF], a2[FLOAT32_HALF], a3[FLOAT32_HALF], a4[FLOAT32_HALF], lost[FLOAT32_HALF];
    float y[FLOAT32_HALF], w[FLOAT32_HALF];
    float h = s->h, half = 0.5f * h, quarter = half * half, square = half * h;
    const float *z = s->z, *v = s->v;
    int n = k.half;
    k.acceleration(n, f, &s->load[0], z, v, a1);
    for (int i = 0; i < n; i++) {
        y[i] = z[i] + half * v[i];
        w[i] = v[i] + half * a1[i];
    }
    k.acceleration(n, f, &s->load[1], y, w, a2);
    for (int i = 0; i < n; i++) {
        y[i] = z[i] + (half * v[i] + quarter * a1[i]);
        w[i] = v[i] + half * a2[i];
    }
    k.acceleration(n, f, &s->load[1], y, w, a3);
    k.lost(n, f, &s->load[1], y, w, lost);
    for (int i = 0; i < n; i++) {
        y[i] = z[i] + (h * v[i] + square * a2[i]);
        w[i] = v[i] + h * a3[i];
    }
    k.acceleration(n, f, &s->load[2], y, w, a4);
    for (int i = 0; i < n; i++) {
        float b2 = a2[i] - a1[i], b3 = a3[i] - a1[i], b4 = a4[i] - a1[i];
        float dz = (a1[i] + (a2[i] + a3[i])) / 6.0f, dv = (b4 + 2.0f * (b2 + b3)) / 6.0f;
        s->dz[i] = h * v[i] + (h * (h * dz) + (rest * w[i] + square * lost[i]));
        s->dv[i] = h * a1[i] + (h * dv + (rest * a4[i] + h * lost[i]));
    }
}

/* The step in float from the double state. */
ALWAYS_INLINE void move(struct kernel k, const struct float32_scratch *w, const struct segment *e,
                        const double *x, struct motion *s)
{
    const struct float32_form *f = &w->form;
    for (int i = 0; i < k.half; i++) {
        s->z[i] = (float)(x[i] - w->reference[i]);
        s->v[i] = (float)x[k.half + i];
    }
    for (int i = 0; i < 3; i++)
        k.load(f, e->at[i], e->active, &s->load[i]);
    bool tick = e->length == w->h;
    s->h = tick ? f->h : (float)e->length;
    stages(k, f, tick ? f->h_rest : 0.0f, s);
}

ALWAYS_INLINE void add_increments(int half, const struct motion *s, double *x)
{
    for (int i = 0; i < half; i++) {
        x[i] += (double)s->dz[i];
        x[half + i] += (double)s->dv[i];
    }
}

/* d - d is zero, or a NaN when d is not finite. */
ALWAYS_INLINE bool finite_increments(int half, const struct motion *s)
{
    float sum = 0.0f;
    for (int i = 0; i < half; i++)
        sum += (s->dz[i] - s->dz[i]) + (s->dv[i] - s->dv[i]);
    return sum == 0.0f;
}

/* switch_suspected on float gaps. It is true in doubt, because doubles decide then. */
ALWAYS_INLINE bool suspected(const struct gap *g0, const struct gap *g1, float length, bool closed)
{
    float sign = closed ? 1.0f : -1.0f;
    float v0 = sign * g0->rate, v1 = sign * g1->rate, end = sign * g1->value;
    if (end >= -g1->rounding)
        return true;
    if (!(v0 > 0.0f && v1 < 0.0f))
        return false;
    float begin = sign * g0->value;
    float s = (end - begin - v1 * length) / (v0 - v1);
    return begin + v0 * s > -g1->rounding;
}

ALWAYS_INLINE bool any_suspected(struct kernel k, const struct float32_form *f, unsigned regime,
                                 const struct motion *s)
{
    float z1[FLOAT32_HALF], v1[FLOAT32_HALF];
    bool any = false;
    for (int i = 0; i < k.half; i++) {
        z1[i] = s->z[i] + s->dz[i];
        v1[i] = s->v[i] + s->dv[i];
    }
    for (int i = 0; i < k.n_contacts; i++) {
        struct gap g0, g1;
        k.gap(f, &s->load[0], s->z, s->v, i, &g0);
        k.gap(f, &s->load[2], z1, v1, i, &g1);
        any |= suspected(&g0, &g1, s->h, (regime >> i) & 1u);
    }
    return any;
}

static struct kernel kernel_of(const struct model *m)
{
    if (m->hertz_form)
        return kernel_hertz();
    return m->polynomial_form ? kernel_polynomial() : kernel_linear(m);
}

/* Any model, with the arithmetic and so the bits of its inlined copy; for rare cases. */
static void advance_general(const struct model *m, const double *p, const double *scratch,
                            const struct segment *e, const double *x, double *x1)
{
    struct kernel k = kernel_of(m);
    struct motion s;
    (void)p;
    move(k, (const struct float32_scratch *)(const void *)scratch, e, x, &s);
    memcpy(x1, x, (size_t)m->n_states * sizeof *x);
    add_increments(k.half, &s, x1);
}

NEVER_INLINE enum step_status locate(const struct model *m, const double *p, const double *scratch,
                                     const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    /* Relative to the whole tick, also in the rest of one after a switch. A contact that closes together with
     * another begins there beyond its switch, by the error of the first one's instant. */
    double resolution =
        4.0 * (double)FLT_EPSILON * ((const struct float32_scratch *)(const void *)scratch)->h;
    struct switch_stepper stepper = {advance_general, m, p, scratch, resolution};
    return switch_locate(&stepper, e, regime, x, c);
}

ALWAYS_INLINE enum step_status step(struct kernel k, const struct model *m, const double *p,
                                    const double *scratch, const struct segment *e, unsigned regime,
                                    double *x, struct crossing *c)
{
    const struct float32_scratch *w = (const struct float32_scratch *)(const void *)scratch;
    struct motion s;
    move(k, w, e, x, &s);
    if (!finite_increments(k.half, &s))
        return STEP_NOT_FINITE;
    if (!(regime & REGIME_ANY) && any_suspected(k, &w->form, regime, &s))
        return locate(m, p, scratch, e, regime, x, c);
    add_increments(k.half, &s, x);
    return STEP_END;
}

/* One copy for each form. */
static enum step_status step_hertz(const struct model *m, const double *p, double *scratch,
                                   const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return step(kernel_hertz(), m, p, scratch, e, regime, x, c);
}

static enum step_status step_polynomial(const struct model *m, const double *p, double *scratch,
                                        const struct segment *e, unsigned regime, double *x,
                                        struct crossing *c)
{
    return step(kernel_polynomial(), m, p, scratch, e, regime, x, c);
}

static enum step_status step_linear(const struct model *m, const double *p, double *scratch,
                                    const struct segment *e, unsigned regime, double *x, struct crossing *c)
{
    return step(kernel_linear(m), m, p, scratch, e, regime, x, c);
}

static step_function *bind(const struct model *m)
{
    if (m->hertz_form)
        return step_hertz;
    return m->polynomial_form ? step_polynomial : step_linear;
}

static size_t n_scratch(const struct model *m)
{
    return (offsetof(struct float32_scratch, form) + kernel_of(m).size + sizeof(double) - 1) / sizeof(double);
}

static const char *refuse(const struct model *m, const double *p, double h, double tol)
{
    const char *why = rk4_float32_refuse_model(m, p);
    if (why)
        return why;
    if (tol != 0.0 && !(tol >= TOL_MIN))
        return "rk4_float32: tolerance below 1e-5; float32 increments cannot keep it, use rk4, taylor or "
               "exact";
    if (!(h * m->eigenfrequency(p) >= STEP_MIN))
        return "step too fine for rk4_float32: eigenfrequency * step is below 1.2e-7 rad, a float32 "
               "increment "
               "would show only rounding (fewer substeps, or rk4)";
    return rk4.refuse(m, p, h, tol);
}

static void prepare(const struct model *m, const double *p, double h, double tol, double *scratch)
{
    struct float32_scratch *w = (struct float32_scratch *)(void *)scratch;
    struct float32_form form;
    (void)tol;
    memset(scratch, 0, n_scratch(m) * sizeof *scratch);
    rk4_float32_prepare_form(m, p, w->reference, &form);
    form.h = (float)h;
    form.h_rest = (float)(h - (double)form.h);
    w->h = h;
    memcpy(&w->form, &form, kernel_of(m).size);
}

const struct method rk4_float32 = {
    .name = "rk4_float32",
    .title = "rk4 for a float32 FPU: increments in float, state and phase in double; 1e-5 on smooth motion",
    .order = 4,
    .n_scratch = n_scratch,
    .refuse = refuse,
    .prepare = prepare,
    .bind = bind,
};
