/* choose_steps.h - the steps of the search, shared by the files of choose; see choose.h. */
#ifndef HOST_SIM_CHOOSE_STEPS_H
#define HOST_SIM_CHOOSE_STEPS_H

#include "host_sim/choose/choose.h"
#include "host_sim/scene/scene_check.h"

enum { CHOOSE_SUBSTEPS = 4096 /* in a frame, at most */ };

enum { OUTPUT_VELOCITY = 1, OUTPUT_PENETRATION = 2, OUTPUT_FORCE = 3 }; /* outputs of every model */

struct search {
    struct choose_certificate *c;
    struct choose_record truth;
    FILE *progress;
    double begin_s;
};

/* Tolerances of series where the model is judged, not the method. */
#define CHOOSE_TIGHT 1e-12
#define CHOOSE_LOOSE 1e-10

/* A measured error must leave this much room: others sample elsewhere. */
#define CHOOSE_ROOM 1.25

/* A neighbouring start, model units. */
#define CHOOSE_NUDGE 1e-9

#endif
