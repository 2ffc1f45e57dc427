/* afm_shift.c - where a fast modulation of the contact stiffness moves the contact resonance of a lever with
 * real modes and adhesion: docs/img/afm_shift.csv.
 *
 * Kirrou & Belhaq 2013 modulate the contact of a point mass. Here their lever has one mode or four, with
 * adhesion and without (tests/fixture/afm/pressed.h).
 *
 *   sweep      frequency: fast_over_f0 changes at a modulation of 0.5; depth: the modulation changes at 30 f0
 *   shift      of the frequency, relative to the one without modulation
 *   grows      1: the motion under the modulation is none of its period; a parametric resonance, or chaos */
#include <math.h>
#include <stdio.h>
#include "tests/fixture/afm/pressed.h"

enum { LEVERS = 4, DEPTHS = 16 };
static const double lowest = 13.0, highest = 60.0;

static const struct {
    const char *name;
    int modes;
    double hamaker, guess; /* guess: contact resonance over f0 */
} lever_of[LEVERS] = {
    {"point mass", 1, 0.0, 5.541},
    {"point mass and adhesion", 1, 6.4e-20, 5.541},
    {"four modes", 4, 0.0, 3.702},
    {"four modes and adhesion", 4, 6.4e-20, 3.702},
};

static struct lever lever;

static double frequency(int which, double fast, double modulation)
{
    return pressed_frequency(&lever, lever_of[which].modes, lever_of[which].hamaker, fast, modulation,
                             lever_of[which].guess);
}

static void print(const char *sweep, int which, double fast, double modulation, double still)
{
    double f = frequency(which, fast, modulation);
    printf("%s,%s,%.4g,%.4g,", sweep, lever_of[which].name, fast, modulation);
    if (isnan(f))
        printf("NaN,NaN,1\n");
    else
        printf("%.7g,%.4g,0\n", f, f / still - 1.0);
}

static double next_fast(double fast)
{
    return fast + (fast < 46.0 ? 0.2 : 0.5);
}

int main(void)
{
    printf("sweep,lever,fast_over_f0,modulation,f_over_f0,shift,grows\n");
    for (int k = 0; k < LEVERS; k++) {
        double still = frequency(k, 30.0, 0.0);
        for (double fast = lowest; fast <= highest; fast = next_fast(fast))
            print("frequency", k, fast, 0.5, still);
        for (int i = 0; i <= DEPTHS; i++)
            print("depth", k, 30.0, i / (double)DEPTHS, still);
    }
    return 0;
}
