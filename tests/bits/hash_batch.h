/* hash_batch.h - a batch of rigs that differ, run by both
 * methods in turn: as tests/bits/hash_run.h for plants. */
#ifndef TESTS_HASH_BATCH_H
#define TESTS_HASH_BATCH_H

#include <stdint.h>

/* Calls `block` after each run with the hash of the batch's arrays. NULL, or why it stopped. */
const char *hash_batch(void (*block)(uint32_t hash));

#endif
