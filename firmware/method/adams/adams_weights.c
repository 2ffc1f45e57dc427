/* adams_weights.c - the weights of `adams`, which a wave sets.
 *
 * The predictor and the extrapolation are exact for 1, s, s^2, cos(z s) and sin(z s), with s in ticks, where
 * a wave turns by z in a tick. The corrector is so for s^3, too. That is mixed interpolation (De Meyer,
 * Vanthournout, Vanden Berghe, J. Comput. Appl. Math. 30, 1990). So an input that stands in g may have few
 * ticks a period. They follow from weights w of polynomials up to the degree 4. A multiple of the third
 * difference of the nodes 0 to -3, and one of that of -1 to -4, leaves 1, s and s^2 exact:
 *
 *     a + b exp(-i z) = (I - w(e))/d(e),   e(s) = exp(i z s), d(e) = (1 - exp(-i z))^3
 *
 * where I is what the weights are to give for e. For the extrapolation to 1 that is a = -4 sin^2(z/2), b = 0.
 * The corrector adds a multiple of what g is beside its extrapolation: (a + b) over the a of that. */
#include "firmware/method/adams/adams_weights.h"

#include "firmware/method/adams/adams_wave.h"

/* Weights of equal steps, in units of h^2 for the place and of h for the rate: the integrals of 1 - s and of
 * 1 over 0 <= s <= 1 times the quartics that are 1 at one of 0, -1, .. -4 and 0 at the others. The
 * corrector's quintic is that quartic and a multiple of the quintic that is 0 at these and 1 at 1. */
static const double predict[ADAMS_NODES][2] = {{1427.0 / 1440.0, 1901.0 / 720.0},
                                               {-1596.0 / 1440.0, -2774.0 / 720.0},
                                               {1446.0 / 1440.0, 2616.0 / 720.0},
                                               {-692.0 / 1440.0, -1274.0 / 720.0},
                                               {135.0 / 1440.0, 251.0 / 720.0}};
static const double correct[2] = {863.0 / 10080.0, 475.0 / 1440.0};
static const double third[4] = {1.0, -3.0, 3.0, -1.0};

/* The quartic's weights of place or rate on e. */
static struct complex of_wave(struct complex e, int which)
{
    struct complex sum = {0.0, 0.0};
    for (int j = ADAMS_NODES - 1; j >= 0; j--)
        sum = (struct complex){predict[j][which] + (sum.re * e.re + sum.im * e.im),
                               sum.im * e.re - sum.re * e.im};
    return sum;
}

/* a and b for the weights of place or rate, which are to make `whole` of e. */
static void fit(struct complex e, struct complex whole, int which, double weight[ADAMS_NODES], double *both)
{
    struct complex w = of_wave(e, which), lack = {whole.re - w.re, whole.im - w.im};
    /* 1/(1 - exp(-i z)) = (1 - i cot(z/2))/2 */
    double cot = e.im / (1.0 - e.re);
    for (int k = 0; k < 3; k++)
        lack = (struct complex){0.5 * (lack.re + cot * lack.im), 0.5 * (lack.im - cot * lack.re)};
    double b = -lack.im / e.im, a = lack.re - b * e.re;
    for (int j = 0; j < ADAMS_NODES; j++)
        weight[j] += ((j < 4 ? a * third[j] : 0.0) + (j > 0 ? b * third[j - 1] : 0.0));
    *both = a + b;
}

bool adams_weigh(struct adams *s, double angle)
{
    const bool fits = angle >= ADAMS_FIT_LEAST && angle <= ADAMS_FIT_MOST;
    const double unit[2] = {s->h * s->h, s->h};
    struct complex e, m[3], whole[2];
    double a = 0.0, both;
    angle = fits ? angle : 0.0;
    if (angle == s->angle)
        return false;
    s->angle = angle;
    adams_moments(s, angle, &e, m);
    whole[ADAMS_PLACE] = (struct complex){m[0].re - m[1].re, m[0].im - m[1].im};
    whole[ADAMS_RATE] = m[0];
    if (fits)
        a = -2.0 * (1.0 - e.re);
    s->ahead[0] = 5.0 + a;
    s->ahead[1] = 10.0 + 3.0 * a;
    for (int i = 0; i < 2; i++) {
        double weight[ADAMS_NODES], corrected = correct[i];
        for (int j = 0; j < ADAMS_NODES; j++)
            weight[j] = predict[j][i];
        if (fits) {
            fit(e, whole[i], i, weight, &both);
            corrected = both / a;
        }
        for (int j = 0; j < ADAMS_NODES; j++)
            s->predict[j][i] = unit[i] * weight[j];
        s->correct[i] = unit[i] * corrected;
    }
    /* That of the newest brings along its share in the tick before. So place and rate at the end of a tick do
     * not stand between one g and the next. */
    s->predict[0] += s->correct + (adams_pair){s->h * s->correct[ADAMS_RATE], 0.0};
    return true;
}
