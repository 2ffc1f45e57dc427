/* tell.c - see tell.h. */
#include "host_sim/fit/tell.h"
#include "host_sim/fit/solve/unknown.h"

#include <math.h>
#include <string.h>
#include "host_sim/cli/unit.h"
#include "host_sim/fit/levers.h"
#include "host_sim/fit/plan.h"
#include "host_sim/fit/solve/problem.h"
#include "host_sim/out/plural.h"
#include "host_sim/out/utf8.h"

enum { POWER_MOST = 3, LEVELS = 3 };
static const double told_most = 10.0; /* a wider interval says that nothing is known */
static const double weak = 0.05;      /* one standard deviation: a direction that is named */
static const double share = 0.1;      /* share of the weakest direction: an unknown that it moves */
static const double settled = 0.02;   /* the unknowns' standard deviations: a plan that is good enough */
static const double better = 0.5; /* a plan that makes the largest smaller than this is worth a sentence */

const char *tell_value(const struct fit_unknown *k, double value, double sd, char *text)
{
    int digits = 2;
    if (k->kind < FIT_DELAY && sd >= told_most) {
        snprintf(text, UNIT_TEXT, "unknown");
        return text;
    }
    for (double x = k->kind >= FIT_DELAY ? sd * k->unit_of_u / fmax(fabs(value), 1e-300) : sd;
         x < 1.0 && digits < 9; x *= 10.0)
        digits++;
    unit_tell(value, digits, k->unit, text);
    return text;
}

const char *tell_width(const struct fit_unknown *k, double width, char *text)
{
    if (k->kind >= FIT_DELAY)
        unit_tell(width * k->unit_of_u, 2, k->unit, text);
    else {
        snprintf(text, UNIT_TEXT, width < 1.0 ? "%.2g %%" : "%.0f %%", 100.0 * width);
        if (width >= told_most)
            snprintf(text, UNIT_TEXT, "> %.0f %%", 100.0 * told_most);
    }
    return text;
}

static void tell_table(const struct fit_setup *s, const struct fit_result *r, FILE *f)
{
    fprintf(f, "  %-18s %-24s %-12s %-12s %s\n", "", "value", "68 %", "95 %", "start");
    for (int k = 0; k < s->n; k++) {
        const struct fit_unknown *x = &s->unknown[k];
        if (fit_is_hidden(x))
            continue;
        char value[UNIT_TEXT], narrow[UNIT_TEXT], wide[UNIT_TEXT], start[UNIT_TEXT], half[2][UNIT_TEXT + 4];
        tell_value(x, unknown_value(x, r->u[k]), r->sd[k], value);
        snprintf(half[0], sizeof half[0], "+- %s",
                 tell_width(x, judge_quantile(s, r, false) * r->sd[k], narrow));
        snprintf(half[1], sizeof half[1], "+- %s",
                 tell_width(x, judge_quantile(s, r, true) * r->sd[k], wide));
        unit_tell(x->start, 5, x->unit, start);
        fprintf(f, "  %-18s %-*s %-*s %-*s %s\n", x->name, utf8_field(value, 24), value,
                utf8_field(half[0], 12), half[0], utf8_field(half[1], 12), half[1], start);
    }
}

/* ---- what is known only together ---- */

/* The standard deviation of a power product: sum of power[k] u[k]. */
static double product_sd(const struct fit_setup *s, const struct fit_result *r, const int *power)
{
    double sum = 0.0;
    for (int i = 0; i < s->n; i++)
        for (int k = 0; k < s->n; k++)
            sum += power[i] * power[k] * r->covariance[i][k];
    return sqrt(fmax(sum, 0.0));
}

/* The two unknowns that the weakest direction moves most. */
static void find_pair(const struct fit_setup *s, const struct fit_result *r, int pair[2])
{
    pair[0] = starts_weakest(s, r);
    pair[1] = -1;
    for (int k = 0; k < s->n; k++)
        if (k != pair[0])
            pair[1] = pair[1] < 0 || fabs(r->weak[k]) > fabs(r->weak[pair[1]]) ? k : pair[1];
}

/* The power product of two unknowns that is known best. */
static double find_product(const struct fit_setup *s, const struct fit_result *r, const int pair[2],
                           int power[FIT_UNKNOWNS])
{
    double least = HUGE_VAL;
    for (int a = 1; a <= POWER_MOST; a++)
        for (int b = -POWER_MOST; b <= POWER_MOST; b++) {
            int other[FIT_UNKNOWNS] = {0};
            other[pair[0]] = b;
            other[pair[1]] = a;
            double sd = product_sd(s, r, other) / sqrt((double)(a * a + b * b));
            if (b && sd < 0.999 * least) {
                least = sd;
                memcpy(power, other, sizeof other);
            }
        }
    return product_sd(s, r, power);
}

static void name_power(const struct fit_setup *s, int k, int power, char *text, size_t size)
{
    if (power == 1)
        snprintf(text, size, "%s", s->unknown[k].name);
    else
        snprintf(text, size, "%s^%d", s->unknown[k].name, power);
}

