/* detune.c - moves a resonance away from a disturbance: a slow loop sets a fast motion of the base.
 * detune.test judges it.
 *
 *   cc detune.c $(pkg-config --cflags --libs contactplant) -lm -o detune && contactplant test detune.test
 *
 * A fast excitation changes how stiff a contact is to slow motion (Bichri et al. 2011). Under 0.5 N at 231
 * Hz the mass moves by 1.53 um. A fast force of 300 N leaves it at 1.52 um. A stiffness that swings by 90
 * % makes it 1.71 um, and a base that moves by 4 um makes it 0.62 um. Only the base moves this resonance
 * away. */
#include "word.h"
#include <math.h>

enum { BASE = 2 };
static const double fast_Hz = 1840.0, wanted_m = 0.75e-6, most_m = 4.5e-6;
static const double memory_s = 0.2, gain = 0.5; /* base amplitude per excess of the motion, each memory_s */

int main(int argc, char **argv)
{
    struct contactplant_client *me = word_begin(argc, argv);
    struct contactplant_latest now;
    double sum_m = 0.0, square_m2 = 0.0, base_m = 0.0;
    unsigned long n = 0, every = (unsigned long)(memory_s * word_rate_Hz);
    while (word_next(me, &now)) {
        sum_m += now.displacement_m;
        square_m2 += now.displacement_m * now.displacement_m;
        if (++n % every)
            continue;
        double mean_m = sum_m / (double)every;
        double amplitude_m = sqrt(2.0 * fmax(0.0, square_m2 / (double)every - mean_m * mean_m));
        base_m = fmax(0.0, fmin(base_m + gain * (amplitude_m - wanted_m), most_m));
        contactplant_client_arm(me, BASE, base_m, fast_Hz, 0.0, 0.1);
        contactplant_client_fire(me, 1 << BASE, now.contact_tick + 2 * word_substeps, 0.0);
        sum_m = square_m2 = 0.0;
    }
    return 1;
}
