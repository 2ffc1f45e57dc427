/* trial_keys.h - the keys of a test file and their values. */
#ifndef HOST_SIM_TRIAL_KEYS_H
#define HOST_SIM_TRIAL_KEYS_H

#include "host_sim/trial/trial_reader.h"

/* A line KEY = VALUE. */
bool trial_read_key(struct trial_reader *r, struct word w);

/* Whether this may be the identifier of a requirement: letters, digits and - _ . : */
bool trial_keys_is_requirement(const char *id, size_t n);

#endif
