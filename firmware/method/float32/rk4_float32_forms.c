/* rk4_float32_forms.c - the views of a model as float coefficients about its rest; see rk4_float32.h. */
#include "firmware/method/float32/rk4_float32_forms.h"

#include <math.h>
#include <string.h>

/* A number as a float, and what that has lost. */
static void split(double value, float *kept, float *lost)
{
    *kept = (float)value;
    *lost = (float)(value - (double)*kept);
}

static unsigned bit_if(bool on, int i)
{
    return on ? 1u << i : 0u;
}

static void prepare_hertz(const struct model *m, const double *p, double *reference,
                          struct float32_form *form)
{
    struct float32_hertz *k = &form->of.hertz;
    struct hertz_form f;
    m->hertz_form(p, &f);
    reference[0] = f.side * (1.0 - f.origin);
    k->side = (float)f.side;
    k->rest = (float)(f.side * ((f.constant - f.stiffness) - f.hertz));
    split(f.damping, &k->law.damping, &k->lost.damping);
    split(f.side * f.stiffness, &k->law.stiffness, &k->lost.stiffness);
    split(f.side * f.hertz, &k->law.hertz, &k->lost.hertz);
    for (int i = 0; i < MODEL_INPUTS; i++) {
        double modulation = f.hertz * f.modulation[i];
        k->shift[i] = (float)f.shift[i];
        k->force[i] = (float)(f.side * (f.force[i] - modulation));
        k->drag[i] = (float)(f.side * (f.drag[i] - f.damping * f.shift[i]));
        k->modulation[i] = (float)(f.side * modulation);
        form->rated |= bit_if(f.shift[i] != 0.0 || f.drag[i] != 0.0, i);
    }
}

/* A cubic in x as one in z = x - r, by Horner's shift. */
static void shift_cubic(const double *c, double r, float *shifted, float *lost)
{
    double s[4] = {c[0], c[1], c[2], c[3]};
    for (int i = 0; i < 3; i++)
        for (int k = 2; k >= i; k--)
            s[k] += r * s[k + 1];
    for (int k = 0; k < 4; k++)
        split(s[k], &shifted[k], &lost[k]);
}

static void prepare_polynomial(const struct model *m, const double *p, double *reference,
                               struct float32_form *form)
{
    struct float32_polynomial *k = &form->of.polynomial;
    struct polynomial_form f;
    double x[MODEL_STATES], column[4];
    float unused[4];
    m->polynomial_form(p, &f);
    m->rest(p, x);
    reference[0] = x[0];
    split(f.damping, &k->damping, &k->lost_damping);
    shift_cubic(f.constant, x[0], k->coefficient.constant, k->lost);
    for (int i = 0; i < MODEL_INPUTS; i++) {
        bool rated = false;
        for (int j = 0; j < 4; j++)
            column[j] = f.modulation[j][i];
        shift_cubic(column, x[0], k->coefficient.value[i], unused);
        for (int j = 0; j < 4; j++) {
            column[j] = f.rate[j][i];
            rated |= column[j] != 0.0;
        }
        shift_cubic(column, x[0], k->coefficient.rate[i], unused);
        form->rated |= bit_if(rated, i);
    }
}

/* Rates at unit velocities are the gap's slopes. False when the gap follows more than one position, or an
 * input. */
static bool find_contact(const struct model *m, const double *p, int which, double *constant, double *slope,
                         int *position)
{
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}}, g[MODEL_CONTACTS];
    double x[MODEL_STATES] = {0.0};
    int half = m->n_states / 2, followed = 0;
    m->gap(p, u, x, g);
    *constant = g[which].value;
    *slope = 0.0;
    *position = 0;
    for (int k = 0; k < half; k++) {
        x[half + k] = 1.0;
        m->gap(p, u, x, g);
        x[half + k] = 0.0;
        if (g[which].rate == 0.0)
            continue;
        *slope = g[which].rate;
        *position = k;
        followed++;
    }
    for (int i = 0; i < m->n_inputs; i++)
        u[i] = (struct input){1.0, 1.0};
    m->gap(p, u, x, g);
    return followed <= 1 && g[which].value == *constant && g[which].rate == 0.0;
}

/* Closing this contact alone adds its push times its gap to the open system. */
static void prepare_contact(const struct model *m, const double *p, int which, const struct linear *open,
                            const double *reference, struct float32_contact *c)
{
    struct linear closed;
    double constant, slope;
    int half = m->n_states / 2;
    (void)find_contact(m, p, which, &constant, &slope, &c->position);
    bool closes = slope != 0.0 && m->linear(p, 1u << which, &closed);
    c->constant = (float)(constant + slope * reference[c->position]);
    c->slope = (float)slope;
    for (int i = 0; closes && i < half; i++)
        c->push[i] = (float)((closed.a[half + i][c->position] - open->a[half + i][c->position]) / slope);
}

static void prepare_linear(const struct model *m, const double *p, double *reference,
                           struct float32_form *form)
{
    struct float32_linear *k = &form->of.linear;
    struct linear l;
    double x[MODEL_STATES];
    int half = m->n_states / 2;
    (void)m->linear(p, 0, &l);
    m->rest(p, x);
    memcpy(reference, x, (size_t)half * sizeof *x);
    k->n_contacts = m->n_contacts;
    for (int i = 0; i < half; i++) {
        const double *row = l.a[half + i];
        double sum = 0.0, rest = l.c[half + i];
        for (int j = 0; j < half; j++) {
            sum += row[j];
            rest += row[j] * x[j];
            split(row[j], &k->law.couple[i][j], &k->lost.couple[i][j]);
            split(row[half + j], &k->law.damp[i][j], &k->lost.damp[i][j]);
        }
        split(sum, &k->law.sum[i], &k->lost.sum[i]);
        k->drive.constant[i] = (float)rest;
        for (int j = 0; j < m->n_inputs; j++) {
            k->drive.value[j][i] = (float)l.b[half + i][j];
            k->drive.rate[j][i] = (float)l.b_rate[half + i][j];
            form->rated |= bit_if(l.b_rate[half + i][j] != 0.0, j);
        }
    }
    for (int i = 0; i < m->n_contacts; i++)
        prepare_contact(m, p, i, &l, reference, &k->contact[i]);
}

const char *rk4_float32_refuse_model(const struct model *m, const double *p)
{
    double constant, slope;
    int position;
    if (m->hertz_form || m->polynomial_form)
        return NULL;
    if (!m->linear || m->n_states % 2 != 0)
        return "rk4_float32 has no form for this model: it needs one Hertzian contact, a polynomial force or "
               "a "
               "piecewise linear system of second order";
    for (int i = 0; i < m->n_contacts; i++) {
        if (!find_contact(m, p, i, &constant, &slope, &position))
            return "rk4_float32 needs gaps that follow one position each";
    }
    return NULL;
}

void rk4_float32_prepare_form(const struct model *m, const double *p, double *reference,
                              struct float32_form *form)
{
    memset(form, 0, sizeof *form);
    if (m->hertz_form)
        prepare_hertz(m, p, reference, form);
    else if (m->polynomial_form)
        prepare_polynomial(m, p, reference, form);
    else
        prepare_linear(m, p, reference, form);
}
