/* choose_draw.c - see choose_draw.h. */
#include "tests/choose/choose_draw.h"

#include <math.h>
#include <stdint.h>

#include "host_sim/choose/choose.h"
#include "host_sim/choose/choose_ladder.h"
#include "host_sim/scene/scene_check.h"
#include "models/afm_tip.h"
#include "models/math/elementary.h"
#include "models/hertz_rig.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"
#include "tests/fixture/draw.h"

/* Compression by linear theory, over the static one or the gap: from what sensors still see to bouncing.
 * Attracting tips, of which the larger ones would escape, a tenth of it. */
static const double least = 1e-3, most = 3.0, attracted = 0.1;

static double kick = 0.5; /* at most, of the static compression */

/* A rig of its own size, some with a fast drive, some kicked. */
static void random_rig(struct scene *s)
{
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct harmonic none[MODEL_INPUTS];
    struct scale scale;
    scenes_default(s, &hertz_rig);
    s->value[RIG_MASS] = spread(1.0, 40.0);
    s->value[RIG_PRELOAD] = spread(10.0, 400.0);
    scenes_resolve(s, si, none);
    hertz_rig.prepare(si, p, &scale);
    double Hz = 1.0 / (2.0 * ELEMENTARY_PI * scale.time_s);
    s->value[RIG_DAMPING] = 2.0 * spread(0.005, 0.1) * s->value[RIG_MASS] / scale.time_s;
    s->drive[RIG_FORCE] = (struct scene_drive){.amplitude = spread(1e-3, 0.5) * scale.force_N,
                                               .frequency_Hz = uniform(0.2, 1.6) * Hz,
                                               .phase_rad = uniform(0.0, 6.0)};
    double W = uniform(5.0, 12.0);
    if (chance(0.2))
        s->drive[RIG_FAST_FORCE] =
            (struct scene_drive){.amplitude = spread(0.01, 20.0) * scale.force_N, .frequency_Hz = W * Hz};
    else if (chance(0.2))
        s->drive[RIG_STIFFNESS] =
            (struct scene_drive){.amplitude = spread(1e-3, 2.0), .frequency_Hz = W * Hz};
    if (chance(0.3)) {
        s->started = true;
        s->start[0] = (1.0 + uniform(-kick, kick)) * scale.length_m;
    }
    s->over = uniform(30.0, 100.0) / Hz;
    s->frame_s = 0.2 / Hz;
}

static void random_rolling(struct scene *s)
{
    scenes_default(s, &rolling_contact);
    s->paper = true;
    s->value[ROLLING_PAPER_ZETA] = spread(0.005, 0.1);
    s->value[ROLLING_PAPER_XI0] = spread(1e-3, 1.0);
    s->value[ROLLING_PAPER_OMEGA] = uniform(0.3, 1.7);
    s->value[ROLLING_PAPER_PHI] = 0.0;
    s->over = uniform(150.0, 500.0);
    s->dilation = 1e-3;
}

static void random_tip(struct scene *s)
{
    bool attracts = chance(0.3);
    scenes_default(s, &afm_tip);
    s->paper = true;
    s->value[TIP_PAPER_BETA] = attracts ? uniform(0.2, 0.8) : spread(0.2, 5.0);
    s->value[TIP_PAPER_C] = spread(0.01, 0.1);
    s->value[TIP_PAPER_R] = chance(0.5) ? 0.0 : spread(1e-3, 0.5);
    s->value[TIP_PAPER_FAST_OMEGA] = uniform(6.0, 12.0);
    s->value[TIP_PAPER_F] = attracts ? spread(1e-4, 0.005) : spread(1e-3, 0.5);
    s->value[TIP_PAPER_OMEGA] = uniform(0.2, 1.8);
    s->value[TIP_PAPER_PHI] = 0.0;
    s->value[TIP_PAPER_SIGN] = attracts ? 1.0 : -1.0;
    s->over = uniform(150.0, 400.0);
    s->dilation = 1e-3;
}

static void random_shaft(struct scene *s)
{
    static const double gap_stiffness[3] = {2.626e4, 1.4e6, 3.502e7};
    scenes_default(s, &shaft_bearing);
    s->value[SHAFT_KG1] = s->value[SHAFT_KG3] = gap_stiffness[(int)uniform(0.0, 2.999)];
    double c = spread(4.0, 100.0);
    s->value[SHAFT_C1] = s->value[SHAFT_C2] = s->value[SHAFT_C3] = c;
    s->drive[chance(0.8) ? 1 : 0] =
        (struct scene_drive){.amplitude = spread(0.5, 15.0), .frequency_Hz = uniform(8.0, 120.0)};
    s->over = uniform(0.3, 0.8);
}

/* The slow drive by what it makes of the compression: linear theory is proportional. */
static void scale_motion(struct scene *s, double size)
{
    struct choose_candidate candidate[CHOOSE_CANDIDATES];
    struct choose_facts f;
    choose_facts_of(candidate, choose_ladder(s, candidate), NULL, &f);
    double factor = size / (f.amplitude - f.fast_amplitude);
    if (s->model == &rolling_contact)
        s->value[ROLLING_PAPER_XI0] *= factor;
    else if (s->model == &afm_tip)
        s->value[TIP_PAPER_F] *= s->value[TIP_PAPER_SIGN] > 0.0 ? attracted * factor : factor;
    else if (s->model == &hertz_rig)
        s->drive[RIG_FORCE].amplitude *= factor;
    for (int i = 0; i < SHAFT_INPUTS && s->model == &shaft_bearing; i++)
        s->drive[i].amplitude *= factor;
}

void choose_draw_seed(uint64_t seed)
{
    state = seed;
}

/* The families by turns, rolling contacts among the rigs. */
static void by_motion(struct scene *s)
{
    static void (*const make[3])(struct scene *) = {random_rig, random_tip, random_shaft};
    double size = spread(least, most);
    int family = (int)uniform(0.0, 2.999);
    kick = fmin(size, 1.0);
    if (family == 0 && chance(1.0 / 3.0))
        random_rolling(s);
    else
        make[family](s);
    scale_motion(s, size);
}

static void by_force(struct scene *s)
{
    static void (*const make[])(struct scene *) = {random_rig, random_rig, random_rolling, random_tip,
                                                   random_shaft};
    make[(int)uniform(0.0, 4.999)](s);
}

void choose_draw(enum choose_draw draw, struct scene *s)
{
    char why[SCENE_CHECK_REASON];
    do {
        (draw == DRAW_BY_FORCE ? by_force : by_motion)(s);
        s->observable = (int)uniform(0.0, 3.999);
        s->tolerance = draw == DRAW_BY_FORCE ? spread(3e-4, 0.05) : spread(1e-4, 0.1);
        s->cost_s = 0.0;
    } while (scene_check(s, why));
}
