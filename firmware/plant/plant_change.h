/* plant_change.h - a plant's set-up, changes of parameters while it runs, and the climb to the full model. */
#ifndef FIRMWARE_PLANT_CHANGE_H
#define FIRMWARE_PLANT_CHANGE_H

#include "firmware/plant/plant.h"

/* Sets up *pl: tick 0, the model at rest, drives silent. Returns NULL, or a constant text with the reason
 * for a refusal; then *pl must not be used. It refuses tick_s outside 1e-12..1e6 s, dilation outside
 * 1e-6..1e9, missing scratch memory, parameters outside their ranges, and (unless `force`) a step that the
 * method cannot take. Cost: the method's preparation of its tables. */
MUST_CHECK const char *plant_init(struct plant *pl, const struct plant_config *c);

/* Checks si[n_parameters] against their ranges and each other: NULL, or a reason. *which is the index of
 * the parameter outside its range, or -1 when all are inside. A NaN is outside. */
MUST_CHECK const char *plant_check(const struct model *m, const double *si, int *which);

/* Would plant_change take these SI parameters? NULL, or the reason. Changes nothing. */
MUST_CHECK const char *plant_accepts(const struct plant *pl, const double *si);

/* Takes new SI parameters now. State, drives, events and counts go on with their SI values; the regime
 * follows from the gaps. The change of stored energy is booked as work of the change (ledger.h). Returns
 * NULL, or the reason for a refusal that changed nothing. Cost: the method's tables anew, as in
 * plant_init. */
MUST_CHECK const char *plant_change(struct plant *pl, const double *si);

/* Would plant_promote go to model `to` from these SI parameters? NULL, or the reason. Changes nothing. */
MUST_CHECK const char *plant_could_climb(const struct plant *pl, const struct model *to, const double *si);

/* Climbs from a reduced model to the full model that it approximates, now. Reduced and full model have
 * equal units: position and velocity go on to the last bit. So do drives with their phase, SI parameters,
 * tick and counts. The regime follows from the gaps, the method prepares itself for the new model, and the
 * difference in stored energy is booked as plant_change books it. The scratch memory must be large enough
 * for both models. Returns NULL, or the reason for a refusal that changed nothing. Costs what plant_change
 * costs. */
MUST_CHECK const char *plant_promote(struct plant *pl, const struct model *to);

#endif
