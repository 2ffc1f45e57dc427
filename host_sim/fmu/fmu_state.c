/* fmu_state.c - the state of an instance: a header and what contactplant_save gives. It is one block, so
 * that the serialised form is a copy. */
#include "host_sim/fmu/fmu.h"

#include <stdlib.h>
#include <string.h>

struct header {
    uint64_t magic;
    uint64_t check; /* covers what follows in the header; the plant's bytes have their own */
    uint64_t size;  /* the header's and the plant's */
    struct fmu_run run;
    struct harmonic drive[MODEL_INPUTS];
};

static const uint64_t magic = 0x3165746174736D66u;

static uint64_t check_of(const struct header *h)
{
    const unsigned char *byte = (const unsigned char *)&h->size, *end = (const unsigned char *)(h + 1);
    uint64_t hash = 0xCBF29CE484222325u;
    for (; byte < end; byte++)
        hash = (hash ^ *byte) * 0x100000001B3u;
    return hash;
}

static size_t size_of(struct fmu *f)
{
    return sizeof(struct header) + contactplant_save_size(f->plant);
}

fmi3Status FMI3(GetFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    struct fmu *f = fmu_begin(instance, "fmi3GetFMUState", FMU_ANY);
    if (!f)
        return fmi3Error;
    if (!state)
        return fmu_fail(f, "fmi3GetFMUState: the argument for the state is NULL");
    size_t size = size_of(f);
    struct header *h = *state ? *state : calloc(1, size);
    if (!h)
        return fmu_fail(f, "out of memory for a state of %zu bytes", size);
    *h = (struct header){.magic = magic, .size = size};
    h->run = f->run;
    memcpy(h->drive, f->plant->scene.drive, sizeof h->drive);
    h->check = check_of(h);
    (void)contactplant_save(f->plant, h + 1, size - sizeof *h); /* the size is right: it cannot fail */
    *state = h;
    return fmi3OK;
}

fmi3Status FMI3(SetFMUState)(fmi3Instance instance, fmi3FMUState state)
{
    struct fmu *f = fmu_begin(instance, "fmi3SetFMUState", FMU_ANY);
    const struct header *h = state;
    if (!f)
        return fmi3Error;
    if (!h || h->magic != magic)
        return fmu_fail(f, "fmi3SetFMUState: this is no state of an instance; fmi3GetFMUState gives one");
    if (contactplant_restore(f->plant, h + 1, (size_t)h->size - sizeof *h) != CONTACTPLANT_OK)
        return fmu_fail(f, "%s", contactplant_error(f->plant));
    f->run = h->run;
    memcpy(f->plant->scene.drive, h->drive, sizeof h->drive);
    return fmi3OK;
}

fmi3Status FMI3(FreeFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    (void)instance;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

fmi3Status FMI3(SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    struct fmu *f = fmu_begin(instance, "fmi3SerializedFMUStateSize", FMU_ANY);
    if (!f)
        return fmi3Error;
    if (!state || !size)
        return fmu_fail(f, "fmi3SerializedFMUStateSize: the state, or the argument for the size, is NULL");
    *size = size_of(f);
    return fmi3OK;
}

fmi3Status FMI3(SerializeFMUState)(fmi3Instance instance, fmi3FMUState state, fmi3Byte byte[], size_t size)
{
    struct fmu *f = fmu_begin(instance, "fmi3SerializeFMUState", FMU_ANY);
    if (!f)
        return fmi3Error;
    if (!state || !byte || size < size_of(f))
        return fmu_fail(f, "fmi3SerializeFMUState: give a state and room for its %zu bytes", size_of(f));
    memcpy(byte, state, size_of(f));
    return fmi3OK;
}

fmi3Status FMI3(DeserializeFMUState)(fmi3Instance instance, const fmi3Byte byte[], size_t size,
                                     fmi3FMUState *state)
{
    struct fmu *f = fmu_begin(instance, "fmi3DeserializeFMUState", FMU_ANY);
    struct header h;
    if (!f)
        return fmi3Error;
    if (!byte || !state)
        return fmu_fail(f, "fmi3DeserializeFMUState: the bytes, or the argument for the state, are NULL");
    if (size < sizeof h)
        return fmu_fail(f, "%zu bytes are no state of this FMU: it has %zu", size, size_of(f));
    memcpy(&h, byte, sizeof h);
    if (h.magic != magic || h.check != check_of(&h) || h.size != size_of(f) || size < h.size)
        return fmu_fail(
            f, "these %zu bytes are no state of this FMU: damaged, or of another scene or version", size);
    void *copy = *state ? *state : malloc((size_t)h.size);
    if (!copy)
        return fmu_fail(f, "out of memory for a state of %zu bytes", size);
    memcpy(copy, byte, (size_t)h.size);
    *state = copy;
    return fmi3OK;
}
