/* test_keys.h - the keys of a test file and their values. */
#ifndef HOST_SIM_TEST_KEYS_H
#define HOST_SIM_TEST_KEYS_H

#include "host_sim/test/test_reader.h"

/* A line KEY = VALUE. */
bool test_read_key(struct test_reader *r, struct word w);

/* Whether this may be the identifier of a requirement: letters, digits and - _ . : */
bool test_keys_is_requirement(const char *id, size_t n);

#endif
