/* choose_warn.c - where a source paper leaves its own range in the motion that is asked for. */
#include "host_sim/choose/choose.h"
#include "models/math/elementary.h"

int choose_warnings(const struct choose_certificate *c, const char **warning)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    const char *text;
    int n = 0;
    scenes_resolve(&c->scene, si, drive);
    for (int hold = 0; hold < c->sweep.steps || hold == 0; hold++) {
        if (c->sweep.steps > 0)
            drive[c->sweep.input].omega = 2.0 * ELEMENTARY_PI * choose_sweep_Hz(&c->sweep, hold);
        for (int i = 0; (text = scenes_warning(c->scene.model, si, drive, i)) != NULL; i++) {
            int k = 0;
            while (k < n && warning[k] != text)
                k++;
            if (k == n && n < CHOOSE_WARNINGS)
                warning[n++] = text;
        }
    }
    return n;
}
