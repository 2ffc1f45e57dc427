/* hash_batch.c - hashes of batches of rigs; see hash_batch.h. */
#include "tests/bits/hash_batch.h"

#include "host_sim/batch/batch_taylor.h"
#include "host_sim/batch/batch_taylor_set.h"
#include "models/hertz_rig.h"

enum { BATCH = 50, ROUNDS = 3 };

/* FNV-1a over the batch's words. */
static uint64_t hash_of(const uint64_t *word, size_t bytes)
{
    uint64_t hash = UINT64_C(0xCBF29CE484222325);
    for (size_t i = 0; i < bytes; i++)
        hash = (hash ^ ((word[i / 8] >> (8 * (i % 8))) & 0xFF)) * UINT64_C(0x100000001B3);
    return hash;
}

/* Rig i: parameters, drives and start. */
static void rig(int i, struct batch_trajectory *t, double *p)
{
    double paper[RIG_PAPER] = {0.01 + 0.001 * (i % 7), 0.02 * (i % 23), 0.8 + 0.01 * i, 0.1 * i,
                               4.0 + 0.1 * i,          0.3 * (i % 5),   0.1 * (i % 4),  0.1 * (i % 3)};
    double si[MODEL_PARAMETERS];
    struct scale scale;
    *t = (struct batch_trajectory){
        .model = &hertz_rig, .p = p, .x = {0.1 * (i - 10), 0.02 * i}, .interval = 5.0};
    hertz_rig.from_paper(paper, si, t->drive);
    hertz_rig.prepare(si, p, &scale);
}

static const char *set_up(struct batch_taylor *b, void *memory)
{
    const char *why = NULL;
    batch_taylor_init(b, BATCH, memory);
    for (int i = 0; !why && i < BATCH; i++) {
        struct batch_trajectory t;
        double p[MODEL_DERIVED];
        rig(i, &t, p);
        why = batch_taylor_set(b, i, &t);
    }
    return why;
}

const char *hash_batch(void (*block)(uint32_t hash))
{
    static uint64_t memory[BATCH * 32];
    struct batch_taylor b;
    const char *why = "memory too small";
    if (batch_taylor_bytes(BATCH) <= sizeof memory)
        why = set_up(&b, memory);
    for (int k = 0; !why && k < ROUNDS; k++) {
        why = batch_taylor(&b, 1e-9, 3, NULL);
        uint64_t hash = hash_of(memory, batch_taylor_bytes(BATCH));
        block((uint32_t)(hash ^ hash >> 32));
    }
    return why;
}
