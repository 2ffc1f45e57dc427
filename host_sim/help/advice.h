/* advice.h - each fault, cause of a refusal and counter of a plant, and what to do about it. */
#ifndef HOST_SIM_ADVICE_H
#define HOST_SIM_ADVICE_H

#include "host_sim/cli/names.h"

/* Where a name stands. */
enum advice_list { ADVICE_FAULT, ADVICE_CAUSE, ADVICE_COUNTER, ADVICE_LISTS };
extern const char *const advice_list_name[ADVICE_LISTS];

/* Entry i of a list, as the plant's own tables have it; false behind the last. */
bool advice_named(enum advice_list list, int i, struct named *n);

/* The advice for whoever meets this name, NULL for a name that has none. One name has one advice. */
const char *advice_text(const char *name);

/* Name i of all that have an advice; NULL behind the last. */
const char *advice_name(int i);

#endif
