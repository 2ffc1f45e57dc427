/* neighbours.c - see neighbours.h. */
#include "host_sim/run/neighbours.h"

#include <stdio.h>

bool neighbours_warn(const struct app *a)
{
    const uint32_t *n = a->count, base = a->scene.base_id;
    if (!(n[DIAG_CRC] | n[DIAG_LENGTH] | n[DIAG_UNKNOWN_ID]))
        return false;
    fprintf(stderr,
            "contactplant run: others use identifiers of this plant, 0x%X to 0x%X: %u frames that only a "
            "plant sends, %u with a wrong length, %u with a wrong CHECKSUM; choose --base-id "
            "(docs/guide/neighbours.md)\n",
            (unsigned)base, (unsigned)(base + WIRE_KINDS - 1), (unsigned)n[DIAG_UNKNOWN_ID],
            (unsigned)n[DIAG_LENGTH], (unsigned)n[DIAG_CRC]);
    return true;
}
