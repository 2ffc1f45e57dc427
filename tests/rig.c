/* rig.c - see rig.h. */
#include "tests/rig.h"

#include <string.h>
#include "models/hertz_rig.h"
#include "tests/test.h"

#define TWO_PI 6.283185307179586477

void rig_paper(double paper[PAPER])
{
    for (int i = 0; i < PAPER; i++)
        paper[i] = hertz_rig.paper[i].initial;
}

void rig_start(struct plant *pl, const double paper[PAPER], double h, double q, double q_dot)
{
    double si[MODEL_PARAMETERS];
    struct harmonic drive[MODEL_INPUTS];
    hertz_rig.from_paper(paper, si, drive);
    struct plant_config c = {.model = &hertz_rig, .si = si, .method = &rk4, .tick_s = h, .dilation = 1.0};
    const char *why = plant_init(pl, &c);
    if (why)
        check_string("plant_init", why, "no refusal");
    plant_set_state(pl, (double[]){1.0 + (2.0 / 3.0) * q, (2.0 / 3.0) * q_dot});
    for (int i = 0; i < MODEL_INPUTS; i++) {
        if (drive[i].amplitude != 0.0)
            plant_drive_start(pl, i, drive[i].amplitude, drive[i].omega / TWO_PI, drive[i].phase);
    }
}

double rig_q(const struct plant *pl)
{
    return 1.5 * pl->x[0] - 1.5;
}

double rig_q_dot(const struct plant *pl)
{
    return 1.5 * pl->x[1];
}

void rig_run(struct plant *pl, uint64_t ticks)
{
    if (!plant_run(pl, ticks))
        check_true("the plant stays finite", 0);
}
