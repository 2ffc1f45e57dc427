/* peak_force.c - see peak_force.h. */
#include "firmware/afm/peak_force.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include "models/afm_lever.h"
#include "models/math/elementary.h"

/* ---- set-up ---- */

uint32_t peak_force_samples(double frequency_Hz, double sample_s)
{
    double n = 1.0 / (frequency_Hz * sample_s) + 1e-6;
    return n < 4e9 ? (uint32_t)n : 4000000000u;
}

void peak_force_init(struct peak_force *p, const struct peak_force_config *c, double low_m)
{
    memset(p, 0, sizeof *p);
    p->samples = peak_force_samples(c->frequency_Hz, c->sample_s);
    p->i = p->samples / 2;
    p->each = 1 + p->samples / PEAK_FORCE_EACH;
    p->from_m = p->to_m = low_m;
    p->amplitude_m = c->amplitude_m;
    p->stiffness = c->stiffness;
    p->hertz = 4.0 / 3.0 * sqrt(c->radius_m);
    double turn = 2.0 * ELEMENTARY_PI * c->f0_Hz * c->sample_s;
    p->drag = c->stiffness / (12.0 * c->quality * turn);
    p->mass = c->stiffness / (12.0 * turn * turn);
}

/* ---- a cycle ---- */

static void begin_near(struct peak_force *p, double place)
{
    p->baseline = p->n_far ? p->far_sum / p->n_far : 0.0;
    p->far_sum = 0.0;
    p->n_far = 0;
    p->whole = true;
    p->peak = -DBL_MAX;
    p->low = p->lowest = p->deepest = DBL_MAX;
    p->snap_in = p->deepest_force = 0.0;
    p->zero = place;
    p->work = 0.0;
    p->before = (struct force_point){0.0, place};
    p->n_band = p->skipped = p->n_last = 0;
    p->stride = 1;
}

/* Every second point goes where there is no more room. */
static void thin_band(struct peak_force *p)
{
    for (uint32_t i = 0; i < PEAK_FORCE_BAND / 2; i++)
        p->band[i] = p->band[2 * i];
    p->n_band = PEAK_FORCE_BAND / 2;
    p->stride *= 2;
}

static void add_to_band(struct peak_force *p, const struct force_point *f)
{
    if (f->force < 0.1 * p->peak)
        return;
    if (p->skipped++ % p->stride)
        return;
    if (p->n_band == PEAK_FORCE_BAND)
        thin_band(p);
    p->band[p->n_band++] = *f;
}

/* A new peak: all that counts from it begins anew. */
static void take_peak(struct peak_force *p, const struct force_point *f)
{
    p->peak = f->force;
    p->snap_in = p->lowest;
    p->contact = p->zero;
    p->deepest_force = DBL_MAX;
    p->n_band = p->skipped = p->n_pulled = 0;
    p->stride = 1;
}

/* The points before the deepest one, from where the force was 60 % of it back to where it was 0. */
static void find_pulled(struct peak_force *p)
{
    p->n_pulled = 0;
    for (uint32_t k = 1; k < PEAK_FORCE_LAST && k < p->n_last && p->n_pulled < PEAK_FORCE_PULLED; k++) {
        const struct force_point *f = &p->last[(p->n_last - 1 - k) % PEAK_FORCE_LAST];
        if (f->force > 0.0)
            return;
        if (p->n_pulled > 0 || f->force >= 0.6 * p->deepest_force)
            p->pulled[p->n_pulled++] = *f;
    }
}

static void take_near(struct peak_force *p, const struct force_point *f)
{
    const struct force_point *was = &p->before;
    p->work -= 0.5 * (f->force + was->force) * (f->place - was->place);
    if (was->force <= 0.0 && f->force > 0.0)
        p->zero = f->place + (was->place - f->place) * f->force / (f->force - was->force);
    if (p->i % p->each == 0)
        p->last[p->n_last++ % PEAK_FORCE_LAST] = *f;
    p->lowest = f->force < p->lowest ? f->force : p->lowest;
    p->deepest = f->place < p->deepest ? f->place : p->deepest;
    if (f->force > p->peak)
        take_peak(p, f);
    else
        add_to_band(p, f);
    if (f->force < p->deepest_force) {
        p->deepest_force = f->force;
        find_pulled(p);
    }
    p->before = *f;
}

/* ---- modulus and adhesion ---- */

/* x^(2/3) and x^(3/2) of x > 0, else 0. */
static double two_thirds(double x)
{
    double root = x > 0.0 ? cube_root(x) : 0.0;
    return root * root;
}

static double three_halves(double x)
{
    return x > 0.0 ? x * sqrt(x) : 0.0;
}

struct line {
    double at, slope; /* (F + adhesion)^(2/3) = at + slope s */
};

static double law(const struct line *l, double adhesion, double place)
{
    return three_halves(l->at + l->slope * place) - adhesion;
}

