/* sweep_tell.h - the summary of a sweep from its rows: its jumps, its largest amplitude, and what did not
 * settle. */
#ifndef HOST_SIM_SWEEP_TELL_H
#define HOST_SIM_SWEEP_TELL_H

#include "host_sim/maps/sweep/sweep.h"

/* A row that is the far side of a jump's bracket: the row before it is the near one. */
bool sweep_is_jump(const struct sweep_result *row, int i);

/* "up"; with a family "amplitude of force 4.54545 N, up". */
const char *sweep_chain_name(const struct sweep *s, int chain, char text[SWEEP_LABEL]);

/* "amplitude of penetration, harmonic 1/2", of harmonic i. */
void sweep_name_harmonic(const struct sweep *s, int i, char name[SWEEP_LABEL]);

/* "over 20 periods", "until the damping leaves 1e-4". */
void sweep_say_settled(const struct sweep *s, char text[SWEEP_LABEL]);

/* How many points did not settle. */
int sweep_unsettled(const struct rows_table *t, const struct sweep_result *row);

/* Jumps and where, the largest amplitude, and what did not settle; see maps_finding. */
void sweep_tell(void *context, const struct rows_table *t, FILE *f);

#endif
