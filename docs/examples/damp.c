/* damp.c - damps a resonance by velocity feedback, and shows what a delay of one frame does. damp.test
 * judges it.
 *
 *   cc damp.c $(pkg-config --cflags --libs contactplant) -lm -o damp && contactplant test damp.test
 *
 * The force -g v takes power out of the motion only while it is in phase with the velocity v. It acts from
 * one frame after the sample on, and holds for a frame: late by 1.5 frames on average. At 1 kHz and 225 Hz
 * these are 122 degrees, so that it drives the motion. At 4 kHz they are 30 degrees, and it damps. */
#include "word.h"

static const double gain_N_s_per_m = 800.0, limit_N = 30.0;
enum { FAST_FORCE = 1 };

int main(int argc, char **argv)
{
    struct contactplant_client *me = word_begin(argc, argv);
    struct contactplant_latest now;
    double force_N = 0.0;
    while (word_next(me, &now)) {
        contactplant_client_stream(me, FAST_FORCE, now.contact_tick / word_substeps, force_N);
        force_N = -gain_N_s_per_m * now.velocity_m_per_s; /* for the next frame: computing takes this one */
        force_N = force_N > limit_N ? limit_N : force_N < -limit_N ? -limit_N : force_N;
    }
    return 1;
}
