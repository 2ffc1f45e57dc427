/* frame.c - the frame decoder: what it takes says the same when it is encoded and decoded again. */
#include "firmware/bus/wire.h"
#include "firmware/bus/wire_table.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <string.h>

static bool same(const struct message *a, const struct message *b)
{
    bool equal = a->kind == b->kind && a->counter == b->counter;
    for (int i = 0; i < wire_layout(a->kind)->n_fields; i++)
        equal &= a->value[i] == b->value[i] || (isnan(a->value[i]) && isnan(b->value[i]));
    return equal;
}

/* Byte 0: 0 to leave the CRC as it is, else it is made
 * right; bytes 1, 2: identifier; 3: length; then data. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct wire_scene scene = {.base_id = 0x200, .lsb = {1e-9, 1e-6, 1e-9, 1e-3}};
    struct message m, again;
    struct frame f = {0}, g = {0};
    if (size < 4)
        return 0;
    f.id = (uint32_t)(data[1] | (data[2] & 7) << 8);
    f.length = data[3] % 9;
    memcpy(f.data, data + 4, size - 4 < 8 ? size - 4 : 8);
    if (data[0] && f.length > 1)
        f.data[0] = wire_crc8(f.id, f.data, f.length);
    if (wire_decode(&scene, &f, &m) != WIRE_OK)
        return 0;
    MUST(wire_layout(m.kind) && m.counter < WIRE_COUNTER_STATES);
    wire_encode(&scene, &m, &g);
    MUST(wire_decode(&scene, &g, &again) == WIRE_OK);
    MUST(g.id == f.id && same(&m, &again));
    return 0;
}
