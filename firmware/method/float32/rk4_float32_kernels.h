/* rk4_float32_kernels.h - loads, accelerations and gaps of the three forms in float, inlined into
 * rk4_float32.c alone. */
#ifndef FIRMWARE_RK4_FLOAT32_KERNELS_H
#define FIRMWARE_RK4_FLOAT32_KERNELS_H

#include <float.h>
#include <math.h>
#include <string.h>
#include "models/check.h"
#include "firmware/method/float32/rk4_float32.h"

/* The inputs of one instant for the kernels: accelerations (for a polynomial by powers of z), and the shift
 * and the stiffness of a Hertzian contact. */
struct load {
    float c[4];
    float shift, shift_rate, hertz;
};

/* A gap, and a bound on its rounding. */
struct gap {
    float value, rate, rounding;
};

typedef void load_function(const struct float32_form *f, const struct input *u, unsigned active,
                           struct load *load);
typedef void acceleration_function(int half, const struct float32_form *f, const struct load *load,
                                   const float *z, const float *v, float *a);
typedef void gap_function(const struct float32_form *f, const struct load *load, const float *z,
                          const float *v, int which, struct gap *gap);

/* A form as compile-time constants of one instantiation. */
struct kernel {
    load_function *load;
    acceleration_function *acceleration, *lost; /* lost: what its coefficients have lost as floats */
    gap_function *gap;
    int half, n_contacts;
    size_t size;
};

/* Bytes of a form of this kind. */
#define FORM_SIZE(kind) (offsetof(struct float32_form, of) + sizeof(struct float32_##kind))

/* ---- one Hertzian contact ---- */

ALWAYS_INLINE void load_hertz(const struct float32_form *f, const struct input *u, unsigned active,
                              struct load *load)
{
    const struct float32_hertz *k = &f->of.hertz;
    *load = (struct load){.c = {k->rest}, .hertz = k->law.hertz};
    for (int i = 0; active >> i != 0; i++) {
        if (!((active >> i) & 1u))
            continue;
        float value = (float)u[i].value;
        load->c[0] += k->force[i] * value;
        load->shift += k->shift[i] * value;
        load->hertz += k->modulation[i] * value;
        if (!((f->rated >> i) & 1u))
            continue;
        float rate = (float)u[i].rate;
        load->c[0] += k->drag[i] * rate;
        load->shift_rate += k->shift[i] * rate;
    }
}

/* (1 + d)_+^{3/2} - 1 to the relative rounding of d, by (a - b)(a + b) = a^2 - b^2. */
ALWAYS_INLINE float hertz_less_one(float d)
{
    float eta = 1.0f + d;
    if (!(eta > 0.0f))
        return -1.0f;
    return d * (3.0f + d * (3.0f + d)) / (1.0f + eta * sqrtf(eta));
}

ALWAYS_INLINE void accelerate_hertz(int half, const struct float32_form *f, const struct load *load,
                                    const float *z, const float *v, float *a)
{
    const struct float32_hertz *k = &f->of.hertz;
    float d = k->side * z[0] + load->shift;
    (void)half;
    a[0] = ((load->c[0] - k->law.damping * v[0]) - k->law.stiffness * d) - load->hertz * hertz_less_one(d);
}

ALWAYS_INLINE void lost_hertz(int half, const struct float32_form *f, const struct load *load, const float *z,
                              const float *v, float *a)
{
    const struct float32_law *k = &f->of.hertz.lost;
    float d = f->of.hertz.side * z[0] + load->shift;
    (void)half;
    a[0] = -((k->damping * v[0] + k->stiffness * d) + k->hertz * hertz_less_one(d));
}

ALWAYS_INLINE void gap_hertz(const struct float32_form *f, const struct load *load, const float *z,
                             const float *v, int which, struct gap *gap)
{
    float side = f->of.hertz.side;
    (void)which;
    gap->value = -(1.0f + (side * z[0] + load->shift));
    gap->rate = -(side * v[0] + load->shift_rate);
    gap->rounding = 4.0f * FLT_EPSILON * (1.0f + (fabsf(z[0]) + fabsf(load->shift)));
}

/* ---- a polynomial force, no contact ---- */

