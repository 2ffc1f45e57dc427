/* afm_height.c - a z loop of a microscope over the bus: amplitude in, z out, a value a bus frame.
 *
 *   cc afm_height.c $(pkg-config --cflags --libs contactplant) -lm -o afm_height && contactplant test
 * afm_height.test
 *
 * The lever swings at its true rate in the plant; its tone and lock-in are the plant's. Slot 0 of the lock-in
 * says the mean amplitude of each frame. An integrator makes z of it, which the plant leads there in a
 * straight line over the next frame. From amplitude to z that is a delay of one frame. */
#define WORD_PLANT "model = microscope"
#include "word.h"

enum { INPUT_Z = 1 };

static const double set_m = 14e-9, ki_per_s = 275.0; /* 1/(2 tau) of the lever, tau = 2 Q/w0 = 1.82 ms */
static const double lowest_m = -0.3e-6, highest_m = 0.3e-6;

int main(int argc, char **argv)
{
    struct contactplant_client *me = word_begin(argc, argv);
    struct contactplant_latest now;
    double z_m = 0.0, frame_s = 1.0 / word_rate_Hz;
    while (word_next(me, &now)) {
        double error_m = now.lockin[0] - set_m; /* how much the tip is too far away */
        if (!isnan(error_m))
            z_m = fmax(lowest_m, fmin(z_m - ki_per_s * error_m * frame_s, highest_m));
        contactplant_client_stream(me, INPUT_Z, now.contact_tick / word_substeps, z_m);
    }
    return 1; /* the bench ends a controller; a session that ends by itself is trouble */
}
