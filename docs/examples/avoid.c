/* avoid.c - sweeps down towards a resonance and keeps out of its jump. avoid.test judges it.
 *
 *   cc avoid.c $(pkg-config --cflags --libs contactplant) -lm -o avoid && contactplant test avoid.test
 *
 * A Hertzian contact softens, so that a sweep downwards rides on an ever larger motion until the contact
 * opens. contactplant sweep finds that jump. This sweep goes on only while the smallest penetration is
 * above half of the static one; below, it turns back. */
#include "word.h"
#include <math.h>

static const double begin_Hz = 270.0, amplitude_N = 2.5, rest_m = 7.08e-6;
static const double memory_s = 0.05, step_Hz = 0.25; /* each memory_s: slow beside the resonance's 0.07 s */

int main(int argc, char **argv)
{
    struct contactplant_client *me = word_begin(argc, argv);
    struct contactplant_latest now;
    double frequency_Hz = begin_Hz, mean_m = rest_m, square_m2 = 0.0, share = 1.0 / (memory_s * word_rate_Hz);
    unsigned long n = 0, every = (unsigned long)(memory_s * word_rate_Hz);
    while (word_next(me, &now)) {
        double x = now.penetration_m;
        mean_m += share * (x - mean_m);
        square_m2 += share * ((x - mean_m) * (x - mean_m) - square_m2);
        if (n++ % every)
            continue;
        double smallest_m = mean_m - sqrt(2.0 * square_m2);
        frequency_Hz += smallest_m > 0.5 * rest_m ? -step_Hz : 2.0 * step_Hz;
        contactplant_client_arm(me, 0, amplitude_N, frequency_Hz, 0.0, memory_s);
        contactplant_client_fire(me, 1, now.contact_tick + 2 * word_substeps, 0.0);
    }
    return 1;
}
