/* levers.c - see levers.h. */
#include "host_sim/fit/levers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host_sim/afm/thermal.h"
#include "host_sim/fit/noise.h"
#include "host_sim/fit/solve/problem_levers.h"
#include "host_sim/fit/solve/unknown.h"
#include "host_sim/scene/scene_keys.h"
#include "models/afm_lever.h"

enum { GRID = 33, SHARES = 5, PAIRS_LEAST = 8, QUIET = 4, NOISE_ROUNDS = 3, RINGING = 6, WINDOW = 24 };
static const double grid_most = 8.0;   /* logarithm of the modulus over the scene's, to both sides */
static const double jumps = 8.0;       /* times the median step of a curve: a jump */
static const double rings = 1.5;       /* times the bends when it is still */
static const double first_sigma = 0.3; /* share of a density, until there are residuals */

static const struct lever_data *find_data(const struct fit_setup *s, enum lever_kind kind)
{
    for (int i = 0; i < s->levers.n; i++)
        if (s->levers.data[i].kind == kind)
            return &s->levers.data[i];
    return NULL;
}

/* ---- unknowns ---- */

bool levers_tell(const struct fit_setup *s, int parameter)
{
    static const int spectrum[] = {LEVER_F0, LEVER_K, LEVER_Q};
    static const int curve[] = {LEVER_MODULUS, LEVER_HAMAKER, LEVER_HAMAKER_OUT};
    const struct lever_data *force = find_data(s, LEVER_CURVE);
    bool told = false;
    for (int i = 0; i < 3; i++) {
        told = told || (find_data(s, LEVER_SPECTRUM) && parameter == spectrum[i]);
        told = told || (force && (i < 2 || force->has_back) && parameter == curve[i]);
    }
    return told;
}

static double reach_of(const struct lever_data *d)
{
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (int i = 0; i < d->n; i++) {
        least = fmin(least, d->x[i]);
        most = fmax(most, d->x[i]);
    }
    return most - least;
}

int levers_add_chain(struct fit_setup *s, int (*add)(struct fit_setup *s, const struct fit_unknown *k))
{
    const struct lever_data *force = find_data(s, LEVER_CURVE), *heat = find_data(s, LEVER_SPECTRUM);
    struct fit_unknown k = {.kind = FIT_CONTACT, .name = "contact", .unit = "m", .min = -1.0, .max = 1.0};
    int status = 0;
    if (force) {
        k.unit_of_u = 0.01 * reach_of(force);
        status = add(s, &k);
        k.kind = FIT_BASELINE;
        k.start = force->baseline_m;
        snprintf(k.name, sizeof k.name, "baseline");
        status = status ? status : add(s, &k);
    }
    if (!status && heat && heat->white > 0.0) {
        k = (struct fit_unknown){
            .kind = FIT_WHITE, .name = "white", .unit = "", .max = 1.0, .start = heat->white};
        k.unit_of_u = heat->white;
        status = add(s, &k);
    }
    return status;
}

/* ---- starts ---- */

static void put(const struct fit_setup *s, double *u, enum fit_kind kind, int index, double value)
{
    for (int k = 0; k < s->n; k++) {
        const struct fit_unknown *x = &s->unknown[k];
        if (x->kind == kind && (kind != FIT_PARAMETER || x->index == index))
            u[k] = fmin(fmax(unknown_u(x, value), unknown_u(x, x->min)), unknown_u(x, x->max));
    }
}

static double get(const struct fit_setup *s, const double *u, int index)
{
    for (int k = 0; k < s->n; k++)
        if (s->unknown[k].kind == FIT_PARAMETER && s->unknown[k].index == index)
            return unknown_value(&s->unknown[k], u[k]);
    return s->scene.value[index];
}

static void start_spectrum(const struct fit_setup *s, const struct lever_data *d, double *u)
{
    put(s, u, FIT_PARAMETER, LEVER_F0, d->f0_Hz);
    put(s, u, FIT_PARAMETER, LEVER_Q, d->quality);
    put(s, u, FIT_PARAMETER, LEVER_K,
        s->scene.value[LEVER_K] * thermal_square(s->scene.value) / d->square_m2);
}