ALWAYS_INLINE void load_affine(const struct float32_affine *k, unsigned rated, const struct input *u,
                               unsigned active, struct load *load)
{
    memcpy(load->c, k->constant, sizeof load->c);
    for (int i = 0; active >> i != 0; i++) {
        if (!((active >> i) & 1u))
            continue;
        float value = (float)u[i].value;
        for (int j = 0; j < 4; j++)
            load->c[j] += k->value[i][j] * value;
        if (!((rated >> i) & 1u))
            continue;
        float rate = (float)u[i].rate;
        for (int j = 0; j < 4; j++)
            load->c[j] += k->rate[i][j] * rate;
    }
}

ALWAYS_INLINE void load_polynomial(const struct float32_form *f, const struct input *u, unsigned active,
                                   struct load *load)
{
    load_affine(&f->of.polynomial.coefficient, f->rated, u, active, load);
}

ALWAYS_INLINE float cubic(const float *c, float z)
{
    return ((c[3] * z + c[2]) * z + c[1]) * z + c[0];
}

ALWAYS_INLINE void accelerate_polynomial(int half, const struct float32_form *f, const struct load *load,
                                         const float *z, const float *v, float *a)
{
    (void)half;
    a[0] = cubic(load->c, z[0]) - f->of.polynomial.damping * v[0];
}

ALWAYS_INLINE void lost_polynomial(int half, const struct float32_form *f, const struct load *load,
                                   const float *z, const float *v, float *a)
{
    (void)half, (void)load;
    a[0] = cubic(f->of.polynomial.lost, z[0]) - f->of.polynomial.lost_damping * v[0];
}

/* ---- a piecewise linear system ---- */

ALWAYS_INLINE void load_linear(const struct float32_form *f, const struct input *u, unsigned active,
                               struct load *load)
{
    load_affine(&f->of.linear.drive, f->rated, u, active, load);
}

ALWAYS_INLINE float gap_value(const struct float32_contact *c, const float *z)
{
    return c->constant + c->slope * z[c->position];
}

/* a = the matrix times the state; each row is added up so that a symmetric plant stays symmetric to the last
 * bit. */
ALWAYS_INLINE void multiply(int half, const struct float32_matrix *k, const float *z, const float *v,
                            float *a)
{
    for (int i = 0; i < half; i++) {
        float coupling = 0.0f, damping = 0.0f;
        for (int j = 0; j < half; j++) {
            if (j != i)
                coupling += k->couple[i][j] * (z[j] - z[i]);
            damping += k->damp[i][j] * v[j];
        }
        a[i] = damping + (k->sum[i] * z[i] + coupling);
    }
}

ALWAYS_INLINE void lost_linear(int half, const struct float32_form *f, const struct load *load,
                               const float *z, const float *v, float *a)
{
    (void)load;
    multiply(half, &f->of.linear.lost, z, v, a);
}

ALWAYS_INLINE void accelerate_linear(int half, const struct float32_form *f, const struct load *load,
                                     const float *z, const float *v, float *a)
{
    const struct float32_linear *k = &f->of.linear;
    multiply(half, &k->law, z, v, a);
    for (int i = 0; i < half; i++)
        a[i] += load->c[i];
    for (int c = 0; c < k->n_contacts; c++) {
        float gap = gap_value(&k->contact[c], z);
        for (int i = 0; gap < 0.0f && i < half; i++)
            a[i] += k->contact[c].push[i] * gap;
    }
}

ALWAYS_INLINE void gap_linear(const struct float32_form *f, const struct load *load, const float *z,
                              const float *v, int which, struct gap *gap)
{
    const struct float32_contact *c = &f->of.linear.contact[which];
    (void)load;
    gap->value = gap_value(c, z);
    gap->rate = c->slope * v[c->position];
    gap->rounding = 4.0f * FLT_EPSILON * (fabsf(c->constant) + fabsf(c->slope * z[c->position]));
}

/* ---- the three kernels ---- */

ALWAYS_INLINE struct kernel kernel_hertz(void)
{
    return (struct kernel){load_hertz, accelerate_hertz, lost_hertz, gap_hertz, 1, 1, FORM_SIZE(hertz)};
}

ALWAYS_INLINE struct kernel kernel_polynomial(void)
{
    return (struct kernel){load_polynomial,      accelerate_polynomial, lost_polynomial, NULL, 1, 0,
                           FORM_SIZE(polynomial)};
}

/* Its size at run time: fixed sizes save 12 % of the step on a Cortex-M4F for 4.5 KB of code. */
ALWAYS_INLINE struct kernel kernel_linear(const struct model *m)
{
    return (struct kernel){load_linear,     accelerate_linear, lost_linear,      gap_linear,
                           m->n_states / 2, m->n_contacts,     FORM_SIZE(linear)};
}

#endif
