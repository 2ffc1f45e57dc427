/* tip_law.h - the force between the tip of a lever and a sample, inline for the model and its method.
 *
 * Van der Waals' attraction outside a0, the contact of Derjaguin, Muller and Toporov inside. The modes that a
 * lever leaves out are a spring before the tip. Newton's method finds its stretch. Model units. */
#ifndef MODELS_TIP_LAW_H
#define MODELS_TIP_LAW_H

#include <math.h>
#include "models/check.h"
#include "models/model.h"

enum { TIP_LAW_STEPS = 3 };
#define TIP_LAW_NEGLIGIBLE 1e-8 /* times a0; its square is a rounding */

/* The law on one branch of the adhesion, at one modulation of the contact. */
struct tip_side {
    double attraction; /* H R/6 */
    double adhesion;   /* at a0 and inside */
    double hertz;
};

/* Force on the tip in units of k_1, its slope over the gap and its potential, for a gap to the tip itself. */
struct tip_pull {
    double force, slope, energy;
};

/* The force at the tip for one gap. */
struct tip_force {
    double force;      /* without the drag; positive away from the sample */
    double drag;       /* the sample's damper: the force is `force` - drag * rate of the gap */
    double gap;        /* negative in contact, as the model's `gap` */
    double modulation; /* the part of the force that the modulation of the contact adds */
};

ALWAYS_INLINE struct tip_side tip_side_of(const struct tip_law *w, double stiffness, double branch)
{
    double pull = w->attraction * (1.0 + branch * w->out);
    return (struct tip_side){pull, pull / (w->a0 * w->a0), w->hertz * (1.0 + stiffness)};
}

ALWAYS_INLINE void tip_pull_at(const struct tip_law *w, const struct tip_side *s, double d,
                               struct tip_pull *l)
{
    double a0 = w->a0;
    if (d > a0) {
        double inverse = 1.0 / d, pull = s->attraction * inverse;
        l->force = -pull * inverse;
        l->slope = 2.0 * pull * inverse * inverse;
        l->energy = -pull;
        return;
    }
    double depth = a0 - d, root = sqrt(depth);
    l->force = s->hertz * (depth * root) - s->adhesion;
    l->slope = -1.5 * s->hertz * root;
    l->energy = 0.4 * s->hertz * (depth * depth * root) - s->adhesion * depth - s->attraction / a0;
}

/* The law for a gap that leaves out the spring of the other modes; the energy of that spring is added.
 * Returns the gap to the tip itself. */
ALWAYS_INLINE double tip_pull_behind(const struct tip_law *w, const struct tip_side *s, double gap,
                                     struct tip_pull *l)
{
    double d = gap, rest = w->rest;
    tip_pull_at(w, s, d, l);
    for (int i = 0; i < TIP_LAW_STEPS && rest > 0.0; i++) {
        double steep = 1.0 - rest * l->slope, left = gap + rest * l->force - d, step = 0.0;
        if (left != 0.0) /* outside, the first step most often meets the last bit: no division waits */
            step = left / (steep > 0.25 ? steep : 0.25);
        d += step;
        if (fabs(step) <= TIP_LAW_NEGLIGIBLE * w->a0) { /* the tangent is as good as the law */
            l->energy -= l->force * step;
            l->force += l->slope * step;
            break;
        }
        tip_pull_at(w, s, d, l);
    }
    l->energy += 0.5 * rest * l->force * l->force;
    return d;
}

ALWAYS_INLINE void tip_force_at(const struct tip_law *w, const struct tip_side *s, double gap,
                                struct tip_force *f)
{
    struct tip_pull l;
    double d = tip_pull_behind(w, s, gap, &l), depth = w->a0 - d;
    f->force = l.force;
    f->gap = d - w->a0;
    f->drag = f->modulation = 0.0;
    if (w->viscous > 0.0 && depth > 0.0) {
        double steep = 1.0 - w->rest * l.slope; /* the tip moves this much less than the rigid one */
        f->drag = w->viscous * sqrt(depth) / (steep * steep);
    }
}

/* The part of a force with modulation that the modulation adds. */
static inline double tip_modulation(const struct tip_law *w, double branch, double gap,
                                    const struct tip_force *f)
{
    struct tip_side s = tip_side_of(w, 0.0, branch);
    struct tip_pull still;
    if (!(f->gap < 0.0))
        return 0.0;
    (void)tip_pull_behind(w, &s, gap, &still);
    return f->force - still.force;
}

#endif