/* Contact where the lowest base has its load, at the numbers of u. */
static void start_contact(const struct fit_setup *s, const struct lever_data *d, double *u)
{
    double a0 = s->scene.value[LEVER_A0], radius = s->scene.value[LEVER_RADIUS];
    double hertz = 4.0 / 3.0 * get(s, u, LEVER_MODULUS) * sqrt(radius);
    int low = 0;
    for (int i = 0; i < d->n; i++)
        low = d->x[i] < d->x[low] && !d->back[i] ? i : low;
    double x = d->y[low] - d->baseline_m;
    double load = get(s, u, LEVER_K) * x + get(s, u, LEVER_HAMAKER) * radius / (6.0 * a0 * a0);
    double root = cbrt(fmax(load, 0.0) / hertz);
    put(s, u, FIT_CONTACT, 0, d->x[low] - (a0 - root * root - x));
}

/* The largest pull on the way back is that of the adhesion. */
static void start_adhesion(const struct fit_setup *s, const struct lever_data *d, double *u)
{
    double a0 = s->scene.value[LEVER_A0], most = 0.0;
    for (int i = 0; i < d->n; i++)
        most = d->back[i] ? fmax(most, d->baseline_m - d->y[i]) : most;
    if (!(most > 0.0))
        return;
    double hamaker = 6.0 * a0 * a0 * get(s, u, LEVER_K) * most / s->scene.value[LEVER_RADIUS];
    put(s, u, FIT_PARAMETER, LEVER_HAMAKER, hamaker);
    put(s, u, FIT_PARAMETER, LEVER_HAMAKER_OUT, hamaker);
}

/* Moduli, and shares of the adhesion on the way in: those that fit best. */
static void start_curve(struct fit_setup *s, const struct lever_data *d, double *u)
{
    struct problem p = {s, PROBLEM_PLAIN};
    double best[FIT_UNKNOWNS], least = HUGE_VAL, *r = calloc((size_t)s->n_residuals + 1, sizeof *r);
    start_adhesion(s, d, u);
    double hamaker = get(s, u, LEVER_HAMAKER);
    memcpy(best, u, sizeof best);
    for (int i = 0; r && i < GRID * SHARES; i++) {
        put(s, u, FIT_PARAMETER, LEVER_MODULUS,
            s->scene.value[LEVER_MODULUS] * exp(grid_most * (2.0 * (i / SHARES) / (GRID - 1) - 1.0)));
        put(s, u, FIT_PARAMETER, LEVER_HAMAKER, hamaker * (1.0 - (double)(i % SHARES) / SHARES));
        start_contact(s, d, u);
        double cost = problem_residuals(&p, u, r);
        if (cost < least) {
            least = cost;
            memcpy(best, u, sizeof best);
        }
    }
    memcpy(u, best, sizeof best);
    free(r);
}

/* The first fit says the noise, and which numbers are in contact; all starts need them alike. */
static void settle_noise(struct fit_setup *s, double *u)
{
    struct problem p = {s, PROBLEM_PLAIN};
    double *r = calloc((size_t)s->n_residuals + 1, sizeof *r);
    int steps;
    for (int i = 0; r && i < NOISE_ROUNDS; i++) {
        s->levers.sides_known = false;
        (void)problem_residuals(&p, u, r);
        s->levers.sides_known = true;
        (void)problem_solve(s, PROBLEM_PLAIN, u, &steps);
        (void)problem_residuals(&p, u, r);
        levers_estimate_noise(s, r);
    }
    free(r);
}

void levers_start(struct fit_setup *s, double *u)
{
    const struct lever_data *heat = find_data(s, LEVER_SPECTRUM), *force = find_data(s, LEVER_CURVE);
    if (heat)
        start_spectrum(s, heat, u);
    if (force)
        start_curve(s, force, u);
    settle_noise(s, u);
}

