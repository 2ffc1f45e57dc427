/* choose_theory.c - see choose_theory.h. */
#include <complex.h>
#include <math.h>
#include <string.h>

#include "host_sim/choose/choose_theory.h"
#include "host_sim/maps/maps.h"
#include "host_sim/maps/stability/stability_floquet.h"
#include "models/math/elementary.h"

static const double complex imaginary = (double complex)I;
enum { CURVE = 64 };

/* A scene in model units. */
struct prepared {
    const struct model *m;
    double p[MODEL_DERIVED], rest[MODEL_STATES], over, time_s;
    struct harmonic drive[MODEL_INPUTS];
};

static void prepare(const struct scene *s, struct prepared *o)
{
    double si[MODEL_PARAMETERS];
    struct scale scale;
    o->m = s->model;
    scenes_resolve(s, si, o->drive);
    o->m->prepare(si, o->p, &scale);
    o->m->rest(o->p, o->rest);
    o->over = s->over / scale.time_s;
    o->time_s = scale.time_s;
    for (int i = 0; i < o->m->n_inputs; i++) {
        o->drive[i].amplitude /= scale_of(&scale, o->m->input_signal[i].quantity);
        o->drive[i].omega *= scale.time_s;
    }
}

/* Solves (i w - A) x = b into x = b, by elimination with pivots in rows [A b]. */
static void respond(const struct linear *l, int n, double w, double complex *b)
{
    double complex row[MODEL_STATES][MODEL_STATES + 1], swap[MODEL_STATES + 1];
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            row[i][j] = (i == j ? w * imaginary : 0.0) - l->a[i][j];
        row[i][n] = b[i];
    }
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++)
            pivot = cabs(row[i][k]) > cabs(row[pivot][k]) ? i : pivot;
        memcpy(swap, row[k], sizeof swap);
        memcpy(row[k], row[pivot], sizeof swap);
        memcpy(row[pivot], swap, sizeof swap);
        for (int i = 0; i < n; i++) {
            double complex f = i == k ? 0.0 : row[i][k] / row[k][k];
            for (int j = k; j <= n && i != k; j++)
                row[i][j] -= f * row[k][j];
        }
    }
    for (int k = 0; k < n; k++)
        b[k] = row[k][n] / row[k][k];
}

/* The linear model's steady motion under drive i, as a phasor; false: there is none. */
static bool swing(const struct prepared *candidate, int i, double complex *x)
{
    const struct harmonic *d = &candidate->drive[i];
    struct linear l;
    if (!candidate->m->linear(candidate->p, 0, &l) || !(fabs(d->amplitude) > 0.0))
        return false;
    for (int k = 0; k < candidate->m->n_states; k++)
        x[k] = d->amplitude * (l.b[k][i] + imaginary * d->omega * l.b_rate[k][i]);
    respond(&l, candidate->m->n_states, d->omega, x);
    return true;
}

/* Amplitude of the largest compression there. */
static double amplitude_of(const struct prepared *candidate, const struct prepared *full, int i)
{
    double complex x[MODEL_STATES];
    double re[MODEL_STATES], im[MODEL_STATES], most = 0.0;
    struct input none[MODEL_INPUTS] = {{0.0, 0.0}}, u[MODEL_INPUTS] = {{0.0, 0.0}};
    struct input g0[MODEL_CONTACTS], g1[MODEL_CONTACTS], g2[MODEL_CONTACTS];
    if (!swing(candidate, i, x))
        return 0.0;
    for (int k = 0; k < candidate->m->n_states; k++) {
        re[k] = creal(x[k]);
        im[k] = cimag(x[k]);
    }
    const double origin[MODEL_STATES] = {0.0};
    u[i].value = candidate->drive[i].amplitude;
    full->m->gap(full->p, none, origin, g0);
    full->m->gap(full->p, u, re, g1);
    full->m->gap(full->p, none, im, g2);
    for (int k = 0; k < full->m->n_contacts; k++)
        most = fmax(most, hypot(g1[k].value - g0[k].value, g2[k].value - g0[k].value));
    return full->m->n_contacts > 0 ? most : hypot(re[0], im[0]);
}

/* The largest acceleration that the gap springs alone make along that motion, over itself and the drive's. */
static double share_of_gaps(const struct prepared *candidate, const struct prepared *full, int i)
{
    double complex z[MODEL_STATES];
    struct linear l;
    double most = 0.0, drive = 0.0;
    int n = candidate->m->n_states;
    if (!swing(candidate, i, z) || !candidate->m->linear(candidate->p, 0, &l))
        return 0.0;
    for (int k = 0; k < n; k++)
        drive = fmax(drive, fabs(candidate->drive[i].amplitude * l.b[k][i]));
    for (int j = 0; j < CURVE; j++) {
        struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
        double x[MODEL_STATES], a[MODEL_STATES], b[MODEL_STATES];
        for (int k = 0; k < n; k++)
            x[k] = creal(z[k] * cexp(imaginary * (2.0 * ELEMENTARY_PI * j / CURVE)));
        full->m->rhs(full->p, u, x, a);
        candidate->m->rhs(candidate->p, u, x, b);
        for (int k = 0; k < n; k++)
            most = fmax(most, fabs(a[k] - b[k]));
    }
    return most > 0.0 ? most / (most + drive) : 0.0;
}

