/* shaft_mode.h - the model of one mode of the shaft. */
#ifndef MODELS_SHAFT_MODE_H
#define MODELS_SHAFT_MODE_H

#include "models/shaft_bearing.h"

extern const struct model shaft_bearing_mode;

#endif
