/* scenes_range.h - where the source paper of a plant leaves its own range. */
#ifndef MODELS_SCENES_RANGE_H
#define MODELS_SCENES_RANGE_H

#include "models/scenes/scenes.h"

/* Warning number `i` for this plant: where its source paper leaves its own range, and why. NULL when there
 * are no more. docs/reference/models.md explains the warnings. */
const char *scenes_warning(const struct model *m, const double *si, const struct harmonic *drive, int i);

#endif
