/* models.h - all models of this build. */
#ifndef MODELS_MODELS_H
#define MODELS_MODELS_H

#include "models/model.h"

enum { MODELS = 13 };
extern const struct model *const model_table[MODELS];

#endif