/* ---- noise ---- */

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_of(double *value, int n)
{
    qsort(value, (size_t)n, sizeof *value, compare);
    return value[n / 2];
}

/* How far the step behind row i is from the median of the steps behind rows from .. to - 1; their median
 * distance from it is *usual. False: there are too few. */
static bool step_from(const struct lever_data *d, int i, int from, int to, double *out, double *usual)
{
    double step[WINDOW], off[WINDOW];
    int n = 0;
    for (int k = from; k < to; k++)
        if (k >= 0 && k + 1 < d->n && d->back[k] == d->back[i] && d->back[k + 1] == d->back[i])
            step[n++] = d->y[k + 1] - d->y[k];
    if (n < QUIET)
        return false;
    double middle = median_of(step, n);
    for (int k = 0; k < n; k++)
        off[k] = fabs(step[k] - middle);
    *usual = median_of(off, n);
    *out = fabs(d->y[i + 1] - d->y[i] - middle);
    return true;
}

/* A jump is far from the steps before it and from those behind it; a kink is far from one of them. */
static bool is_jump(const struct lever_data *d, int i, double least)
{
    double before, behind, usual, unused;
    return d->back[i + 1] == d->back[i] && step_from(d, i, i - WINDOW, i, &before, &usual) &&
           step_from(d, i, i + 1, i + 1 + WINDOW, &behind, &unused) && before > jumps * fmax(usual, least) &&
           behind > 0.5 * before;
}

/* The step from row i to the next less the step before: noise and ringing, without the slope. */
static double bend_of(const struct lever_data *d, int i)
{
    return i > 0 && i + 1 < d->n ? fabs(d->y[i + 1] - 2.0 * d->y[i] + d->y[i - 1]) : 0.0;
}

static double mean_bend(const struct lever_data *d, int from, int to)
{
    double sum = 0.0;
    for (int i = from; i < to; i++)
        sum += bend_of(d, i);
    return sum / fmax(1.0, to - from);
}

/* The row at which the lever has stopped to ring from a jump before `from`; the next jump is at `to`. Away
 * from the sample it is as still as at the begin of the curve. */
static int end_of_ringing(const struct lever_data *d, int from, int to)
{
    int half = from + (to - from) / 2, last = d->back[from] ? to : half;
    double still = d->back[from] ? mean_bend(d, 1, d->n / 8) : mean_bend(d, half, to - QUIET);
    while (from < last && mean_bend(d, from, from + RINGING) > rings * still)
        from++;
    return from;
}

/* One jump into contact on the way in, or one out of it on the way back: there the data say which rows are in
 * contact. Jumps that follow each other closely are one. */
static void find_sides(struct lever_data *d, const bool *jump)
{
    int at[2] = {-1, -1}, n[2] = {0, 0}, last = -QUIET - 1;
    for (int i = 0; i + 1 < d->n; i++) {
        if (!jump[i])
            continue;
        if (i - last > QUIET && n[d->back[i]]++ == 0)
            at[d->back[i]] = i;
        last = i;
    }
    for (int way = 0; way < 2; way++)
        d->sides_told[way] = n[way] == 1;
    for (int i = 0; i < d->n; i++)
        if (d->sides_told[d->back[i]])
            d->side[i] = (i > at[d->back[i]]) != d->back[i] ? LEVER_CONTACT : LEVER_OUTSIDE;
}

/* Rows beside a jump, and those in which the lever still rings from it, do not count. */
static void skip_jumps(struct lever_data *d, double least)
{
    bool *jump = calloc((size_t)d->n + 1, sizeof *jump);
    for (int i = 0; jump && i + 1 < d->n; i++)
        jump[i] = is_jump(d, i, least);
    if (jump)
        find_sides(d, jump);
    for (int i = 0; jump && i + 1 < d->n; i++) {
        int next = i + 1;
        if (!jump[i])
            continue;
        while (next + 1 < d->n && !jump[next] && d->back[next + 1] == d->back[next])
            next++;
        int still = next - i < QUIET ? next : end_of_ringing(d, i + 1, next);
        for (int k = i; k <= still; k++)
            d->side[k] = LEVER_SKIPPED;
    }
    free(jump);
}

