/* models.c - the table of models. */
#include "models/models.h"

#include <stddef.h>
#include "models/hertz_rig.h"

const struct model *const model_table[MODELS] = {&hertz_rig};
