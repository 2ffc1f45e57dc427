/* stability.h - maps over two numbers of a scene: where the plant is stable, and where a method with its
 * step is.
 *
 * A floquet map has the larger Floquet |multiplier| of the contact at rest under a modulated stiffness, of
 * the plant and of the method with the scene's step (stability_floquet.h). A contact map runs the scene
 * from its start by the method with its step, without the step guard. It counts the energy that is made or
 * lost, and the contact switches that are missed or made up. The reference is the method that auto takes,
 * at 1e-11 and with at most a fifth of a radian a step.
 *
 * The cells of one value of y are a job of jobs.h. Each cell of a contact map is a piece of its job. */
#ifndef HOST_SIM_STABILITY_H
#define HOST_SIM_STABILITY_H

#include "host_sim/maps/maps.h"

/* A cell is stable up to this |multiplier|, and keeps its energy within this share. */
#define STABILITY_UNIT   (1.0 + 1e-9)
#define STABILITY_ENERGY 0.05

enum stability_map { STABILITY_FLOQUET, STABILITY_CONTACT };

struct stability {
    struct maps m; /* with --step: a frame is one step, without dilation */
    enum stability_map map;
    struct scene_range x, y;
    int periods; /* periods of the contact in a contact map */
};

/* A cell is an array of doubles: y, x and then these. */
enum { FLOQUET_RATIO = 2, FLOQUET_STEPS, FLOQUET_PLANT, FLOQUET_METHOD, FLOQUET_COLUMNS };
enum {
    CONTACT_STEP = 2, /* times the contact's eigenfrequency */
    CONTACT_SWITCHES,
    CONTACT_OF_METHOD,
    CONTACT_ENERGY, /* highest stored energy of the second half over the plant's; infinite: it escaped */
    CONTACT_COLUMNS
};

extern const struct usage stability_usage;

#endif
