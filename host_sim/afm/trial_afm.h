/* trial_afm.h - the names of a microscope in a test file:
 * its signals as those of a model, and its numbers. */
#ifndef HOST_SIM_AFM_TRIAL_AFM_H
#define HOST_SIM_AFM_TRIAL_AFM_H

#include "models/model.h"

/* Names alone: its functions are NULL. Inputs are those of struct microscope_in. */
extern const struct model trial_afm_view;
enum {
    VIEW_AMPLITUDE,
    VIEW_PHASE,
    VIEW_AMPLITUDE_2,
    VIEW_DEFLECTION,
    VIEW_Z,
    VIEW_ERROR,
    VIEW_FORCE,
    VIEW_SURFACE,
    VIEW_CRASHES,
    VIEW_OUTPUTS
};
enum { VIEW_IN_FORCE, VIEW_IN_Z, VIEW_IN_X, VIEW_IN_Y, VIEW_INPUTS };

/* The lever's parameters have the indices from 0 on, the
 * station's numbers those from SETTING_FIRST on. NULL: none. */
const struct parameter *trial_afm_parameter(int index);

#endif
