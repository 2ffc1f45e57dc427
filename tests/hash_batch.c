#include "tests/hash_batch.h"

#include "host_sim/batch.h"
#include "models/hertz_rig.h"

enum { BATCH = 50, ROUNDS = 6 };

/* FNV-1a over the batch's words. */
static uint64_t hash_of(const uint64_t *word, size_t n)
{
    uint64_t hash = UINT64_C(0xCBF29CE484222325);
    for (size_t i = 0; i < 8 * n; i++)
        hash = (hash ^ ((word[i / 8] >> (8 * (i % 8))) & 0xFF)) * UINT64_C(0x100000001B3);
    return hash;
}

const char *hash_batch(void (*block)(uint32_t hash))
{
    static uint64_t memory[BATCH * 32];
    struct batch b;
    double si[MODEL_PARAMETERS], p[MODEL_DERIVED];
    struct scale scale;
    const char *why = batch_bytes(BATCH) <= sizeof memory ? NULL : "memory too small";
    if (!why)
        batch_init(&b, BATCH, memory);
    for (int i = 0; !why && i < BATCH; i++) {
        double paper[RIG_PAPER] = {0.01 + 0.001 * (i % 7), 0.02 * (i % 23), 0.8 + 0.01 * i, 0.1 * i,
                                   4.0 + 0.1 * i,          0.3 * (i % 5),   0.1 * (i % 4),  0.1 * (i % 3)};
        struct batch_trajectory t = {
            .model = &hertz_rig, .p = p, .x = {0.1 * (i - 10), 0.02 * i}, .interval = 5.0};
        hertz_rig.from_paper(paper, si, t.drive);
        hertz_rig.prepare(si, p, &scale);
        why = batch_set(&b, i, &t);
    }
    for (int k = 1; !why && k <= ROUNDS; k++) {
        why = k % 2 ? batch_rk4(&b, 300, 3, NULL) : batch_taylor(&b, 1e-9, 3, NULL);
        uint64_t hash = hash_of(memory, batch_bytes(BATCH) / sizeof *memory);
        block((uint32_t)(hash ^ hash >> 32));
    }
    return why;
}
