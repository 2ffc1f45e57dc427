/* models.h - the table of all models. An image that names single models instead links only those. */
#ifndef MODELS_MODELS_H
#define MODELS_MODELS_H

#include "models/model.h"

enum { MODELS = 14 };
extern const struct model *const model_table[MODELS];

#endif
