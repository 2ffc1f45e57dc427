/* trial_keys.h - the keys of a test file and their values. */
#ifndef HOST_SIM_TRIAL_KEYS_H
#define HOST_SIM_TRIAL_KEYS_H

#include "host_sim/trial/trial_reader.h"

/* A line KEY = VALUE. */
bool trial_read_key(struct trial_reader *r, struct word w);

#endif
