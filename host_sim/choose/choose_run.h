/* choose_run.h - runs of a scene and their differences. */
#ifndef HOST_SIM_CHOOSE_RUN_H
#define HOST_SIM_CHOOSE_RUN_H

#include "host_sim/choose/choose.h"

/* Frames in the time asked. */
double choose_frames(const struct scene *s);

/* Runs a scene from its start, the first state moved by `nudge` model units. NULL, or why it cannot be
 * run; then as after any run choose_record_free. */
const char *choose_run(const struct scene *s, const struct choose_sweep *w, double nudge,
                       struct choose_record *r);
/* A run from its start that ends early (is_apart) where it parts from the run beside it. */
const char *choose_run_beside(const struct scene *s, const struct choose_sweep *w,
                              const struct choose_beside *beside, struct choose_record *r);
void choose_record_free(struct choose_record *r);

/* Peak-to-peak value plus 1e-6 of `unit`. */
double choose_span(const struct choose_record *r, double unit);

/* Largest difference over `span`; infinite when one of them did not go to the end. */
double choose_difference(const struct choose_record *a, const struct choose_record *b, double span);

/* The factor by which the largest difference so far grows in a spell: the worst spell of the second half
 * of the time, at least 1. Differences below `least`, over `span`, mean nothing. */
double choose_growth(const struct choose_record *a, const struct choose_record *b, double span, double least);

/* The statistics over `span` (the share of time as it is). */
void choose_statistics(const struct choose_record *r, double span, double statistic[STATISTICS]);

#endif
