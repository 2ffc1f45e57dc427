/* parameters.h - parameters of the model and settings of the app: written one by one, checked and applied
 * as a set. */
#ifndef FIRMWARE_PARAMETERS_H
#define FIRMWARE_PARAMETERS_H

#include <stdbool.h>
#include "models/check.h"
#include "firmware/bus/mailbox.h"
#include "firmware/bus/wire.h"

struct app;
struct app_config;
struct model;

/* The commands PARAM_WRITE, PARAM_COMMIT and PARAM_READ. A wire index below SETTING_FIRST is a parameter
 * of the model, from there on a setting.
 *   write   stages one value: CAUSE_UNKNOWN for an index that does not exist, CAUSE_RANGE for a bad value
 *   commit  checks the staged set by count and CRC (else CAUSE_INCOMPLETE) and as a whole (else CAUSE_RANGE).
 *           Then it acts now or waits for a FIRE. CAUSE_FULL while a FIRE waits that carries an earlier set.
 *           The staged values are forgotten in any case
 *   read    marks one value for PARAM_ECHO */
enum cause parameters_write(struct app *a, const struct message *m);
enum cause parameters_commit(struct app *a, const struct message *m);
enum cause parameters_read(struct app *a, const struct message *m);

/* Would the parameters and settings in force, with the staged values laid over them, be valid together?
 * NULL, or the reason. Changes nothing. Costs up to what the method's preparation costs: not for every
 * tick. */
MUST_CHECK const char *parameters_check(const struct app *a, const struct staged *staged);

/* Applies a set that parameters_check has just accepted, as a whole, marks its values for PARAM_ECHO and
 * empties *staged. A set that was not checked may fail an assertion. */
void parameters_apply(struct app *a, struct staged *staged);

/* Checks settings against the model and each other: lock-in slots name inputs and outputs that the model
 * has, and a heartbeat can be fresh (age_limit_frames at least status_every + 4). NULL, or the reason. */
MUST_CHECK const char *parameters_check_settings(const struct model *m, const double *setting);

/* Stages must fit the model and the tick, and all are off
 * where the app has no memory for them: NULL, or the reason. */
MUST_CHECK const char *parameters_check_stages(const struct app_config *c, const struct model *m,
                                               const double *setting);

/* NULL when no climb to a full model is planned, when it has happened, or when it is possible from these
 * SI parameters; else the reason. */
MUST_CHECK const char *parameters_could_climb(const struct app *a, const double *si);

/* Takes over the settings: restarts every lock-in window and updates the faults of the sensors. */
void parameters_settings_changed(struct app *a);

#endif
