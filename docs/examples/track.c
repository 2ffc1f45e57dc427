/* track.c - follows the contact's resonance: a phase-locked loop holds the motion 90 degrees behind the
 * drive. track.test judges it.
 *
 *   cc track.c $(pkg-config --cflags --libs contactplant) -lm -o track && contactplant test track.test
 *
 * It knows the phase of its drive at every tick. So it takes the phase of the motion by a sum over the
 * samples of 0.1 s, and each time moves the frequency towards a quarter of a turn of lag. Preload and
 * stiffness may drift. */
#include "word.h"
#include <math.h>

static const double turn = 6.283185307179586, begin_Hz = 215.0, amplitude_N = 0.1;
static const unsigned long lead = 12; /* frames from a decision to its instant */
static const double gain_Hz = 1.2,
                    memory_s = 0.1; /* per radian of phase; the resonance itself takes 0.07 s to follow */

int main(int argc, char **argv)
{
    struct contactplant_client *me = word_begin(argc, argv);
    struct contactplant_latest now;
    double frequency_Hz = begin_Hz, old_Hz = begin_Hz, fired_turns = 0.0, c = 0.0, s = 0.0, mean_m = 7.08e-6;
    unsigned long fired_tick = 0, n = 0, every = (unsigned long)(memory_s * word_rate_Hz);
    double tick_s = 1.0 / word_rate_Hz / (double)word_substeps;
    while (word_next(me, &now)) {
        unsigned long tick = (unsigned long)now.contact_tick;
        double now_Hz = tick < fired_tick ? old_Hz : frequency_Hz;
        double turns = fired_turns + now_Hz * ((double)tick - (double)fired_tick) * tick_s;
        mean_m += (now.displacement_m - mean_m) / (double)every;
        c += (now.displacement_m - mean_m) * cos(turn * turns);
        s += (now.displacement_m - mean_m) * sin(turn * turns);
        if (++n % every == 0) {
            double lag = atan2(s, c); /* behind the drive, radians */
            old_Hz = frequency_Hz;
            if (fired_tick)
                frequency_Hz += gain_Hz * (turn / 4.0 - lag);
            frequency_Hz = fmax(100.0, fmin(frequency_Hz, 400.0));
            unsigned long at = tick + lead * word_substeps;
            fired_turns = fired_tick ? fmod(turns + old_Hz * (double)(at - tick) * tick_s, 1.0) : 0.0;
            fired_tick = at;
            c = s = 0.0;
        }
        if (fired_tick && n % every % 2 == 0 && n % every <= 6) { /* four times: a link may lose some */
            contactplant_client_arm(me, 0, amplitude_N, frequency_Hz, 0.0, 0.0);
            contactplant_client_fire(me, 1, fired_tick, 0.0);
        }
    }
    return 1;
}
