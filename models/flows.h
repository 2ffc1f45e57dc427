/* flows.h - the powers of models with a Hertzian contact, for one tick and for TICK_LANES ticks side by side.
 *
 * hertz_rig_flow, hertz_rig_flow_forced, rolling_contact_flow and afm_tip_flow are `flow` of struct model;
 * their copies with _lanes take numbers of several ticks. */
#ifndef MODELS_FLOWS_H
#define MODELS_FLOWS_H

#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/lanes.h"
#include "models/reduced/polynomial.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

#define real       double
#define REAL(name) name
#include "models/flows_text.h"
#undef real
#undef REAL

#if TICK_LANES > 1
ALWAYS_INLINE real_lanes hertz_contact_force_lanes(real_lanes eta)
{
    real_lanes e = real_positive_lanes(eta);
    return e * sqrt_lanes(e);
}

#define real       real_lanes
#define REAL(name) name##_lanes
#include "models/flows_text.h"
#include "models/reduced/polynomial_text.h"
#include "models/shaft_text.h"
#undef real
#undef REAL

/* The shapes of polynomial.h. */
#define FLOWS_OF_SHAPE(name, ...)                                                                            \
    ALWAYS_INLINE void polynomial_flow_##name##_lanes(const double *p, const struct input_lanes *u,          \
                                                      const real_lanes *x, struct flow_lanes *f)             \
    {                                                                                                        \
        polynomial_flow_lanes((struct polynomial_shape){__VA_ARGS__}, p, u, x, f);                           \
    }
POLYNOMIAL_SHAPES(FLOWS_OF_SHAPE)
#endif

#endif
