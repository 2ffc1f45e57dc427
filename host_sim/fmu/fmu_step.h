/* fmu_step.h - a step in event mode: it sees touchdowns, and may end at the first one. */
#ifndef HOST_SIM_FMU_STEP_H
#define HOST_SIM_FMU_STEP_H

#include <stdbool.h>
#include "host_sim/library/library.h"

struct fmu_step {
    double to_s;      /* plant time at its end, set by the caller */
    double reached_s; /* the located touchdown, or to_s */
    bool touched;     /* a contact has closed */
};

/* Runs the plant to s->to_s. With memory for a copy of the plant in `begin` it ends at the first touchdown:
 * the plant stands at the first 1/65536 of a tick behind it. A code of contactplant_advance_to. */
int fmu_step(struct contactplant *p, struct contactplant *begin, struct fmu_step *s);

#endif
