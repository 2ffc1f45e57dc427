/* hash_batch.c - hashes of batches of rigs; see hash_batch.h. */
#include "tests/bits/hash_batch.h"

#include "host_sim/batch/batch_rk4.h"
#include "host_sim/batch/batch_taylor.h"
#include "models/hertz_rig.h"

enum { BATCH = 50, ROUNDS = 6 };

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

static const char *set_up(struct batch_rk4 *b, struct batch_taylor *c, void *rk4_memory, void *taylor_memory)
{
    static const struct drive_setting drive[RIG_INPUTS] = {
        {0.0, 0.01, 0.1, 0}, {0.0, 0.07, 0.0, 0}, {0.0, 0.07, 0.3, 0}, {0.0, 0.05, 0.2, 0}};
    const char *why = batch_rk4_init(b, BATCH, &hertz_rig, drive, rk4_memory);
    batch_taylor_init(c, BATCH, taylor_memory);
    for (int i = 0; !why && i < BATCH; i++) {
        struct batch_trajectory t;
        double p[MODEL_DERIVED];
        rig(i, &t, p);
        struct batch_rk4_lane lane = {p, 0.05 + 0.001 * i, {0.0}, {t.x[0], t.x[1]}};
        for (int k = 0; k < RIG_INPUTS; k++)
            lane.amplitude[k] = t.drive[k].amplitude;
        why = batch_rk4_set(b, i, &lane);
        if (!why)
            why = batch_taylor_set(c, i, &t);
    }
    return why;
}

const char *hash_batch(void (*block)(uint32_t hash))
{
    static uint64_t rk4_memory[1200], taylor_memory[BATCH * 32];
    struct batch_rk4 b;
    struct batch_taylor c;
    const char *why = "memory too small";
    if (batch_rk4_bytes(BATCH) <= sizeof rk4_memory && batch_taylor_bytes(BATCH) <= sizeof taylor_memory)
        why = set_up(&b, &c, rk4_memory, taylor_memory);
    for (int k = 1; !why && k <= ROUNDS; k++) {
        why = k % 2 ? batch_rk4(&b, 300, 3, NULL) : batch_taylor(&c, 1e-9, 3, NULL);
        uint64_t hash = k % 2 ? hash_of(rk4_memory, batch_rk4_bytes(BATCH))
                              : hash_of(taylor_memory, batch_taylor_bytes(BATCH));
        block((uint32_t)(hash ^ hash >> 32));
    }
    return why;
}
