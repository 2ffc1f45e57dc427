/* flows.h - the powers of models with a Hertzian contact, for one tick, for several and for several plants.
 *
 * hertz_rig_flow, hertz_rig_flow_forced, rolling_contact_flow and afm_tip_flow are `flow` of struct model.
 * Their copies with _lanes take numbers of several ticks, those with _beside numbers of several plants. */
#ifndef MODELS_FLOWS_H
#define MODELS_FLOWS_H

#include "models/afm_tip.h"
#include "models/hertz_rig.h"
#include "models/lanes.h"
#include "models/reduced/polynomial.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

#define real       double
#define number     double
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

ALWAYS_INLINE real_beside hertz_contact_force_beside(real_beside eta)
{
    real_beside e = real_positive_beside(eta);
    return e * sqrt_beside(e);
}

#define real       real_lanes
#define REAL(name) name##_lanes
#include "models/flows_text.h"
#include "models/reduced/polynomial_text.h"
#include "models/shaft_text.h"
#undef real
#undef number
#undef REAL

#define real       real_beside
#define number     real_beside
#define REAL(name) name##_beside
#include "models/afm_tip_text.h"
#include "models/flows_text.h"
#include "models/hertz_rig_text.h"
#include "models/rolling_contact_text.h"
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
#undef number

#endif
