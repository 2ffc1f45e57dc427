/* trouble.h - the trouble of a run in words, from the plant's counters and fault bits. */
#ifndef HOST_SIM_TROUBLE_H
#define HOST_SIM_TROUBLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "host_sim/cli/names.h"

enum { TROUBLE_TEXT = 512, TROUBLE_FAULTS = 8 };

/* The bits of FAULTS. */
extern const struct named trouble_fault[TROUBLE_FAULTS];

/* The names of the bits of FAULTS, with commas between; "" for none. */
void trouble_faults(unsigned faults, char *text, size_t size);

/* Behind the number or the state that they belong to: " (overrun, timeout)"; "" for none. */
void trouble_note_faults(unsigned faults, char text[TROUBLE_TEXT]);

/* The causes of what was refused with how often, from count[DIAG_COUNTERS]; "" for none. */
void trouble_refusals(const uint32_t *count, char *text, size_t size);

/* How many frames and commands were refused. */
double trouble_refused(const uint32_t *count);

/* Overruns, missed frames, time-outs, what was lost or refused, faults: as one list, without a full stop.
 * False: there is none of them, and the text is "". */
bool trouble_list(const uint32_t *count, unsigned faults, char text[TROUBLE_TEXT]);

#endif
