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

/* A check of the model's name. */
uint32_t identity_of_model(const struct model *m);

/* Fills in the checks of a scene whose other members are set; setting[SETTINGS]. */
void identity_fill(struct wire_scene *s, const struct model *m, const double *setting);

/* The value of an item of INFO that is part of the identity, IDENTITY among them; false for other items. */
bool identity_item(const struct wire_scene *s, unsigned item, double *value);

#endif
