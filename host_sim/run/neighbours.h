/* neighbours.h - frames of others under a plant's identifiers: told once. */
#ifndef HOST_SIM_NEIGHBOURS_H
#define HOST_SIM_NEIGHBOURS_H

#include "firmware/app/app.h"

/* Whether this plant has heard frames under its identifiers that are none of its commands: a wrong length or
 * CHECKSUM, or an identifier that only a plant sends. Then one line on stderr tells what they were. */
bool neighbours_warn(const struct app *a);

#endif
