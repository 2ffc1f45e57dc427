/* judge.c - see judge.h. */
#include "host_sim/fit/judge.h"
#include "host_sim/fit/levers.h"
#include "host_sim/fit/solve/problem_curves.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include "host_sim/cli/clock.h"
#include "host_sim/fit/profile.h"
#include "host_sim/fit/sequence.h"
#include "host_sim/fit/solve/problem.h"
#include "host_sim/out/plural.h"

static const double chi2_most = 4.0;
static const double far = 10.0; /* standard deviations: a point beside a jump that is on its other side */
static const double chi2_deviations = 4.0; /* above its mean: told */
static const double chi2_least = 0.1;      /* below, the residuals are smaller than any that matter */
static const double worst_most = 5.0;
static const double left_most = 0.1;    /* share of a motion that is left where its noise is not known */
static const double start_most = 100.0; /* a number over that of the scene, or back */
static const double runs_least = -4.0;  /* fewer runs are told */

static void add(int *n, char (*text)[JUDGE_TEXT], const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void add(int *n, char (*text)[JUDGE_TEXT], const char *format, ...)
{
    va_list list;
    if (*n == JUDGE_REASONS)
        return;
    va_start(list, format);
    (void)vsnprintf(text[(*n)++], JUDGE_TEXT, format, list);
    va_end(list);
}

/* Student's quantiles, by the first term of their series in 1/degrees of freedom. */
double judge_quantile(const struct fit_setup *s, const struct fit_result *r, bool wide)
{
    double z = wide ? 1.959964 : 0.994458;
    int freedom = r->n_numbers - s->n;
    return s->noise_known || freedom < 1 ? z : z + (z * z * z + z) / (4.0 * freedom);
}

/* ---- residuals ---- */

struct runs {
    int runs, positive, negative;
};

/* The signs along a sequence; numbers that do not count are passed over. */
static struct runs runs_of(const struct fit_setup *s, const struct sequence *e, const double *r)
{
    struct runs t = {0};
    bool was = false;
    for (int i = 0; i < e->n; i++) {
        bool up = r[e->first + i * e->step] > 0.0;
        if (!sequence_counts(s, e, i))
            continue;
        t.runs += t.positive + t.negative == 0 || up != was;
        t.positive += up;
        t.negative += !up;
        was = up;
    }
    return t;
}

/* Runs of equal signs, against their number by chance (Wald and Wolfowitz 1940). */
static double count_runs(const struct fit_setup *s, const double *r)
{
    double expected = 0.0, variance = 0.0;
    struct sequence e;
    int seen = 0;
    for (int q = 0; sequence_nth(s, q, &e); q++) {
        struct runs t = runs_of(s, &e, r);
        double a = t.positive, b = t.negative, n = a + b;
        if (n < 2.0)
            continue;
        expected += 2.0 * a * b / n + 1.0;
        variance += fmax(2.0 * a * b * (2.0 * a * b - n) / (n * n * (n - 1.0)), 0.0);
        seen += t.runs;
    }
    return variance > 0.0 ? (seen - expected) / sqrt(variance) : 0.0;
}

static void find_worst(const struct fit_setup *s, const double *r, struct judged *j)
{
    struct sequence e;
    for (int q = 0; sequence_nth(s, q, &e); q++)
        for (int i = 0; i < e.n; i++)
            if (fabs(r[e.first + i * e.step]) > j->worst) {
                j->worst = fabs(r[e.first + i * e.step]);
                sequence_name(s, &e, i, j->worst_at, sizeof j->worst_at);
            }
}

static void judge_residuals(struct fit_setup *s, const struct fit_result *r, struct judged *j)
{
    struct problem p = {s, PROBLEM_PLAIN};
    double *residual = calloc((size_t)s->n_residuals + 1, sizeof *residual);
    if (!residual)
        return;
    (void)problem_residuals(&p, r->u, residual);
    j->runs = count_runs(s, residual);
    find_worst(s, residual, j);
    free(residual);
    j->chi2_each = r->chi2 / (r->n_numbers - s->n);
    if (!(j->chi2_each <= chi2_most))
        add(&j->n, j->reason, "chi^2 per number is %.3g, above %g: this plant does not give these data%s",
            j->chi2_each, chi2_most, s->noise_known ? ", or the noise is larger than said" : "");
    double above = (j->chi2_each - 1.0) * sqrt(0.5 * (r->n_numbers - s->n));
    above *= s->levers.n ? 0.5 : 1.0; /* the noise of a lever's data is taken from them, too */
    if ((s->noise_known || s->levers.n) && j->chi2_each <= chi2_most && above > chi2_deviations)
        add(&j->n_notes, j->note,
            "chi^2 is %.1f standard deviations above what this noise gives: the rig is not quite this plant, "
            "or "
            "its noise is larger",
            above);
    if (s->levers.n && j->worst > far)
        add(&j->n, j->reason, "the worst point is %.1f standard deviations off: this lever does not give it",
            j->worst);
    if (j->worst > worst_most)
        add(&j->n_notes, j->note,
            "the worst point is %.1f standard deviations off: look at it, or at the model", j->worst);
    if (j->runs < runs_least && j->chi2_each > chi2_least)
        add(&j->n_notes, j->note,
            "the residuals are not white (%.1f standard deviations): something in the rig is not in the "
            "model, and the "
            "intervals are too narrow",
            -j->runs);
}

/* A noise that was taken from the residuals hides a wrong model where neighbours in a record differ much. */
static void judge_records(const struct fit_setup *s, struct judged *j)
{
    for (int i = 0; i < s->records.n; i++) {
        const struct record *x = &s->records.record[i];
        if (x->assumed && x->noise > left_most * x->size)
            add(&j->n, j->reason,
                "%s: the fit leaves %.0f %% of this motion; this plant does not give it, or say its noise",
                x->path, 100.0 * x->noise / x->size);
    }
}

/* ---- motions ---- */

/* Is this point on another branch than the sweep's direction leads to? */
static bool astray(const struct fit_setup *s, const struct fit_result *r, int c, int i)
{
    const struct fit_point *p = &s->point[c][i];
    return p->other || (p->flank && problem_curves_miss(s, r->u, &s->data.curve[c], i, &p->at) > far);
}

/* One such point beside a jump is told; more are refused. */
static void judge_jumps(const struct fit_setup *s, const struct fit_result *r, struct judged *j)
{
    for (int c = 0; c < s->data.n; c++) {
        const struct curve *curve = &s->data.curve[c];
        int n = 0, first = -1;
        for (int i = 0; i < curve->n; i++) {
            first = first < 0 && astray(s, r, c, i) ? i : first;
            n += astray(s, r, c, i);
        }
        if (n == 1)
            add(&j->n_notes, j->note,
                "%s: at %.6g Hz the rig is on one side of its jump, and the fitted plant on the other",
                curve->path, curve->point[first].frequency_Hz);
        if (n > 1)
            add(&j->n, j->reason,
                "%s: a jump is on the wrong side: %d points from %.6g Hz on are on the other branch than the "
                "fitted "
                "plant, swept %s",
                curve->path, n, curve->point[first].frequency_Hz, curve->down ? "down" : "up");
    }
}

/* ---- unknowns ---- */

static void judge_bounds(const struct fit_setup *s, const struct fit_result *r, struct judged *j)
{
    double wide = judge_quantile(s, r, true);
    for (int k = 0; k < s->n; k++) {
        const struct fit_unknown *x = &s->unknown[k];
        if (fit_is_hidden(x))
            continue;
        double low = r->u[k] - wide * r->sd[k], high = r->u[k] + wide * r->sd[k];
        double least = unknown_u(x, x->min), most = unknown_u(x, x->max);
        if (low <= least || high >= most)
            add(&j->n, j->reason,
                "the interval of %s reaches the bound of its range, %g to %g%s%s: the data do not tell it",
                x->name, x->min, x->max, *x->unit ? " " : "", x->unit);
    }
}

/* A number far from the scene's may be a wrong unit. A lever's modulus is looked for that far away. */
static void judge_units(const struct fit_setup *s, const struct fit_result *r, struct judged *j)
{
    for (int k = 0; k < s->n && !s->levers.n; k++) {
        const struct fit_unknown *x = &s->unknown[k];
        double times = unknown_value(x, r->u[k]) / x->start;
        if (x->kind != FIT_PARAMETER || r->sd[k] > 1.0 || (times < start_most && times > 1.0 / start_most))
            continue;
        add(&j->n_notes, j->note, "%s is %.3g times that of the scene: are the units of the data right?",
            x->name, times);
        return;
    }
}

/* Where chi^2 rises too slowly beside the unknown that is known least, the intervals come from its profile.
 * Those of the others follow it. */
static void judge_rise(struct fit_setup *s, struct fit_result *r, struct judged *j)
{
    int k = starts_weakest(s, r);
    if (r->interrupted || j->n)
        return;
    s->task.to_the_end = false;
    double wider = profile_widening(s, r, k);
    s->task.to_the_end = true;
    if (clock_interrupted())
        add(&j->n, j->reason, "interrupted: how chi^2 rises beside %s is left out", s->unknown[k].name);
    else if (isinf(wider))
        add(&j->n, j->reason, "chi^2 hardly rises beside %s: the data do not tell it", s->unknown[k].name);
    else if (wider > 1.0) {
        starts_widen(s, r, k, wider);
        add(&j->n_notes, j->note,
            "chi^2 is no parabola beside %s: its interval comes from its profile, and is %.2g times as wide "
            "as by the slopes",
            s->unknown[k].name, wider);
    }
}

static void judge_starts(const struct fit_result *r, struct judged *j)
{
    int elsewhere = r->starts - r->agree - r->worse;
    if (elsewhere > 0)
        add(&j->n, j->reason,
            "%d of %d starts end%s elsewhere and fit%s as well: the data allow several plants", elsewhere,
            r->starts, singular(elsewhere), singular(elsewhere));
    else if (r->agree < 2 && r->starts > 1)
        add(&j->n, j->reason, "no second start of %d ends here: this may be a wrong minimum", r->starts);
    if (r->interrupted)
        add(&j->n, j->reason,
            "interrupted after %d of %d starts: the others, profiles and a further curve are left out",
            r->starts, FIT_STARTS);
}

void judge_fit(struct fit_setup *s, struct fit_result *r, struct judged *j)
{
    *j = (struct judged){.worst = 0.0};
    judge_residuals(s, r, j);
    judge_records(s, j);
    judge_jumps(s, r, j);
    judge_starts(r, j);
    judge_rise(s, r, j);
    judge_bounds(s, r, j);
    judge_units(s, r, j);
}
