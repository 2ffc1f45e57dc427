/* choose_truth.h - the reference runs that candidates are compared with. */
#ifndef HOST_SIM_CHOOSE_TRUTH_H
#define HOST_SIM_CHOOSE_TRUTH_H

#include "host_sim/choose/choose_steps.h"

/* The first number of substeps from n on that the scene may have; 0 and the reason when there is none. */
int choose_allow(struct scene *s, double n, char why[SCENE_CHECK_REASON]);

/* Makes the method exact or, without that, series of this tolerance; exact with `finer` times as many
 * steps. A lever takes fine steps of modal. False: why. */
bool choose_tighten(struct scene *s, double tol, double finer, char why[SCENE_CHECK_REASON]);

/* The truth, its own error, and whether trajectories can be compared at all. NULL, or why there is none. */
const char *choose_truth(struct search *o, bool *escaped);

/* The error of a run by the measure of the certificate; does it keep the tolerance, with room to spare? */
double choose_error(const struct search *o, const struct choose_record *r);
bool choose_meets(const struct search *o, double error);

/* The truth's own error and rounding: differences below mean nothing. */
double choose_resolution(const struct choose_certificate *c);

#endif