static void tell_together(const struct fit_setup *s, const struct fit_result *r, FILE *f)
{
    int pair[2], power[FIT_UNKNOWNS] = {0};
    char a[FIT_NAME + 8], b[FIT_NAME + 8], width[3][UNIT_TEXT];
    double wide = judge_quantile(s, r, false);
    find_pair(s, r, pair);
    double sd = find_product(s, r, pair, power);
    name_power(s, pair[0], power[pair[0]], a, sizeof a);
    name_power(s, pair[1], power[pair[1]], b, sizeof b);
    fprintf(f, "these data give %s %s to %s; %s and %s apart only to %s and %s\n", b, a,
            tell_width(&s->unknown[pair[0]], wide * sd, width[0]), s->unknown[pair[1]].name,
            s->unknown[pair[0]].name, tell_width(&s->unknown[pair[1]], wide * r->sd[pair[1]], width[1]),
            tell_width(&s->unknown[pair[0]], wide * r->sd[pair[0]], width[2]));
}

/* Every unknown that moves along the weakest direction, where more than two do. False: only two. */
static bool tell_direction(const struct fit_setup *s, const struct fit_result *r, FILE *f)
{
    int moved = 0;
    for (int k = 0; k < s->n; k++)
        moved += fabs(r->weak[k]) > share;
    if (moved <= 2)
        return false;
    fprintf(f, "these data tell nothing of a common factor of");
    for (int k = 0, told = 0; k < s->n; k++)
        if (fabs(r->weak[k]) > share)
            fprintf(f, "%s %s^%.2g", told++ ? "," : "", s->unknown[k].name, r->weak[k]);
    fprintf(f, "; hold one of them\n");
    return true;
}

static double largest(const struct fit_setup *s, const double *sd)
{
    double most = 0.0;
    for (int k = 0; k < s->n; k++)
        if (s->unknown[k].kind < FIT_DELAY)
            most = fmax(most, sd[k]);
    return most;
}

/* The first of some larger drives that would part the unknowns. */
static void tell_plan(struct fit_setup *s, const struct fit_result *r, FILE *f)
{
    static const double factor[LEVELS] = {3.0, 10.0, 30.0};
    const struct curve *last = &s->data.curve[s->data.n - 1];
    double best[FIT_UNKNOWNS], at = 0.0;
    int pair[2];
    for (int i = 0; i < LEVELS && !(at > 0.0 && largest(s, best) < settled); i++) {
        double sd[FIT_UNKNOWNS];
        if (!plan_further(s, r, s->data.n - 1, factor[i] * last->amplitude, sd) ||
            !(largest(s, sd) < (at > 0.0 ? largest(s, best) : better * largest(s, r->sd))))
            continue;
        memcpy(best, sd, sizeof best);
        at = factor[i] * last->amplitude;
    }
    if (!(at > 0.0)) {
        fprintf(f, "a larger drive at the same frequencies would not part them\n");
        return;
    }
    char level[UNIT_TEXT], a[UNIT_TEXT], b[UNIT_TEXT];
    unit_tell(at, 3, s->scene.model->input_signal[last->input].unit, level);
    find_pair(s, r, pair);
    double wide = judge_quantile(s, r, false);
    fprintf(f, "a further sweep at %s, with the same noise, would give %s and %s to %s and %s\n", level,
            s->unknown[pair[1]].name, s->unknown[pair[0]].name,
            tell_width(&s->unknown[pair[1]], wide * best[pair[1]], a),
            tell_width(&s->unknown[pair[0]], wide * best[pair[0]], b));
}

/* ---- all of it ---- */

static void tell_residuals(const struct fit_setup *s, const struct fit_result *r, const struct judged *j,
                           FILE *f)
{
    fprintf(f,
            "chi^2 per number %.3g, of %d numbers; runs %+.1f; worst point %s: %.1f standard "
            "deviations\n",
            j->chi2_each, r->n_numbers, j->runs, j->worst_at, j->worst);
    if (!s->noise_known)
        fprintf(f, "the data do not say their noise: it is taken from how neighbouring points differ\n");
    fprintf(f, "%d of %d start%s end%s here%s\n", r->agree, r->starts, plural(r->starts), singular(r->agree),
            r->worse ? "; the others in worse minima" : "");
}

void tell_fit(struct fit_setup *s, const struct fit_result *r, const struct judged *j, FILE *f)
{
    int hidden = 0;
    for (int k = 0; k < s->n; k++)
        hidden += fit_is_hidden(&s->unknown[k]);
    fprintf(f, "%s: %d unknown%s, ", s->name, s->n - hidden, plural(s->n - hidden));
    if (s->levers.n)
        fprintf(f, "%s\n",
                s->levers.n > 1          ? "a spectrum and a force curve"
                : s->levers.data[0].kind ? "a force curve"
                                         : "a spectrum");
    else
        fprintf(f, "%d curve%s, %d record%s\n", s->data.n, plural(s->data.n), s->records.n,
                plural(s->records.n));
    tell_table(s, r, f);
    tell_residuals(s, r, j, f);
    if (s->n - hidden > 1 && largest(s, r->sd) > weak) {
        if (!tell_direction(s, r, f))
            tell_together(s, r, f);
        if (s->data.n && !r->interrupted)
            tell_plan(s, r, f);
    }
    if (s->levers.n)
        levers_tell_rest(s, f);
    for (int i = 0; i < j->n_notes; i++)
        fprintf(f, "note: %s\n", j->note[i]);
}
