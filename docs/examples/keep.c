/* keep.c - keeps contact: presses on a shaken rig until the contact does not open any more. keep.test
 * judges it.
 *
 *   cc keep.c $(pkg-config --cflags --libs contactplant) -lm -o keep && contactplant test keep.test
 *
 * It wants the smallest penetration at half of the static one. A sample a millisecond meets a wave of 225
 * Hz somewhere, so it takes the smallest one from the mean and the deviation of 20 ms: mean - sqrt(2)
 * deviation of a sine. The smallest of 50 samples in its place jumps from wave to wave, and with it the
 * force swings for ever.
 *
 * In lockstep a sample acts in the next frame. In real time it gets 8 frames of lead: so late may a busy PC
 * be with plant and controller together. A loop as slow as this one bears that. */
#include "word.h"
#include <math.h>

static const double rest_m = 7.08e-6, preload_N = 64.0; /* the rig's static penetration and load */
static const double memory_s = 0.02;
static const unsigned long lead = 8;                        /* frames, in real time */
static const double press_per_s = 2.3, release_per_s = 0.5; /* near a resonance let go slowly */

int main(int argc, char **argv)
{
    struct contactplant_client *me = word_begin(argc, argv);
    struct contactplant_latest now;
    double mean_m = rest_m, square_m2 = 0.0, force_N = 0.0, frame_s = 1.0 / word_rate_Hz;
    while (word_next(me, &now)) {
        unsigned long next = now.contact_tick / word_substeps;
        double x = now.penetration_m, share = frame_s / memory_s;
        mean_m += share * (x - mean_m);
        square_m2 += share * ((x - mean_m) * (x - mean_m) - square_m2);
        double error_N = preload_N * (0.5 - (mean_m - sqrt(2.0 * square_m2)) / rest_m);
        force_N += (error_N > 0.0 ? press_per_s : release_per_s) * error_N * frame_s;
        force_N = fmax(0.0, fmin(force_N, preload_N)); /* pushes, never pulls */
        if (!word_behind)
            contactplant_client_stream(me, 0, word_realtime ? next + lead : next, force_N);
    }
    return 1; /* the bench ends a controller; a session that ends by itself is trouble */
}
