/* parameters.h - parameters of the model and settings of the app: written one by one, checked and applied as a set. */
#ifndef FIRMWARE_PARAMETERS_H
#define FIRMWARE_PARAMETERS_H

#include <stdbool.h>
#include "models/check.h"
#include "firmware/bus/mailbox.h"
#include "firmware/bus/wire.h"

struct app;
struct app_config;
struct model;

/* The commands PARAM_WRITE, PARAM_COMMIT and PARAM_READ. */
enum cause parameters_write(struct app *a, const struct message *m);
enum cause parameters_commit(struct app *a, const struct message *m);
enum cause parameters_read(struct app *a, const struct message *m);

/* The parameters and settings with `staged` laid over them: NULL, or why the whole set is refused. */
MUST_CHECK const char *parameters_check(const struct app *a, const struct staged *staged);

/* Applies a set that parameters_check has taken, as a whole, and marks it for the echo. */
void parameters_apply(struct app *a, struct staged *staged);

/* Settings that name an input or an output must fit the model: NULL, or what does not. */
MUST_CHECK const char *parameters_check_settings(const struct model *m, const double *setting);

/* Stages must fit the model and the tick, and all are off where the app has no memory for them: NULL, or the reason. */
MUST_CHECK const char *parameters_check_stages(const struct app_config *c, const struct model *m,
                                               const double *setting);

/* NULL where there is no model to climb to (any more), or the plant could climb from these parameters; else the reason. */
MUST_CHECK const char *parameters_could_climb(const struct app *a, const double *si);

/* Restarts what depends on settings. */
void parameters_settings_changed(struct app *a);

#endif