/* Least squares over the points whose force by the last line, if there is one, is 30 to 90 % of the peak.
 * False without a slope towards the sample. */
static bool fit_line(const struct peak_force *p, double adhesion, struct line *l)
{
    enum { POINTS = 5 };
    double s0 = p->pulled[0].place, s = 0.0, u = 0.0, ss = 0.0, su = 0.0, n = 0.0;
    for (uint32_t i = 0; i < p->n_band; i++) {
        const struct force_point *f = &p->band[i];
        double there = l->slope < 0.0 ? law(l, adhesion, f->place) : f->force;
        if (there < 0.3 * p->peak || there > 0.9 * p->peak)
            continue;
        double x = f->place - s0, y = two_thirds(f->force + adhesion);
        n += 1.0;
        s += x;
        u += y;
        ss += x * x;
        su += x * y;
    }
    double spread = ss - s * s / n;
    if (n < POINTS || !(spread > 0.0))
        return false;
    l->slope = (su - s * u / n) / spread;
    l->at = (u - l->slope * s) / n - l->slope * s0;
    return l->slope < 0.0;
}

/* The law's force at no indentation, from the points before the pull-off. */
static double pull_of(const struct peak_force *p, const struct line *l)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < p->n_pulled; i++)
        sum += law(l, 0.0, p->pulled[i].place) - p->pulled[i].force;
    return sum / p->n_pulled;
}

/* Fit and adhesion in turns. They are refused where they leave the deepest force by a quarter: then the tip
 * jumps, and no law holds. */
static void fit(struct peak_force *p, struct force_cycle *c)
{
    enum { ROUNDS = 8 };
    struct line l = {0.0, 0.0};
    double adhesion = c->adhesion_N;
    bool good = p->n_pulled > 0;
    for (int i = 0; i < ROUNDS && good; i++) {
        good = fit_line(p, adhesion, &l);
        adhesion = good ? pull_of(p, &l) : adhesion;
        good = good && fabs(adhesion - c->adhesion_N) <= 0.25 * c->adhesion_N;
    }
    c->fitted = good;
    if (!good)
        return;
    c->adhesion_N = adhesion;
    c->modulus_Pa = three_halves(-l.slope) / p->hertz;
}

static void end_near(struct peak_force *p)
{
    struct force_cycle *c = &p->cycle;
    *c = (struct force_cycle){.n = c->n + 1,
                              .touched = p->peak >= p->least_N,
                              .peak_N = p->peak,
                              .baseline_N = p->baseline,
                              .low_m = p->low};
    if (!c->touched)
        return;
    c->snap_in_N = -p->snap_in;
    c->adhesion_N = p->deepest_force < 0.0 ? -p->deepest_force : 0.0;
    c->work_J = p->work;
    c->deformation_m = p->contact - p->deepest;
    fit(p, c);
}

/* ---- a sample ---- */

/* The force two samples ago, and the place of the tip there. False where too few readings were seen. */
static bool force_of(struct peak_force *p, double d, double z, struct force_point *f)
{
    struct force_reading *r = p->read;
    memmove(r, r + 1, (PEAK_FORCE_STENCIL - 1) * sizeof *r);
    r[PEAK_FORCE_STENCIL - 1] = (struct force_reading){d, d + beam_modes[0].base * z, d + z};
    if (p->n_read < PEAK_FORCE_STENCIL - 1) {
        p->n_read++;
        return false;
    }
    double rate = 8.0 * (r[3].deflection - r[1].deflection) - (r[4].deflection - r[0].deflection);
    double bend = 16.0 * (r[3].moved + r[1].moved) - (r[4].moved + r[0].moved) - 30.0 * r[2].moved;
    f->force = p->stiffness * r[2].deflection + p->drag * rate + p->mass * bend;
    f->place = r[2].place;
    return true;
}

bool peak_force_read(struct peak_force *p, double deflection_m, double z_m)
{
    struct force_point f;
    uint32_t near = p->samples / 4, far = p->samples - near, i = p->i;
    if (!force_of(p, deflection_m, z_m, &f))
        return false;
    if (i == near)
        begin_near(p, f.place);
    bool ends = i == far && p->whole;
    if (ends)
        end_near(p);
    if (i < near || i >= far) {
        p->far_sum += f.force;
        p->n_far++;
    } else if (p->whole) {
        p->low = z_m < p->low ? z_m : p->low;
        f.force -= p->baseline;
        take_near(p, &f);
    }
    return ends;
}

double peak_force_z(struct peak_force *p)
{
    double c, unused, quarter = p->samples / 4, part;
    p->i = p->i + 1 < p->samples ? p->i + 1 : 0;
    part = p->i < quarter ? p->i / quarter : 1.0;
    cos_sin_turns(turns_of((double)p->i / p->samples), &c, &unused);
    return p->from_m + part * (p->to_m - p->from_m) + p->amplitude_m * (1.0 + c);
}
