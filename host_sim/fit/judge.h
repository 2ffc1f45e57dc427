/* judge.h - whether a fit can be believed: tests of its residuals, its intervals, its jumps and its starts.
 */
#ifndef HOST_SIM_FIT_JUDGE_H
#define HOST_SIM_FIT_JUDGE_H

#include "host_sim/fit/starts.h"

enum { JUDGE_REASONS = 24, JUDGE_TEXT = 300 };

struct judged {
    double chi2_each; /* chi^2 over numbers less unknowns */
    double
        runs; /* runs of equal signs: how many standard deviations above what chance gives; below 0: fewer */
    double worst;              /* the largest residual, in standard deviations */
    char worst_at[JUDGE_TEXT]; /* its place */
    int n;                     /* reasons why the fit is refused */
    char reason[JUDGE_REASONS][JUDGE_TEXT];
    int n_notes; /* notes that are told, and refuses nothing */
    char note[JUDGE_REASONS][JUDGE_TEXT];
};

/* Widens intervals of *r that are too narrow. s->point is no longer that of r->u then. */
void judge_fit(struct fit_setup *s, struct fit_result *r, struct judged *j);

/* The number of standard deviations that holds 68 % or 95 % (`wide`) of this fit's errors. */
double judge_quantile(const struct fit_setup *s, const struct fit_result *r, bool wide);

#endif
