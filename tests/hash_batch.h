/* hash_batch.h - prints the hashes of a batch; 0, or 1 with the reason printed. */
#ifndef TESTS_HASH_BATCH_H
#define TESTS_HASH_BATCH_H

int hash_batch(void);

#endif
