/* block.h - ticks in which nothing changes, up to BLOCK_TICKS in one loop with the model inlined.
 *
 * Where every drive that sounds is steady (no ramp, no sample on its way, no noise) a tick of rk4 needs no segment: the loop
 * turns the phasors, steps, looks at the gaps and books the energy, and ends before a tick in which a contact may switch. It
 * does the operations of the general path in their order, so a motion has the same bits however its ticks are cut into
 * blocks. Cost: 40 % less than tick by tick. */
#ifndef FIRMWARE_BLOCK_H
#define FIRMWARE_BLOCK_H

#include <stdint.h>
#include "models/model.h"

struct plant;

enum { BLOCK_TICKS = 16 };

/* What a plant passed through at the end of each tick, model units. Drives that are silent have no phasor. */
struct path {
    uint32_t n;
    double x[BLOCK_TICKS][MODEL_STATES];
    struct input u[BLOCK_TICKS][MODEL_INPUTS];
    double cosine[BLOCK_TICKS][MODEL_INPUTS], sine[BLOCK_TICKS][MODEL_INPUTS];
};

/* Up to n ticks from the start of a tick on; returns how many were done, 0 when the first one needs the general path. With a path
 * (else NULL) each of them is written down; inputs that the model's row leaves out stay as they are there. */
typedef uint32_t block_function(struct plant *pl, uint32_t n, struct path *path);

/* The block of this model; NULL when it has none. */
block_function *block_bind(const struct model *m);

#endif
