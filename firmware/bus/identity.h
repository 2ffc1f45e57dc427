/* identity.h - the scales and settings that give a plant's frames their meaning, and the check that lets a
 * client see whether it assumes the same.
 *
 * The identity is fixed when the plant starts: protocol version, frame rate, substeps, dilation, model, LSBs
 * and the settings that say what STREAM, LOCKIN and CAPTURE_DATA mean. A climb to the full model keeps it,
 * because no frame changes its meaning then; so does a command that changes a setting, which is echoed. Each
 * part is an item of INFO. Checks have 24 bits, which float32 carries whole. */
#ifndef FIRMWARE_IDENTITY_H
#define FIRMWARE_IDENTITY_H

#include <stdbool.h>
#include "firmware/bus/wire.h"

/* A check of the model's name: the lower 24 bits of its CRC-32. */
uint32_t identity_of_model(const struct model *m);

/* Fills in s->model, s->settings and s->identity. All other members of *s must be set before, for the
 * identity is the check over them; setting[SETTINGS]. */
void identity_fill(struct wire_scene *s, const struct model *m, const double *setting);

/* Returns true and writes *value when `item` (below INFO_ITEMS) of INFO is part of the identity, or
 * IDENTITY itself. False for the eigenfrequencies and PROMOTED: then *value is meaningless. */
bool identity_item(const struct wire_scene *s, unsigned item, double *value);

#endif