/* The input that modulates the contact, or -1. A linear model turns it into a force; a lever has no tests
 * by it. */
static int modulated(const struct model *m)
{
    for (int i = 0; i < m->n_inputs && !m->linear && !m->modal_form; i++)
        if (m->input_signal[i].quantity == QUANTITY_RATIO)
            return i;
    return -1;
}

/* The fast input over which averaging goes, if it sounds, or -1. */
static int fast_input(const struct prepared *o)
{
    /* Beside the contact's modulation every input but the first is fast. */
    for (int i = 1; modulated(o->m) >= 0 && i < o->m->n_inputs; i++)
        if (fabs(o->drive[i].amplitude) > 0.0)
            return i;
    return -1;
}

/* Largest Floquet multiplier of the linear part under that modulation; 1 where there is none. */
static double multiplier(const struct scene *s)
{
    struct stability_tangent t;
    return stability_tangent_of(s, &t) ? 1.0 : stability_exact(&t);
}

/* The linear model's motion under the scene's drives. */
static void predict(const struct prepared *linear, const struct prepared *full, int fast,
                    struct choose_facts *f)
{
    double amplitude = 0.0, fast_amplitude = 0.0, share = 0.0;
    for (int i = 0; i < linear->m->n_inputs; i++) {
        double a = amplitude_of(linear, full, i);
        amplitude += a;
        fast_amplitude += i == fast ? a : 0.0;
        share = full->m->n_states > 2 ? fmax(share, share_of_gaps(linear, full, i)) : 0.0;
    }
    if (amplitude <= f->amplitude)
        return;
    f->amplitude = amplitude;
    f->fast_amplitude = fast_amplitude;
    f->beyond_gap = amplitude > 1.0 ? (1.0 - 1.0 / amplitude) * share : 0.0;
}

/* The fastest slow frequency, eigenfrequency included. */
static double slow_of(const struct prepared *full, int fast)
{
    double slow = full->m->n_states == 2 ? full->m->eigenfrequency(full->p) : 0.0;
    for (int i = 0; i < full->m->n_inputs; i++)
        if (i != fast && fabs(full->drive[i].amplitude) > 0.0)
            slow = fmax(slow, full->drive[i].omega);
    return slow;
}

void choose_facts_of(const struct choose_candidate *candidate, int n, const struct choose_sweep *w,
                     struct choose_facts *f)
{
    struct prepared full, linear;
    bool swept = w && w->Hz.n > 0, predicts = (candidate[0].kind & (KIND_LINEAR | KIND_GAPLESS)) != 0;
    int holds = swept ? w->Hz.n : 1;
    prepare(&candidate[n - 1].scene, &full);
    if (predicts)
        prepare(&candidate[0].scene, &linear);
    *f = (struct choose_facts){.multiplier = 1.0};
    int fast = fast_input(&full), modulation = modulated(full.m);
    f->settle = 0.5 * maps_damping(full.m, full.p) * full.over / (swept ? 2.0 * holds : 1.0);
    for (int i = 0; i < holds; i++) {
        if (swept)
            full.drive[w->input].omega = 2.0 * ELEMENTARY_PI * full.time_s * range_value(&w->Hz, i);
        f->slow = fmax(f->slow, slow_of(&full, fast));
        double W = fast >= 0 ? full.drive[fast].omega : 0.0;
        f->fast = i > 0 ? fmin(f->fast, W) : W;
        if (!predicts)
            continue;
        for (int k = 0; k < linear.m->n_inputs; k++)
            linear.drive[k].omega = full.drive[k].omega;
        predict(&linear, &full, fast, f);
    }
    if (modulation >= 0 && fabs(full.drive[modulation].amplitude) > 0.0 &&
        full.drive[modulation].omega > 0.0 && !(swept && w->input == modulation))
        f->multiplier = multiplier(&candidate[n - 1].scene);
}

double choose_mismatch(const struct scene *full, const struct scene *candidate, double amplitude)
{
    struct prepared a, b;
    struct input u[MODEL_INPUTS] = {{0.0, 0.0}};
    double low = HUGE_VAL, high = -HUGE_VAL, most = 0.0;
    prepare(full, &a);
    prepare(candidate, &b);
    for (int i = 0; i <= CURVE; i++) {
        double x[2] = {a.rest[0] + amplitude * (2.0 * i / CURVE - 1.0), 0.0}, fa[2], fb[2];
        a.m->rhs(a.p, u, x, fa);
        b.m->rhs(b.p, u, x, fb);
        low = fmin(low, fa[1]);
        high = fmax(high, fa[1]);
        most = fmax(most, fabs(fa[1] - fb[1]));
    }
    return high > low ? most / (high - low) : 0.0;
}