/* Half the mean square of the differences of neighbours. */
static double neighbours(const struct lever_data *d)
{
    double sum = 0.0;
    int n = 0;
    for (int i = 0; i + 1 < d->n; i++)
        if (d->side[i] != LEVER_SKIPPED && d->side[i + 1] != LEVER_SKIPPED) {
            sum += 0.5 * (d->y[i + 1] - d->y[i]) * (d->y[i + 1] - d->y[i]);
            n++;
        }
    return n ? sqrt(sum / n) : 0.0;
}

void levers_assume_noise(struct fit_setup *s)
{
    for (int j = 0; j < s->levers.n; j++) {
        struct lever_data *d = &s->levers.data[j];
        s->noise_known = false;
        d->sigma[LEVER_OUTSIDE] = d->sigma[LEVER_CONTACT] = first_sigma;
        if (d->kind == LEVER_SPECTRUM)
            continue;
        double least = NOISE_LEAST * record_deviation(d->y, d->n);
        skip_jumps(d, least);
        d->sigma[LEVER_OUTSIDE] = d->sigma[LEVER_CONTACT] = fmax(neighbours(d), least);
    }
}

/* Half the mean square of the differences of numbers that are `lag` apart, on this side. */
static double variance(const struct lever_data *d, const double *r, int side, int lag)
{
    double sum = 0.0;
    int n = 0;
    for (int i = 0; i + lag < d->n; i++)
        if (d->side[i] == side && d->side[i + lag] == side && d->back[i] == d->back[i + lag]) {
            sum += 0.5 * (r[i + lag] - r[i]) * (r[i + lag] - r[i]);
            n++;
        }
    return n < PAIRS_LEAST ? 1.0 : sum / n;
}

/* Neighbours are alike, as those of Welch's windows: how much wider the intervals are. */
static double widening(const struct lever_data *d, const double *r, int side)
{
    double all = variance(d, r, side, LEVER_LAG), sum = 1.0;
    for (int lag = 1; lag < LEVER_LAG; lag++)
        sum += 2.0 * (1.0 - variance(d, r, side, lag) / all);
    return sqrt(fmax(sum, 1.0));
}

void levers_estimate_noise(struct fit_setup *s, const double *r)
{
    r += s->n_residuals;
    for (int j = 0; j < s->levers.n; j++)
        r -= s->levers.data[j].n;
    for (int j = 0; j < s->levers.n; j++) {
        struct lever_data *d = &s->levers.data[j];
        double least = d->kind == LEVER_CURVE ? NOISE_LEAST * record_deviation(d->y, d->n) : 0.0;
        d->widen = 1.0;
        for (int side = 0; side < LEVER_SIDES; side++) {
            d->widen = fmax(d->widen, widening(d, r, side));
            d->sigma[side] = fmax(d->sigma[side] * sqrt(variance(d, r, side, LEVER_LAG)), least);
        }
        r += d->n;
    }
}

double levers_widening(const struct fit_setup *s)
{
    double widen = 1.0;
    for (int j = 0; j < s->levers.n; j++)
        widen = fmax(widen, s->levers.data[j].widen);
    return widen * widen;
}

/* ---- for people ---- */

void levers_tell_rest(const struct fit_setup *s, FILE *f)
{
    const struct model *m = s->scene.model;
    bool any = false;
    for (int i = LEVER_TEMPERATURE; i <= LEVER_VISCOSITY; i++) {
        bool unknown = false;
        for (int k = 0; k < s->n; k++)
            unknown = unknown || (s->unknown[k].kind == FIT_PARAMETER && s->unknown[k].index == i);
        if (unknown)
            continue;
        struct scene_key key;
        scene_keys_parameter(&m->parameter[i], 0, &key);
        fprintf(f, "%s%s", any ? ", " : "not determined, as in the scene: ", key.name);
        any = true;
    }
    fprintf(f, "\n");
}
