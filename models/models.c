/* models.c - the table of models. */
#include "models/models.h"

#include "models/afm_lever.h"
#include "models/reduced/afm_tip_reduced.h"
#include "models/reduced/hertz_rig_reduced.h"
#include "models/reduced/shaft_mode.h"
#include "models/rolling_contact.h"
#include "models/shaft_bearing.h"

/* The first is the default of the command line. */
const struct model *const model_table[MODELS] = {&hertz_rig,
                                                 &hertz_rig_linear,
                                                 &hertz_rig_cubic,
                                                 &hertz_rig_averaged,
                                                 &rolling_contact,
                                                 &rolling_contact_linear,
                                                 &afm_tip,
                                                 &afm_tip_linear,
                                                 &afm_tip_cubic,
                                                 &afm_tip_averaged,
                                                 &afm_lever,
                                                 &shaft_bearing,
                                                 &shaft_bearing_linear,
                                                 &shaft_bearing_mode};
