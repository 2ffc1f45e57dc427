/* lockin_fit.h - a tone without what leaks into it: the fit of a mean and several tones under a Hann window.
 *
 * The output is mean + sum over tones of Re(z exp(i theta)), and the tones are waves of constant frequency
 * over the window. Least squares under the window's weights give z of one of them from the sums of lockin.h.
 * The sums of products of two tones have a closed form (Dirichlet's kernel), so they cost nothing in a tick.
 * Where the output is of this form the fit is exact. A frequency that moves by f periods a window inside it
 * is taken as its mean: of what leaks in, pi f / 4 stays.
 *
 * A window tells a tone from the others if it is long enough. Once mean and other tones are taken out of the
 * tone, at least half of its power must be left. Alone it needs one period in the window; beside another tone
 * about three quarters of a period of their beat. So an error of the form of the output is amplified by at
 * most sqrt(2). */
#ifndef FIRMWARE_LOCKIN_FIT_H
#define FIRMWARE_LOCKIN_FIT_H

#include "firmware/observe/lockin.h"
#include "models/model.h"

enum { LOCKIN_TONES = MODEL_INPUTS + 1, LOCKIN_UNKNOWNS = 1 + 2 * LOCKIN_TONES };

/* Normal equations of a mean and tones, upper triangle: the mean, then cosine and sine of each tone. Column
 * LOCKIN_UNKNOWNS is the right side, sums of the output times each. */
struct lockin_normal {
    double g[LOCKIN_UNKNOWNS][LOCKIN_UNKNOWNS + 1];
};

/* Tones whose beat is longer than a thousand windows are one tone: together they have one amplitude. */
#define LOCKIN_EQUAL 1e-3

struct lockin_tone {
    double rate;           /* turns a tick */
    uint64_t phase;        /* in the middle of the window, turns * 2^64 */
    struct lockin_sum sum; /* this tone times the output, less a constant */
};

enum lockin_verdict {
    LOCKIN_TOLD,
    LOCKIN_SHORT, /* the window holds less than one period of the tone */
    LOCKIN_CLOSE  /* the tone is too near another one, or it has no more than two ticks a period */
};

/* True where the beat of two tones takes more than a thousand windows. */
bool lockin_equal(const struct lockin_window *w, const struct lockin_tone *a, const struct lockin_tone *b);

/* Takes mean and other tones out of the last of n. Returns the power of it that is left, 0 to weight / 2;
 * there *z is that of the tone if it is above 0. weight: g[0][0]. A row of zeros is no tone. */
double lockin_solve(struct lockin_normal *q, int n, double weight, struct lockin_sum *z);

/* Fits a finished window: n tones, 1 to LOCKIN_TONES, none equal to the last one. mean: sum w y of the
 * output, less the same constant. *z is that of the last tone: output ~ Re(z exp(i theta)); it is written
 * only where the window tells it. About 600 instructions for one tone, 2000 for two, 4500 for three. */
enum lockin_verdict lockin_fit(const struct lockin_window *w, const struct lockin_tone *tone, int n,
                               double mean, struct lockin_sum *z);

#endif
